import dataclasses
import math

import numpy as np
import pytest

from ship_gym import manoeuvres
from ship_gym.config import ConfigError
from ship_gym.manoeuvres import (
    TurningCircle,
    ZigZag,
    imo_limits,
    recording,
    run_trial,
    turning_circle,
    zigzag,
)
from ship_gym.reports import handling, measures
from ship_gym.sea import Sea
from ship_gym.ships import load_ship
from ship_gym.stability import PullOut, Spiral
from ship_gym.stopping import SpeedChange


@pytest.fixture(scope="module")
def circle(kcs_model):
    return turning_circle(kcs_model, math.radians(35.0), 0.860, 10.2)


def test_turning_circle_measures_are_geometry(circle, kcs_model):
    t, L = circle.trajectory, kcs_model.hull.L
    i = int(np.argmax(t["psi"] >= math.pi / 2))
    assert circle.advance == pytest.approx(t["x"][i] / L, abs=0.01)
    assert circle.transfer == pytest.approx(t["y"][i] / L, abs=0.01)
    assert circle.max_advance == pytest.approx(t["x"].max() / L, abs=1e-9)
    # the steady circle by its own extent: diameter from largest to smallest y of the last turn
    last = t["psi"] >= t["psi"][-1] - 2.0 * math.pi
    extent = np.ptp(t["y"][last]) / L
    assert circle.steady_diameter == pytest.approx(extent, rel=0.01)
    assert circle.drift_distance < 0.05  # calm water


def test_trajectory_reruns_from_its_meta(circle, kcs_model):
    config = circle.trajectory.meta["config"]
    again = turning_circle(kcs_model, config["delta"], config["speed"], config["n"])
    for name in circle.trajectory.names:
        assert (again.trajectory[name] == circle.trajectory[name]).all()
    assert circle.trajectory.meta["ship"]["name"] == "kcs_model"
    assert "git_commit" in circle.trajectory.meta


def test_a_recording_has_fewer_rows_and_the_measures_of_all(circle):
    kept, full = recording(circle), circle.trajectory
    assert 800 < len(kept) < 1300 < 0.1 * len(full)
    assert kept.meta["kind"] == "manoeuvre" and kept.meta["metrics"] == circle.measures()
    assert kept.meta["interval"] == pytest.approx(kept["t"][1] - kept["t"][0])
    rows = np.searchsorted(full["t"], kept["t"])
    assert rows[-1] == len(full) - 1
    for name in full.names:
        assert kept[name].tobytes() == full[name][rows].tobytes()


def test_forces_in_the_trajectory_balance_the_equations(circle, kcs_model):
    """Rows hold forces of their own instant: their sum is what accelerates the ship."""
    t, b = circle.trajectory, kcs_model.inertia
    X = sum(t[f"X_{name}"] for name in ("hull", "propeller", "rudder", "disturbance"))
    du = np.gradient(t["u"], t["t"])
    expected = b.m_u * du - b.m_v * t["v"] * t["r"] - b.m_xG * t["r"] ** 2
    np.testing.assert_allclose(X[50:-50], expected[50:-50], atol=0.01 * np.abs(X).max())


def test_current_carries_the_circle(kcs_model):
    current = Sea(current_speed=0.05, current_direction_to=math.pi / 2)
    carried = turning_circle(kcs_model, math.radians(35.0), 0.860, 10.2, current)
    assert carried.drift_direction == pytest.approx(math.pi / 2, abs=0.1)
    assert carried.drift_distance > 0.1


def test_zigzag_overshoots_are_the_peaks(kcs_model):
    zz = zigzag(kcs_model, math.radians(20), math.radians(20), 0.860)
    psi = zz.trajectory["psi"]
    assert max(zz.overshoots[0::2]) == pytest.approx(psi.max() - math.radians(20), abs=2e-3)
    assert len(zz.overshoots) == 4 and (np.diff(zz.execute_times) > 0).all()
    assert zz.period > 0.0 and 1.0 < zz.initial_turning < 3.0
    metrics = recording(zz).meta["metrics"]
    assert metrics["overshoot_2"] == zz.overshoots[1] and "curves" not in recording(zz).meta
    units = recording(zz).meta["units"]
    assert units.keys() == metrics.keys()
    assert (units["overshoot_2"], units["execute_time_1"], units["period"]) == ("rad", "s", "s")
    short = zigzag(kcs_model, math.radians(20), math.radians(20), 0.860, overshoots=1)
    assert recording(short).meta["metrics"]["period"] is None
    rudder = zz.trajectory["delta"]
    assert rudder.max() == pytest.approx(math.radians(20))
    assert rudder.min() == pytest.approx(-math.radians(20))


def test_port_first_zigzag_mirrors_signs(kcs_model):
    zz = zigzag(kcs_model, -math.radians(10), -math.radians(10), 0.860)
    first = zz.trajectory["psi"][: np.argmax(zz.trajectory["t"] >= zz.execute_times[0])]
    assert first.min() < -math.radians(9) and all(o > 0 for o in zz.overshoots)


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda s: turning_circle(s, 35.0), "looks like degrees"),
        (lambda s: turning_circle(s, 0.9), "delta = 0.9"),
        (lambda s: turning_circle(s, 0.0), "needs a rudder angle"),
        (lambda s: turning_circle(s, 1e-4), "no turning circle"),
        (lambda s: turning_circle(s, speed=-1.0), "speed = -1"),
        (lambda s: turning_circle(s, n=99.0), "n = 99"),
        (lambda s: zigzag(s, 0.2, 10.0), "looks like degrees"),
        (lambda s: zigzag(s, 0.2, -0.2), "must have one sign"),
    ],
)
def test_bad_input(kcs_model, call, word):
    with pytest.raises(ConfigError) as error:
        call(kcs_model)
    assert word in str(error.value)


def test_imo_limits():
    kcs = load_ship("kcs")
    limits = imo_limits(kcs, 230.0 / 20.0)  # L / V = 20 s
    assert limits["overshoot_10_10_first"] == pytest.approx(math.radians(15.0))
    assert limits["overshoot_10_10_second"] == pytest.approx(math.radians(32.5))
    assert imo_limits(kcs, 230.0 / 5.0)["overshoot_10_10_first"] == pytest.approx(math.radians(10))
    assert imo_limits(kcs, 230.0 / 40.0)["overshoot_10_10_first"] == pytest.approx(math.radians(20))
    model = load_ship("kcs_model")
    assert imo_limits(model, model.speed)["overshoot_10_10_first"] == pytest.approx(
        imo_limits(kcs, kcs.speed)["overshoot_10_10_first"], rel=1e-3
    )


@pytest.mark.slow
def test_every_trial_of_every_ship_can_be_sailed(ship):
    for trial in ship.trials:
        result = {*run_trial(ship, trial).measures(), "movable_rudder_force"}
        assert all(name.removesuffix("_deg") in result for name in trial.measures)


def test_measures_have_the_units_of_the_reports():
    shown = measures._QUANTITIES | {"overshoots": ("", "deg", 0.0, 0)}
    for kind in handling.KINDS.values():
        shown = shown | kind.quantities
    results = (TurningCircle, ZigZag, SpeedChange, PullOut, Spiral)
    names = {f.name for one in results for f in dataclasses.fields(one)} & shown.keys()
    assert len(names) > 30
    for name in names:
        unit = shown[name][1]
        assert manoeuvres._UNITS.get(name, "-") == {"deg": "rad"}.get(unit, unit), name
