"""Pure sway: the added mass by its closed form, from a file, and from HMRI's tests."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from ship_gym.captive import Condition, kind, measure
from ship_gym.config import ConfigError
from ship_gym.identification.captive_fit import fit_captive
from ship_gym.identification.numbers import full_names, values_of, with_values
from ship_gym.ships import load_ship

SHIP = load_ship("kvlcc2_model")
HMRI = Path(__file__).resolve().parents[3] / "shared" / "reference" / "kvlcc2"
HEAD = "# title: own tests\n# source: me\n# obtained: computed\n# conventions: as here\n"
NAMES = full_names(["m_y", "Y_v", "N_v"])
RUNS = [Condition(SHIP.speed, 9.9, omega=w, sway=v) for w in (0.1, 0.2) for v in (0.05, 0.1, 0.2)]


def test_more_added_mass_is_felt_in_phase_with_the_acceleration():
    """Y = -m_v v' with v = v' U cos(omega t): in_1 grows by dm v' omega L / U, nothing else."""
    (name,), more = full_names(["m_y"]), 0.05
    heavy = with_values(SHIP, [name], [SHIP.hull.m_y + more])
    for run, light, after in zip(RUNS, measure(SHIP, RUNS), measure(heavy, RUNS), strict=True):
        grown = {key: after[key] - light[key] for key in light}
        force = more * run.sway * run.omega * SHIP.hull.L / run.speed
        assert grown.pop("Y_in") == pytest.approx(force, rel=1e-9)
        assert max(map(abs, grown.values())) < 1e-9


def test_slow_sway_is_static_drift():
    """At a frequency that tends to zero the force out of phase is Y_v v' of a drift."""
    sway = 0.005
    (found,) = measure(SHIP, [Condition(SHIP.speed, 9.9, omega=1e-5, sway=sway)])
    left, right = measure(SHIP, [Condition(SHIP.speed, 9.9, beta=b) for b in (sway, -sway)])
    assert found["Y_out"] == pytest.approx(0.5 * (right["Y"] - left["Y"]), rel=1e-3)
    assert found["N_out"] == pytest.approx(0.5 * (right["N"] - left["N"]), rel=1e-3)


def test_numbers_come_back_from_a_file(tmp_path):
    true, path = with_values(SHIP, NAMES, [0.19, -0.4, -0.11]), tmp_path / "sway.csv"
    lines = [f"{HEAD}speed [m/s],n [rev/s],sway [-],frequency [1/s],Y_in [-],Y_out [-],N_out [-]"]
    for run, found in zip(RUNS, measure(true, RUNS), strict=True):
        cells = [run.speed, run.n, run.sway, run.omega / (2.0 * math.pi)]
        cells += [found[key] for key in ("Y_in", "Y_out", "N_out")]
        lines.append(",".join(map(repr, cells)))
    path.write_text("\n".join(lines))
    fit = fit_captive(SHIP, [path], NAMES)
    assert fit.estimate.values == pytest.approx(values_of(true, NAMES), rel=1e-6)


def test_sway_that_is_none_is_refused():
    with pytest.raises(ConfigError, match="a model that swings has a yaw rate or sways"):
        Condition(1.0, 9.9, omega=0.2)
    with pytest.raises(ConfigError, match="a model that swings has a yaw rate or sways"):
        Condition(1.0, 9.9, omega=0.2, sway=0.1, yaw_rate=0.1)
    with pytest.raises(ConfigError, match="needs a frequency above zero"):
        Condition(1.0, 9.9, sway=0.1)
    with pytest.raises(ConfigError, match="pure sway is for ship-gym fit-hull"):
        kind(RUNS)


@pytest.mark.skipif(not HMRI.is_dir(), reason="the measured tests are not here")
def test_the_added_mass_of_hmri_is_near_the_published_one():
    """Yasukawa & Yoshimura (2015): m_y' = 0.223; HMRI's test was no part of it."""
    fit = fit_captive(SHIP, [HMRI / "hmri_pure_sway_test.csv"], NAMES)
    assert fit.estimate.values[0] == pytest.approx(0.223, rel=0.08)
    assert fit.estimate.errors[0] < 0.01 and len(fit.rows) == 20
