"""Calibration to free-running records: known numbers come back, and what is not told is said."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.identification.calibration import calibrate
from ship_gym.identification.calibration_report import as_dict, as_text
from ship_gym.identification.numbers import full_names, values_of, with_values
from ship_gym.identification.records import read_record
from ship_gym.manoeuvres import turning_circle, zigzag
from ship_gym.ships import load_ship
from tests.identification.own_files import HEAD, own_record

# without a neutral angle she sails straight ahead with the rudder amidships
SHIP = with_values(load_ship("kvlcc2_model"), ["rudder.neutral"], [0.0])
MARIN = Path(__file__).resolve().parents[3] / "shared" / "reference" / "kvlcc2"
needs_marin = pytest.mark.skipif(not MARIN.is_dir(), reason="the measured tests are not here")
NAMES = full_names(["N_r", "Y_vvv", "a_H"])
TRUE = with_values(SHIP, NAMES, [-0.042, -1.2, 0.25])
NOISE = (0.02, 0.02, math.radians(0.3))  # x / L, y / L, psi


@pytest.fixture(scope="module")
def sailed():
    angle = math.radians(20.0)
    return {
        "turn": turning_circle(TRUE),
        "zigzag": zigzag(TRUE, angle, angle, overshoots=3),
        "port": zigzag(TRUE, -0.5 * angle, -0.5 * angle, overshoots=2),
    }


def test_known_numbers_come_back_and_the_held_out_record_is_nearer(sailed, tmp_path):
    files = {k: own_record(tmp_path / f"{k}.csv", r, NOISE, 45.0) for k, r in sailed.items()}
    found = calibrate(SHIP, [files["turn"], files["zigzag"]], NAMES, [files["port"]])
    e = found.estimate
    off = (e.values - values_of(TRUE, NAMES)) / e.errors
    assert np.abs(off).max() < 3.0 and found.at_bound == ()
    # the errors are of use: small beside what was moved
    assert (e.errors < 0.25 * np.abs(values_of(TRUE, NAMES) - values_of(SHIP, NAMES))).all()
    assert e.sigma["psi"] == pytest.approx(NOISE[2], rel=0.25)
    port = str(files["port"])
    assert (found.after[port] < 0.3 * found.before[port])[1:].all()  # x hardly changes
    data = as_dict(found)
    assert [r["held_out"] for r in data["records"]] == [False, False, True]
    text = as_text(found)
    assert "held out" in text and "Condition" in text


def test_records_that_do_not_tell_are_refused(sailed, tmp_path):
    turn = own_record(tmp_path / "turn.csv", sailed["turn"])
    with pytest.raises(ConfigError, match=r"no test tells propeller\.wake_beta2"):
        calibrate(SHIP, [turn], ["wake_beta2"])  # of a wake law that this ship does not have
    with pytest.raises(ConfigError, match="fitted to and held out"):
        calibrate(SHIP, [turn], ["N_r"], [turn])
    with pytest.raises(ConfigError, match="allowed are 1 to 8"):
        calibrate(SHIP, [turn], ["X_vv", "X_vr", "X_rr", "Y_v", "Y_r", "N_v", "N_r", "a_H", "t_R"])


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (["0,0,0,0,0,600"] * 30, "t .s. in row 2: must be later"),
        ([f"{k},{k},0,0,0,600" for k in range(5)], "5 rows: allowed are 20 or more"),
        ([f"{k},0,0,0,0,600" for k in range(30)], "speed ahead at the start .* = 0.0"),
    ],
)
def test_a_record_that_is_none_is_refused(tmp_path, rows, words):
    path = tmp_path / "r.csv"
    titles = "t [s],x [m],y [m],psi [deg],delta [deg],n [rpm]"
    path.write_text("\n".join([HEAD + titles, *rows]) + "\n")
    with pytest.raises(ConfigError, match=words):
        read_record(path, SHIP)
    path.write_text(f"{HEAD}t [s],x [m]\n0,0\n")
    with pytest.raises(ConfigError, match="no column"):
        read_record(path, SHIP)


def changed(path: Path, change) -> Path:
    """A record with its table, columns t, x, y, psi, delta, n, changed."""
    lines = path.read_text().splitlines()
    body = next(k for k, line in enumerate(lines) if not line.startswith("#")) + 1
    table = change(np.loadtxt(lines[body:], delimiter=","))
    path.write_text("\n".join(lines[:body] + [",".join(map(repr, r)) for r in table.tolist()]))
    return path


def times(*factors):
    return lambda table: table * np.array(factors)


def without(first: int, last: int):
    return lambda table: np.delete(table, slice(first, last), axis=0)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (times(1, 1, 1, -1, 1, 1), r"turns -0\.\d+ times as far as psi"),
        (times(1, 1, -1, 1, 1, 1), r"turns -0\.\d+ times as far as psi"),
        (times(1, 1, 1, math.pi / 180.0, 1, 1), "times as far as psi: allowed is 0.5 to 2"),
        (times(1, 1, 1, 1, 1, 1 / 60.0), r"n at the start = 0\.174 rev/s"),
        (times(1, 1, 1, 1, 8, 1), r"largest delta = 160.* deg: allowed is|largest delta = 160"),
        (times(1, 1, 1, 1, -1, 1), "with delta reversed .*: delta is positive to starboard"),
        (lambda table: table[:, [0, 2, 1, 3, 4, 5]], "speed ahead at the start"),
        (without(2500, 3000), r"a gap of 1\.\d+ ship lengths before row 2501: allowed are 0.5"),
        (lambda table: table[:400], "ship lengths: allowed are 2 or more"),
    ],
    ids=["psi", "y", "psi in rad", "n in rev/s", "delta", "delta to port", "x y", "gap", "short"],
)
def test_columns_that_do_not_go_together_are_refused(sailed, tmp_path, change, words):
    path = changed(own_record(tmp_path / "z.csv", sailed["zigzag"]), change)
    with pytest.raises(ConfigError, match=words) as error:
        calibrate(SHIP, [path], ["N_r"])
    assert str(error.value).startswith(str(path)) and len(str(error.value)) < 300 + len(str(path))


def test_a_start_in_a_turn_and_of_a_noisy_track_is_found_too(sailed, tmp_path):
    """No row straight ahead, all rows with noise, uneven steps: the numbers come back."""
    rng, files = np.random.default_rng(2), []
    for name in ("turn", "zigzag"):
        path = own_record(tmp_path / f"{name}.csv", sailed[name])

        def cut(table):
            table = table[300::4]  # the rudder is over, she turns
            table = table[np.sort(rng.choice(len(table), len(table) // 2, replace=False))]
            noise = rng.normal(0.0, 1.0, (len(table), 3)) * [0.07, 0.07, 0.3]
            table[:, 1:4] += noise
            return table

        files.append(changed(path, cut))
    e = calibrate(SHIP, files, NAMES).estimate
    assert np.abs((e.values - values_of(TRUE, NAMES)) / e.errors).max() < 3.0
    assert (e.errors < 0.3 * np.abs(values_of(TRUE, NAMES) - values_of(SHIP, NAMES))).all()
    assert e.sigma["x/L"] == pytest.approx(0.07 / SHIP.hull.L, rel=0.25)


@needs_marin
def test_the_form_of_marin():
    """15.5 kn at full scale is 1.179 m/s here; a rudder angle of theirs is to port."""
    record = read_record(MARIN / "marin_free_turn_35.csv", SHIP)
    assert record.start[3] == pytest.approx(1.179, rel=0.01) and abs(record.start[4]) < 0.02
    assert math.sqrt(record.covariance[3, 3]) < 0.01 * record.start[3]
    assert record.n.mean() == pytest.approx(10.33, abs=0.01)
    assert math.degrees(record.delta.min()) == pytest.approx(-35.0, abs=1.0)
    assert record.psi[-1] < -2.0 * math.pi


@needs_marin
@pytest.mark.slow
def test_zigzags_of_marin_that_were_held_out_come_nearer():
    """A yaw damping and a drag of drift, from one zig-zag; the three others are held out."""
    files = [MARIN / f"marin_free_zigzag_{k}.csv" for k in ("20", "-20", "10", "-10")]
    found = calibrate(SHIP, files[:1], ["N_r", "gamma_R_n"], files[1:])
    better = [found.after[str(f)][2] < found.before[str(f)][2] for f in files[1:]]
    assert sum(better) >= 2
