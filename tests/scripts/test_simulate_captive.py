"""``ship-gym simulate captive``: what it prints, writes and refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

FILE = """# title: own
# source: me
# obtained: towed
# conventions: as here
speed [m/s],n [rev/s],beta [deg],Y [-]
1.179,10.4,0,0.001
1.179,10.4,8,0.050
"""


@pytest.mark.slow
def test_all_tests_of_a_ship(cli):
    code, out, _ = cli("simulate", "captive", "--ship", "kvlcc2_model", "--json")
    found = json.loads(out)["captive"]
    assert code == 0 and [case["test"] for case in found] == ["drift", "rudder", "yaw", "yaw_drift"]
    for case in found:
        assert case["files"] == [f"runs/captive_{case['test']}.png"]
        assert Path(case["files"][0]).is_file()
    code, out, _ = cli("simulate", "captive", "--test", "rudder", "--surrogate", "none")
    assert code == 0 and "static rudder, 15 runs" in out and "wrote runs/captive.png" in out


def test_beside_a_file(cli, tmp_path):
    (tmp_path / "own.csv").write_text(FILE)
    arguments = ("--ship", "kvlcc2_model", "--measured", "own.csv", "--out", "a.png")
    code, out, _ = cli("simulate", "captive", *arguments)
    assert code == 0 and "rms difference" in out and "measured: own.csv" in out
    assert Path("a.png").is_file()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("captive", "--delta", "10"), ("delta", "towed in calm water")),
        (("captive", "--csv", "a.csv"), ("csv", "leave it out")),
        (("captive", "--sea", "ss5"), ("sea", "leave it out")),
        (("captive", "--test", "sway"), ("unknown captive test 'sway'", "yaw_drift")),
        (("captive", "--measured", "none.csv"), ("none.csv", "no such file")),
        (("captive", "--measured", "none.csv", "--n", "9"), ("n: a file of measured runs",)),
        (("captive", "--speed", "99"), ("cannot hold 99 m/s",)),
        (("turning", "--measured", "a.csv"), ("measured: belongs to captive",)),
        (("zigzag", "--test", "yaw"), ("test: belongs to captive",)),
    ],
)
def test_refuses_in_one_line(cli, arguments, words):
    code, out, err = cli("simulate", *arguments)
    assert code == 2 and out == "" and len(err.strip().splitlines()) == 1
    assert all(word in err for word in words), err
    assert not Path("runs").exists()
