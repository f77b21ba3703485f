"""The wave tables of the shipped ships: limits, bounds, and how a ship finds its own."""

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.physics.waves import WAVE_EXTRAPOLATION
from ship_gym.sea.state import regular_sea
from ship_gym.sea.wave_response import (
    SPEED_STEP,
    load_wave_table,
    wave_response,
    wave_table_of,
)
from ship_gym.sea.wave_table import BOUNDS, MODES, UNCERTAINTY, WaveTable, snnm_weight
from ship_gym.ships import available_ships, load_ship
from ship_gym.simulation import ShipSim

SHIPS = [name for name in available_ships() if load_ship(name).wave_table]
BASES = sorted({load_ship(name).wave_table for name in SHIPS})


@pytest.fixture(scope="module", params=BASES, ids=lambda path: Path(path).parent.name)
def table(request):
    return WaveTable.load(request.param)


def test_every_ship_has_a_table():
    assert SHIPS == available_ships()


def test_tables_are_small_finite_and_bounded(table):
    for name, values in (("CX", table.surge()), ("CX", table.CX_bem), ("CY", table.CY)):
        assert np.isfinite(values).all() and np.abs(values).max() <= BOUNDS[name], name
    assert np.abs(table.CN).max() <= BOUNDS["CN"] and np.isfinite(table.motions).all()
    assert set(np.unique(table.uncertainty)) <= set(UNCERTAINTY)


@pytest.mark.parametrize("path", BASES, ids=lambda path: Path(path).parent.name)
def test_a_table_is_below_a_megabyte_and_says_where_it_comes_from(path):
    assert Path(path).stat().st_size < 1e6
    card = WaveTable.load(path).card
    assert not card["git_commit"].endswith("dirty") and card["checks"]["within_bounds"]


def test_in_long_waves_the_ship_moves_with_the_water(table):
    """Particle motion at the surface: surge -i cos(mu), sway i sin(mu), heave -1 (down), yaw
    sin(mu) cos(mu) by k A, for e^(i theta) with the crest at theta = 0; at rest, waves of 3.3 L.

    This fixes every sign and phase between the boundary elements' axes and the ship's.
    """
    mu, motions = table.heading, table.motions[0, :, 0]
    expected = {
        "surge": -1j * np.cos(mu),
        "sway": 1j * np.sin(mu),
        "heave": -np.ones_like(mu),
        "yaw": np.sin(mu) * np.cos(mu),
    }
    for mode, limit in expected.items():
        gap = np.abs(motions[:, MODES.index(mode)] - limit).max()
        assert gap < 0.2, mode  # 3.3 L is not infinity: 0.05 to 0.15


def test_drift_pushes_along_with_the_waves_and_turns_the_ship_beam_on(table):
    """At rest in waves of 0.8 L: from starboard to port; the moment from bow and quarter."""
    k = int(np.abs(table.omega - math.sqrt(2.0 * math.pi / 0.8)).argmin())
    sector = (table.heading > 0.3) & (table.heading < math.pi - 0.3)
    assert (table.CY[0, sector, k] < 0.0).all()
    assert table.CX_bem[0, 0, k] > 0.0 > table.CX_bem[0, -1, k]
    # starboard bow (mu 150 deg): the bow is pushed to port, the ship turns beam-on
    assert table.CN[0, -3, k] < 0.0 < table.CN[0, 2, k]


def test_response_is_the_table_at_its_own_points():
    ship = load_ship("kcs_model")
    table, h = wave_table_of(ship), ship.hull
    k = 17
    omega = np.array([table.omega[k] * math.sqrt(9.80665 / h.L)])
    response = wave_response(ship, omega, "bem")
    i, f = round(0.10 / SPEED_STEP), list(table.froude).index(0.10)
    X, Y, N = response[i, 9, :3, 0]
    force = ship.rho * 9.80665
    assert X == pytest.approx(force * h.B**2 / h.L * table.CX_bem[f, 9, k], rel=1e-6)
    assert Y == pytest.approx(0.5 * force * h.L * table.CY[f, 9, k], rel=1e-6)
    N_G = 0.5 * force * h.L**2 * table.CN[f, 9, k]
    assert N == pytest.approx(N_G + h.x_G * Y, rel=1e-6)
    yaw = table.motions[f, 9, k, 5] * omega[0] ** 2 / 9.80665
    assert response[i, 9, 7, 0] + 1j * response[i, 9, 8, 0] == pytest.approx(yaw, rel=1e-6)


def test_lookup_is_what_the_kernels_interpolate_and_mirrors():
    waves, ship = load_wave_table("kcs"), load_ship("kcs")
    table = waves.table
    L, force = ship.hull.L, ship.rho * 9.80665
    omega = np.array([0.45, 0.6, 0.83])
    response = wave_response(ship, omega, "blend")
    found = table.drift(0.15, np.radians(60.0), omega * math.sqrt(L / 9.80665))
    np.testing.assert_allclose(response[3, 4, 0], force * ship.hull.B**2 / L * found[:, 0])
    np.testing.assert_allclose(response[3, 4, 1], 0.5 * force * L * found[:, 1], rtol=1e-6)
    speed = 0.15 * math.sqrt(9.80665 * L)
    np.testing.assert_allclose(waves.drift(omega, np.radians(60.0), speed), found, rtol=1e-12)
    again = waves.raos(2.4 / math.sqrt(L / 9.80665), np.radians(60.0), speed)
    np.testing.assert_allclose(again, table.rao(0.15, np.radians(60.0), 2.4), rtol=1e-6)
    rao = table.rao(0.15, np.radians([60.0, -60.0]), 2.4)
    np.testing.assert_allclose(rao[0] * [1, -1, 1, -1, 1, -1], rao[1])
    assert table.drift([[0.0, 0.1]], 1.0, 2.0).shape == (1, 2, 3)
    assert table.drift(0.1, 1.0, 2.0).shape == (3,) and table.rao(0.1, 1.0, 2.0).shape == (6,)


def test_the_kernels_reach_the_last_speed_of_a_table():
    """That of DTC is no multiple of the step: Fn 0.26."""
    ship = load_ship("dtc")
    wavelength, speed = 1.2 * ship.hull.L, 0.26 * math.sqrt(9.80665 * ship.hull.L)
    sim = ShipSim(ship, 1, regular_sea(1.0, wavelength=wavelength))
    found = []
    for factor in (1.0, 1.02):
        sim.reset(0, speed=factor * speed)
        found.append((sim.waves[0, 0], sim.waves[0, WAVE_EXTRAPOLATION]))
    CX = load_wave_table("dtc").drift(sim.water.waves_of(0)[1, 0], math.pi, speed)[0]
    assert found[0][0] == pytest.approx(
        ship.rho * 9.80665 * ship.hull.B**2 / ship.hull.L * CX, rel=1e-6
    )
    assert found[0][1] == pytest.approx(0.0, abs=1e-9)
    assert found[1] == pytest.approx((found[0][0], 0.02), rel=1e-6)


def test_model_and_full_scale_drift_alike():
    """Froude: the same turn in the same waves, lengths by L and time by sqrt(L)."""
    tracks = []
    for ship in (load_ship("kcs_model"), load_ship("kcs")):
        hull = dataclasses.replace(ship.hull, R_0=0.0183)  # no scale effect of friction and wake
        propeller = dataclasses.replace(ship.propeller, w_P0=0.353)
        ship = dataclasses.replace(ship, hull=hull, propeller=propeller)
        sea = regular_sea(0.008 * ship.hull.L, wavelength=ship.hull.L, direction_from=1.0)
        sim = ShipSim(ship, 1, sea)
        unit = math.sqrt(ship.hull.L / 230.0)
        sim.reset(0, n=1.3 / unit)
        for _ in range(200):
            sim.step(np.array([[0.1, 1.3 / unit]]), 1.0 * unit)
        tracks.append(np.array([*(sim.state[0, 3:5] / ship.hull.L), sim.state[0, 5]]))
    np.testing.assert_allclose(tracks[0], tracks[1], rtol=2e-3)


def test_a_ship_without_a_table_says_how_to_make_one():
    ship = dataclasses.replace(load_ship("kcs"), wave_table="")
    with pytest.raises(ConfigError, match=r"kcs has no wave table.*build-wave-table --ship"):
        ShipSim(ship, 1, regular_sea(1.0, wavelength=200.0))


@pytest.mark.parametrize(
    ("froude", "heading_deg", "ratio", "expected"),
    [
        (0.1, 180.0, 0.3, 1.0),  # short waves at speed
        (0.2, 180.0, 0.45, 0.5),  # between 0.4 and 0.5 L
        (0.1, 120.0, 0.6, 0.0),  # long waves from ahead
        (0.1, 30.0, 1.0, 1.0),  # following
        (0.1, 75.0, 1.0, 0.5),  # between 60 and 90 deg
        (0.05, 30.0, 0.2, 0.5),  # half the speed
        (0.0, 0.0, 0.2, 0.0),  # at rest
    ],
)
def test_share_of_snnm(froude, heading_deg, ratio, expected):
    omega = math.sqrt(2.0 * math.pi / ratio)
    found = snnm_weight(np.array([froude]), np.radians([heading_deg]), np.array([omega]))
    assert found[0, 0, 0] == pytest.approx(expected, abs=1e-9)


def test_a_lookup_beyond_the_ends_holds_them():
    table = WaveTable.load(load_ship("kcs").wave_table)
    ends = [(axis[0], axis[-1]) for axis in (table.froude, table.omega)]
    (slowest, fastest), (longest, shortest) = ends
    for inside, beyond in (
        ((fastest, 1.0, 2.0), (fastest + 0.2, 1.0, 2.0)),
        ((slowest, 1.0, longest), (slowest, 1.0, 0.5 * longest)),
        ((slowest, 1.0, shortest), (slowest, 1.0, 2.0 * shortest)),
    ):
        a, b = (table.drift(*at, model="bem") for at in (inside, beyond))
        np.testing.assert_array_equal(a, b)


def changed(tmp_path, **changes):
    """A file of a good table with other arrays."""
    with np.load(load_ship("kcs").wave_table) as found:
        arrays = dict(found) | changes
    np.savez(tmp_path / "waves.npz", **{k: v for k, v in arrays.items() if v is not None})
    return tmp_path / "waves.npz"


def text(**card):
    return np.frombuffer(json.dumps(card).encode(), np.uint8)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"CY": None}, "not a wave table: no array 'CY'"),
        ({"CY": np.float32(1.0)}, "CY has shape (): allowed is (7, 13, 40)"),
        ({"CY": np.zeros((7, 13, 40))[..., :-1]}, "CY has shape (7, 13, 39)"),
        ({"CX_bem": np.full((7, 13, 40), 1e7)}, "CX_bem[0, 0, 0] = 10000000.0: allowed is -100"),
        ({"motions": np.zeros((7, 13, 40, 6, 2))}, "motions is of type float64: allowed is c"),
        ({"motions": np.full((7, 13, 40, 6), np.nan, complex)}, "motions[0, 0, 0, 0] = (nan+0j)"),
        ({"uncertainty": np.full((7, 13, 40), 6, np.uint8)}, "uncertainty[0, 0, 0] = 6: allowed"),
        ({"heading": np.full(13, "0")}, "heading is of type"),
        ({"heading": np.linspace(0.0, 3.0, 13)}, "it must reach from 0 to pi"),
        ({"omega": np.full(40, -np.inf)}, "omega[0] = -inf: allowed is 0.01 to 100"),
        ({"omega": np.geomspace(1.0, 5.0, 40)}, "omega needs two points or more, with equal steps"),
        ({"froude": np.linspace(0.3, 0.0, 7)}, "froude must rise from point to point"),
        ({"froude": np.zeros(0)}, "froude has shape (0,)"),
        ({"card": np.zeros(3)}, "its text is an array of float64: allowed are bytes"),
        ({"card": text(made_for={"L": 1.0, "B": 0.0, "d": 1.0})}, "card.made_for.B = 0.0: allowed"),
        ({"card": text(made_for="L")}, "card.made_for.L = 'L': must be a number"),
    ],
)  # fmt: skip
def test_a_damaged_table_is_one_line(tmp_path, changes, words):
    path = changed(tmp_path, **changes)
    with pytest.raises(ConfigError) as error:
        WaveTable.load(path)
    assert words in str(error.value) and str(path) in str(error.value)
