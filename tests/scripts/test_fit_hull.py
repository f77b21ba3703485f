"""ship-gym fit-hull: files it writes, and one-line refusals."""

from __future__ import annotations

import json
import math

import pytest

from ship_gym.captive import measure, programme
from ship_gym.ships import load_ship

HEAD = "# title: own\n# source: me\n# obtained: computed\n# conventions: as here\n"


@pytest.fixture(scope="module")
def drift(tmp_path_factory):
    """A drift test of the ship herself."""
    path, ship = tmp_path_factory.mktemp("runs") / "drift.csv", load_ship("kvlcc2_model")
    runs = programme(ship, "drift")
    lines = [f"{HEAD}speed [m/s],n [rev/s],beta [deg],X [-],Y [-],N [-]"]
    for run, row in zip(runs, measure(ship, runs), strict=True):
        cells = run.speed, run.n, math.degrees(run.beta), row["X"], row["Y"], row["N"]
        lines.append(",".join(map(repr, cells)))
    path.write_text("\n".join(lines) + "\n")
    return path


def test_a_fit_writes_ship_page_and_picture(cli, drift, tmp_path):
    out, page, plot = tmp_path / "ship.toml", tmp_path / "fit.md", tmp_path / "fit.png"
    words = ["--captive", drift, "--numbers", "Y_v", "Y_vvv", "N_v"]
    files = ["--out", out, "--page", page, "--plot", plot]
    code, text, _ = cli("fit-hull", *map(str, [*words, *files]), "--json")
    data = json.loads(text)
    ship = load_ship("kvlcc2_model")
    assert code == 0 and data["files"] == [str(out), str(page), str(plot)]
    assert [x["name"] for x in data["numbers"]] == ["hull.Y_v", "hull.Y_vvv", "hull.N_v"]
    assert data["numbers"][0]["value"] == pytest.approx(ship.hull.Y_v, rel=1e-6)
    assert "drift.csv" in out.read_text() and "standard error" in load_ship(out).sources["hull.N_v"]
    assert "| Y_v |" in page.read_text() and plot.read_bytes().startswith(b"\x89PNG")
    # the same again is the same result; another ship's is not
    assert cli("fit-hull", *map(str, [*words, "--out", out]))[0] == 0
    code, _, told = cli("fit-hull", "--ship", "kcs_model", *map(str, [*words, "--out", out]))
    assert code == 2 and "holds a ship fitted from kvlcc2_model" in told


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "--captive: needs one or more files"),
        (["--numbers", "Y_q"], "Y_q"),
        (["--numbers", "Y_r"], "no run tells hull.Y_r"),
        (["--ship", "kvlcc3"], "kvlcc3"),
    ],
)
def test_refusals_are_one_line(cli, drift, tmp_path, words, told):
    given = ["--captive", str(drift)] if words else []
    code, _, text = cli("fit-hull", *given, *words, "--out", str(tmp_path / "ship.toml"))
    assert code == 2 and told in text and text.count("\n") == 1 and len(text) <= 301
    assert not list(tmp_path.iterdir())
