"""``ship-gym draw``: each picture, its numbers, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (("difference", "--against", "G3_SA"), "C_Fy"),
        (("errors",), "C_Fy"),
        (("width",), "C_Fy"),
        (("path", "--manoeuvre", "zigzag", "--delta", "20"), "drift at"),
        (("shares", "--delta", "20"), "N"),
    ],
    ids=lambda x: x[0],
)
def test_picture_and_numbers(cli, arguments, part):
    code, out, err = cli("draw", *arguments, "--json", "--out", "p.png")
    assert code == 0, err
    data = json.loads(out)
    assert data["files"] == ["p.png"] and Path("p.png").read_bytes()[:4] == b"\x89PNG"
    assert all(part in parts for parts in data["sides"].values())


@pytest.mark.slow
def test_text_says_where_it_wrote(cli):
    code, out, _ = cli("draw", "width", "--noise", "none")
    assert code == 0 and "wrote runs/width.png" in out and "K_T" in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("widht",), "did you mean 'width'"),
        (("difference",), "--against"),
        (("errors", "--against", "G3_SA"), "not an option of the picture errors"),
        (("shares", "--manoeuvre", "zigzag"), "not an option of the picture shares"),
        (("width", "--surrogate", "gp"), "fits its own"),
        (("errors", "--ship", "kvlcc2_model"), "no CFD samples"),
        (("path", "--ship", "kvlcc2_model"), "no surrogate"),
    ],
)
def test_refused_in_one_line(cli, arguments, words):
    code, _, err = cli("draw", *arguments)
    assert code == 2 and words in err and len(err.strip().splitlines()) == 1
