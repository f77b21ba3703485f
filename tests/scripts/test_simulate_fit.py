"""The scripts simulate and fit_surrogate: what they print, write and refuse."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.recording import Trajectory
from ship_gym.reports.case import sail
from ship_gym.reports.page import Picture
from ship_gym.ships.files import DATA
from ship_gym.ships.loader import attach_surrogate, load_ship
from ship_gym.surrogates.samples import KCS
from ship_gym.tables import Table

PNG = b"\x89PNG"


@pytest.mark.parametrize("script", ["simulate.py", "fit_surrogate.py"])
def test_help_shows_examples(call, script):
    code, out, _ = call(script, "--help")
    assert code == 0
    assert f"python scripts/{script}" in out


def test_simulate_sails_the_trial_without_arguments(call):
    code, out, _ = call("simulate.py")
    assert code == 0
    assert Path("runs/turning_circle.png").read_bytes()[:4] == PNG
    words = {
        line.rsplit("[", 1)[0].strip(): line.split("]")[-1].split() for line in out.split("\n")
    }
    found = sail(load_ship("kcs_model")).result
    across, last = found.max_transfer, found.steady_diameter
    assert words["maximum transfer"] == [
        f"{across:.2f}", "3.22", f"{100.0 * (across / 3.22 - 1.0):+.1f}", "%"
    ]  # fmt: skip
    assert words["steady diameter"][:4] == [f"{last:.2f}", "2.60", "±", "0.11"]
    assert words["steady diameter"][-1] == f"{(last / 2.602 - 1.0) / 0.041:+.1f}"
    assert words["tactical diameter"][:1] in ([f"{found.tactical_diameter:.2f}"], ["pass"])
    assert "10.2 rev/s" in out
    assert "engine.n_max" in out  # estimated
    assert "next: ship-gym simulate" in out


def test_simulate_json_csv_and_recording(call):
    code, out, _ = call(
        "simulate.py", "zigzag", "--ship", "kvlcc2_model", "--delta", "-20", "--json",
        "--csv", "z.csv", "--rrd", "z.rrd", "--out", "z.png",
    )  # fmt: skip
    data = json.loads(out)
    assert code == 0
    assert data["psi_deg"] == pytest.approx(-20.0)
    assert data["measured"] == {"overshoot_1": 15.1, "overshoot_2": 13.2}
    assert data["imo"]["overshoot_1"] == {"limit": pytest.approx(25.0), "pass": True}
    assert data["files"] == ["z.png", "z.csv", "z.rrd"]
    assert all(Path(path).stat().st_size > 10_000 for path in data["files"])
    run = Trajectory.from_file("z.rrd")
    assert run.meta["metrics"]["overshoot_1"] == pytest.approx(
        math.radians(data["measures"]["overshoot_1"])
    )


def test_simulate_crash_stop(call):
    code, out, _ = call("simulate.py", "stopping", "--ship", "kcs", "--json", "--csv", "s.csv")
    data = json.loads(out)
    assert code == 0
    assert data["files"] == ["runs/stopping.png", "s.csv"] and Path("s.csv").stat().st_size > 10_000
    assert data["imo"]["track_reach"]["limit"] == 15.0 and data["imo"]["track_reach"]["pass"]
    assert 0.0 < data["measures"]["reversal"] < data["measures"]["time"]


@pytest.mark.slow
def test_simulate_all_trials(call):
    code, out, _ = call("simulate.py", "trials", "--json", "--out", "t.png")
    trials = json.loads(out)["trials"]
    assert code == 0
    assert [t["delta_deg"] for t in trials[:2]] == [35.0, -35.0]
    assert all(t["trial_source"] and t["difference_percent"] for t in trials)
    assert [t["files"] for t in trials] == [[f"t_{k}.png"] for k in range(1, len(trials) + 1)]
    assert [t["facility"] for t in trials].count("mean of 6 facilities") == 2


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--delta", "350"), ("delta", "350", "-35 to 35", "deg")),
        (("turnign",), ("manoeuvre", "turning")),
        (("--ship", "kcs_modl"), ("ship", "kcs_model")),
        (("--surrogate", "G9"), ("surrogate", "G2_SA")),
        (("--variant", "hull_b"), ("variant", "hull_a")),
        (("--sea", "stormy"), ("sea", "calm")),
        (("--speed", "-1"), ("speed", "m/s")),
        (("--n", "99"), ("n = 99", "rev/s")),
        (("--psi", "10"), ("psi",)),
        (("trials", "--delta", "20"), ("trials", "delta")),
        (("turning", "--order", "-5"), ("order", "crash stop")),
        (("spiral", "--psi", "10"), ("psi", "spiral")),
        (("stopping", "--order", "-99"), ("order", "-12 to 0")),
        (("stopping", "--loading", "l.png"), ("loading",)),
    ],
)
def test_simulate_refuses_in_one_line(call, arguments, words):
    code, out, err = call("simulate.py", *arguments)
    assert code == 2
    assert out == ""
    assert len(err.strip().splitlines()) == 1
    assert all(word in err for word in words), err
    assert not Path("runs").exists()


def test_fit_surrogate_writes_a_table_that_attaches(call, monkeypatch):
    from ship_gym.plotting import surrogate_report

    # what it draws is tested with the pictures
    monkeypatch.setattr(surrogate_report, "for_page", lambda text, draw: Picture(text, PNG))
    code, out, _ = call("fit_surrogate.py", "--report")
    assert code == 0
    assert Path("runs/surrogate_kcs_G2_SA.html").read_text().count("<img") == 5
    assert "attach_surrogate" in out and 'surrogate="G2_SA"' in out
    assert "printed" in out and "steady diameter" in out and "where to sample next" in out
    table = Table.load("runs/surrogate_kcs_G2_SA.npz")
    ship = attach_surrogate(load_ship("kcs_model"), table, "G2_SA")
    assert ship.rudder == load_ship("kcs_model").rudder


def test_fit_surrogate_json(call):
    code, out, _ = call(
        "fit_surrogate.py", "--json", "--order", "first", "--out", "f.npz", "--plot", "s.png"
    )
    data = json.loads(out)
    assert code == 0
    assert data["files"] == ["f.npz", "s.png"] and Path("s.png").read_bytes()[:4] == PNG
    side = data["sides"]["single"]
    assert len(side["coefficients"]["K_T"]) == 4
    assert side["printed_coefficients"] == {}  # the thesis prints the second order only
    assert data["turning_circle"]["trial"]["steady_diameter"] == 2.602


@pytest.mark.slow
def test_fit_surrogate_of_two_propellers_with_a_process(call):
    code, out, _ = call("fit_surrogate.py", "--data", "onrt", "--family", "gp", "--json")
    data = json.loads(out)
    assert code == 0 and data["files"] == ["runs/surrogate_onrt_gp.npz"]
    assert set(data["sides"]) == {"leeward", "windward"}
    assert data["sides"]["windward"]["printed_mean_errors_percent"]["K_X"] == 0.96
    assert len(Table.load("runs/surrogate_onrt_gp.npz").names) == 22


OWN = KCS.path.read_text()


def test_fit_surrogate_of_own_samples(call):
    lines = [x for x in OWN.splitlines() if x[0] in "#p" or ",G2,SA," in x]
    Path("mine.csv").write_text("\n".join(lines) + "\n")
    code, out, err = call("fit_surrogate.py", "--samples", "mine.csv", "--json")
    data = json.loads(out)
    assert code == 0 and err == ""
    assert data["files"] == ["runs/surrogate_mine_G2_SA.npz"]
    side = data["sides"]["single"]
    assert len(side["leave_one_out_errors_percent"]["K_T"]) == 12
    assert side["printed_coefficients"] == {} and data["options"]["noise"] == "none"
    code, _, err = call(
        "fit_surrogate.py", "--samples", "mine.csv", "--validation", "1", "2", "3", "4"
    )
    assert code == 0 and err.startswith("warning: mine.csv: lines ")
    Path("mine.csv").write_text("\n".join(lines[:-1]) + "\n12,0.856,8.44,G2,SA,nan,0,0,0\n")
    before = sorted(Path("runs").iterdir())
    code, out, err = call("fit_surrogate.py", "--samples", "mine.csv", "--out", "runs/new.npz")
    assert code == 2 and out == "" and "mine.csv:18: K_T = nan" in err
    assert sorted(Path("runs").iterdir()) == before


@pytest.mark.slow
def test_install_gives_the_shipped_tables_back(call):
    code, _, _ = call("fit_surrogate.py", "--install", "tables")
    assert code == 0
    for ship in ("kcs_model", "onrt_model"):
        shipped = sorted((DATA / ship).glob("surrogate_*.npz"))
        made = sorted(path.name for path in (Path("tables") / ship).iterdir())
        assert made == [path.name for path in shipped]
        for path in shipped:
            again = Table.load(Path("tables") / ship / path.name)
            np.testing.assert_allclose(again.values, Table.load(path).values, rtol=0, atol=1e-6)


def test_install_writes_nothing_if_one_fit_fails(call, monkeypatch):
    from ship_gym.reports import surrogate

    bad = (("kcs", "regression", "G2", "SA"), ("kcs", "regression", "G9", "SA"))
    monkeypatch.setattr(surrogate, "SHIPPED", bad)
    code, _, err = call("fit_surrogate.py", "--install", "tables")
    assert code == 2 and "G9" in err and not Path("tables").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--grid", "G9"), ("grid", "G9", "G3")),
        (("--turbulence", "SSA"), ("turbulence", "SA")),
        (("--order", "fifth"), ("order", "second")),
        (("--family", "forest"), ("family", "regression")),
        (("--data", "kcz"), ("data set", "did you mean 'kcs'")),
        (("--family", "gp", "--order", "first"), ("--order", "regression")),
        (("--noise", "none"), ("--noise", "gp")),
        (("--family", "gp", "--noise", "some"), ("noise", "computed")),
        (("--ship", "kcs_model"), ("--ship", "--samples")),
        (("--data", "kcs", "--samples", "none.csv"), ("--data", "--samples")),
        (("--samples", "none.csv"), ("none.csv", "no such file")),
        (("--samples", "none.csv", "--ship", "kcz_model"), ("ship", "kcs_model")),
        (("--order", "third"), ("10 features", "8 points")),
    ],
)
def test_fit_surrogate_refuses_in_one_line(call, arguments, words):
    code, out, err = call("fit_surrogate.py", *arguments)
    assert code == 2
    assert out == ""
    assert len(err.strip().splitlines()) == 1
    assert all(word in err for word in words), err
    assert not Path("runs").exists()


def test_a_fit_whose_ship_does_not_turn_is_kept_and_warned_of(call, monkeypatch):
    from ship_gym.reports import surrogate as report

    def no_circle(*_):
        raise ConfigError("no turning circle")

    monkeypatch.setattr(report, "turning_check", no_circle)
    code, out, err = call("fit_surrogate.py", "--out", "kept.npz")
    assert code == 0 and Path("kept.npz").is_file() and "wrote kept.npz" in out
    assert "kcs_propeller_rudder_cfd.csv: no turning circle; are the signs and units right?" in err


def test_the_table_does_not_replace_its_samples(call):
    Path("mine.csv").write_text(KCS.path.read_text())
    code, _, err = call("fit_surrogate.py", "--samples", "mine.csv", "--out", "mine.csv")
    assert code == 2 and "--out mine.csv: allowed is a .npz file" in err
    assert Path("mine.csv").read_text() == KCS.path.read_text()
