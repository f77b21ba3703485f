"""What is wrong with captive tests is told: units, signs, single runs, offsets."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from ship_gym.captive import measure, programme
from ship_gym.config import ConfigError
from ship_gym.identification.captive_fit import fit_captive
from ship_gym.identification.estimate import check_told
from ship_gym.identification.report import _judged, advice, as_dict, as_text
from ship_gym.reports.captive_file import read_measured
from ship_gym.ships import load_ship

SHIP = load_ship("kvlcc2_model")
HEAD = "# title: own tests\n# source: me\n# obtained: computed\n# conventions: as here\n"
NAMES = ("Y_v", "Y_vvv", "N_v")
COLUMNS = ("speed [m/s]", "n [rev/s]", "beta [deg]", "delta [deg]", "X [-]", "Y [-]", "N [-]")
SIGMA = np.array([3e-4, 1e-3, 5e-4])


@pytest.fixture(scope="module")
def tests():
    """Rows of a drift and a rudder test of the ship herself, with noise."""
    rng, found = np.random.default_rng(5), {}
    for test in ("drift", "rudder"):
        runs = programme(SHIP, test)
        rows = [
            [r.speed, r.n, math.degrees(r.beta), math.degrees(r.delta), *(m[a] for a in "XYN")]
            for r, m in zip(runs, measure(SHIP, runs), strict=True)
        ]
        found[test] = np.array(rows)
        found[test][:, 4:] += rng.normal(0.0, SIGMA, (len(rows), 3))
    return found


def fitted(folder: Path, tests, change=lambda name, rows: rows, titles=COLUMNS):
    files = []
    for name, rows in tests.items():
        files.append(folder / f"{name}.csv")
        lines = [",".join(map(repr, row)) for row in change(name, rows.copy()).tolist()]
        files[-1].write_text("\n".join([HEAD + ",".join(titles), *lines]) + "\n")
    return fit_captive(SHIP, files, NAMES)


def test_of_sound_tests_nothing_is_told(tests, tmp_path):
    fit = fitted(tmp_path, tests)
    assert _judged(fit) == {"far_off": [], "shifted": [], "not_fitted": []}
    assert fit.leverage.sum() == pytest.approx(len(NAMES))
    assert "Far off" not in as_text(fit)


def test_a_slip_in_one_run_is_named(tests, tmp_path):
    def slip(name, rows):
        if name == "drift":
            rows[9, 5] *= 1.2  # at 8 deg of drift
        return rows

    fit = fitted(tmp_path, tests, slip)
    (found,) = as_dict(fit)["far_off"]
    assert found["what"] == "Y of drift.csv (8 deg of drift)" and found["deviations"] > 2.5
    assert "Far off the others" in as_text(fit)


def test_an_offset_of_the_gauge_is_named(tests, tmp_path):
    fit = fitted(tmp_path, tests, lambda name, rows: rows + [0, 0, 0, 0, 0, 0, 0.01])
    (told,) = as_dict(fit)["shifted"]
    assert told.startswith("N of drift.csv by +9") or told.startswith("N of drift.csv by +10")
    assert "gauge's offset" in as_text(fit)


@pytest.mark.parametrize(("column", "what"), [(3, "Y of rudder.csv"), (6, "N of rudder.csv")])
def test_a_wrong_sign_is_told(tests, tmp_path, column, what):
    """The rudder's angle to port, or a moment that turns the bow to port."""
    signs = np.where(np.arange(7) == column, -1.0, 1.0)
    fit = fitted(tmp_path, tests, lambda name, rows: rows * signs)
    assert any(
        f"{x['coefficient']} of {x['file']}" == what and x["opposite"]
        for x in as_dict(fit)["not_fitted"]
    )
    assert what in advice(fit) and len(advice(fit)) < 300
    assert "Measured against the sign" in as_text(fit)


@pytest.mark.parametrize(
    ("column", "wrong", "allowed"),
    [
        ("speed", "m", "[m/s] or [kn]"),
        ("beta", "-", "[rad] or [deg]"),
        ("n", "m", "[rev/s] or [rpm]"),
        ("Y", "N", "[-]"),
        ("N", "N m", "[-]"),
    ],
)
def test_a_unit_of_another_quantity_is_refused(tests, tmp_path, column, wrong, allowed):
    titles = [f"{column} [{wrong}]" if t.startswith(f"{column} ") else t for t in COLUMNS]
    with pytest.raises(ConfigError) as error:
        fitted(tmp_path, tests, titles=titles)
    told = f"drift.csv:5: column '{column}' has unit [{wrong}]; allowed is {allowed}"
    assert str(error.value).endswith(told)


@pytest.mark.parametrize(
    "line", ["# Lpp: 6.9", "# length [m]: 6.9", "# lenght: 6.9", "# scale: 46"]
)
def test_a_length_that_would_be_passed_over_is_refused(tmp_path, line):
    path = tmp_path / "a.csv"
    path.write_text(f"{HEAD}{line}\nspeed [m/s],n [rev/s],Y [-]\n1,9.9,0.1\n")
    with pytest.raises(ConfigError, match=r"write '# length: 6\.9', in m"):
        read_measured(path, SHIP)


@pytest.mark.parametrize(
    ("titles", "row", "told"),
    [
        ("yaw_rate [-],Y_out [-]", "0.2,0.1", "Y_out: harmonics are of a swinging model"),
        ("yaw_rate [-],frequency [Hz],Y [-]", "0.2,0.2,0.1", "Y: a swinging model has harmonics"),
        ("yaw_rate [-],frequency [m],Y_out [-]", "0.2,0.2,0.1", "has unit [m]; allowed is [1/s]"),
        ("yaw_rate [-],frequency [1/s],Y_out [-]", "0.6,0.01,0.1", "course angle by yaw_rate"),
    ],
)
def test_planar_motion_that_is_none_is_refused(tmp_path, titles, row, told):
    path = tmp_path / "a.csv"
    path.write_text(f"{HEAD}speed [m/s],n [rev/s],{titles}\n1.179,9.9,{row}\n")
    with pytest.raises(ConfigError) as error:
        read_measured(path, SHIP)
    assert told in str(error.value) and len(str(error.value)) - len(str(tmp_path)) < 300


def test_frequencies_of_every_unit_are_one(tmp_path):
    found = []
    for unit, value in (("1/s", 0.2), ("Hz", 0.2), ("rad/s", 0.4 * math.pi)):
        path = tmp_path / "a.csv"
        path.write_text(
            f"{HEAD}speed [m/s],n [rev/s],yaw_rate [-],frequency [{unit}],Y_out [-]\n"
            f"1.179,9.9,0.2,{value},0.1\n"
        )
        found.append(read_measured(path, SHIP)[0].condition.omega)
    assert found == pytest.approx([0.4 * math.pi] * 3)


def test_few_digits_are_no_copy(tmp_path):
    """X of a drift to either side is the same, and so are runs of few digits."""
    runs = programme(SHIP, "drift")
    lines = [
        f"{r.speed},{r.n},{math.degrees(r.beta)},{m['X']:.4f}"
        for r, m in zip(runs, measure(SHIP, runs), strict=True)
    ]
    path = tmp_path / "a.csv"
    titles = "speed [m/s],n [rev/s],beta [deg],X [-]"
    path.write_text("\n".join([HEAD + titles, *lines, lines[0]]))
    fit = fit_captive(SHIP, [path], ["X_vv"])
    assert fit.copies == 1  # the first run again, and nothing else


def test_numbers_that_are_mixed_are_named_however_many():
    """Sixteen that only together are told: none of them has a large share."""
    J = np.eye(17, 16) - 1.0 / 16.0
    with pytest.raises(ConfigError, match=r"tell a, b, .* o, p apart"):
        check_told(tuple("abcdefghijklmnop"), J[:16].repeat(2, axis=0))
