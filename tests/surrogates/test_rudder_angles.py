"""Several rudder angles: planes and scattered sets give back a law that is known everywhere."""

import functools
import math

import numpy as np
import pytest
from scipy.stats import qmc

from ship_gym.config import ConfigError
from ship_gym.plotting import plot_surrogate
from ship_gym.plotting.surrogate_maps import response
from ship_gym.plotting.surrogate_report import plot_std
from ship_gym.ships import load_ship
from ship_gym.ships.loader import attach_surrogate
from ship_gym.surrogates.effective_inflow import rudder_frame
from ship_gym.surrogates.fit import Options, fit
from ship_gym.surrogates.force_table import table_of
from ship_gym.surrogates.own import own_data_set
from ship_gym.surrogates.rudder_angles import fit_rudder_angles, sets_of, table_of_angles
from ship_gym.surrogates.sample_checks import check_samples
from ship_gym.tables import Table

pytestmark = pytest.mark.filterwarnings("ignore:.*my.csv:UserWarning")

HEADER = "# title: t\n# source: s\n# obtained: o\n# conventions: c\n"
TITLES = "point [-],J [-],beta [deg],delta [deg],K_T [-],10K_Q [-],C_Fx [-],C_Fy [-]"
PLACES = [(J, beta) for J in (0.3, 0.6, 0.85) for beta in (-10.0, 5.0, 25.0, 40.0)]
THREE = (10.0, 20.0, 35.0)
J, BETA = 0.55, 0.3
EPSILON = math.atan(J / (0.7 * math.pi))
GP = Options("gp", noise="none")


def C_N(beta, delta):
    """Normal force of the made-up samples: an inflow angle delta - 0.45 beta."""
    return 0.95 * math.sin(delta - 0.45 * beta)


def K_T(J, beta, delta):
    return 0.5 - 0.35 * J + 0.05 * beta**2 - 0.1 * delta


def row(point, J, beta_deg, delta_deg):
    beta, delta = math.radians(beta_deg), math.radians(delta_deg)
    N = C_N(beta, delta)
    forces = K_T(J, beta, delta), 0.6 - 0.3 * J, -N * math.sin(delta), N * math.cos(delta)
    return ",".join(f"{x:.8g}" for x in (point, J, beta_deg, delta_deg, *forces))


def planes(angles=THREE, places=PLACES):
    return [row(i, *place, angle) for angle in angles for i, place in enumerate(places, 1)]


def scattered(count=30):
    low, high = [0.25, -15.0, 5.0], [0.9, 40.0, 35.0]
    points = qmc.scale(qmc.LatinHypercube(3, rng=1).random(count), low, high)
    return [row(i, *point) for i, point in enumerate(points, 1)]


@pytest.fixture(scope="module")
def ship():
    return load_ship("kcs_model", surrogate="none")


@pytest.fixture(scope="module")
def read(tmp_path_factory, ship):
    """Read rows as a user's file."""

    def made(rows, header=HEADER, **options):
        path = tmp_path_factory.mktemp("own") / "my.csv"
        path.write_text(header + TITLES + "\n" + "\n".join(rows) + "\n")
        return own_data_set(path, ship, **options)

    return made


@pytest.fixture(scope="module")
def fitted(read, ship):
    """Fits of rows and their table, once for all tests."""

    @functools.cache
    def made(rows, options):
        fits = fit_rudder_angles(read(rows), options)
        return fits, table_of_angles(fits, ship)

    return lambda rows, options: made(tuple(rows), options)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rows", "options", "off"),
    [(planes(), Options(), 0.005), (planes(), GP, 0.005), (scattered(), GP, 0.002)],
)
def test_the_table_holds_the_law_between_the_angles_too(fitted, rows, options, off, tmp_path):
    """Off by what a straight line misses between 20 and 35 deg, and with 5 deg steps."""
    table = fitted(rows, options)[1]
    for delta in np.radians([12.0, 20.0, 27.5, 33.0]):
        found = table(delta, EPSILON, BETA)
        starred = found[table.channel("C_T")] * (J**2 + (0.7 * math.pi) ** 2) * math.pi / 8.0
        assert found[table.channel("C_N")] == pytest.approx(C_N(BETA, delta), abs=off)
        assert starred == pytest.approx(K_T(J, BETA, delta), rel=0.01)
        assert found[table.channel("trust")] == pytest.approx(1.0)
    table.save(tmp_path / "table.npz")
    assert Table.load(tmp_path / "table.npz") == table


@pytest.mark.slow
@pytest.mark.parametrize(("rows", "options"), [(planes(), Options()), (scattered(), GP)])
def test_pictures_are_at_the_largest_angle(fitted, ship, rows, options, tmp_path):
    fits, table = fitted(rows, options)
    found, delta = attach_surrogate(ship, table, "own"), fits[-1].data.delta
    normal = rudder_frame(*(response(found, J, BETA)[k] for k in ("C_Fx", "C_Fy")), delta)[0]
    assert normal == pytest.approx(C_N(BETA, delta), abs=0.01)
    plot_surrogate(found, tmp_path / "own.png", fits[-1])
    plot_std(fits[-1], "single", tmp_path / "std.png")
    assert (tmp_path / "own.png").exists() and (tmp_path / "std.png").exists()


def test_each_plane_is_the_table_of_its_angle_alone(read, ship):
    """With angles 15 deg apart and 10: the regular axis of 5 deg holds all of them exactly."""
    data = read(planes())
    table = table_of_angles(fit_rudder_angles(data), ship)
    assert table.axes[0].count == 6 and table.card["domain"]["delta"] == data.delta
    assert data.delta == pytest.approx(math.radians(35.0))
    for angle, k in zip(THREE, (0, 2, 5), strict=True):
        alone = own_data_set(data.path, ship, delta_deg=angle)
        assert len(alone.angles) == 1 and alone.box[2] == pytest.approx(math.radians(-10.0))
        np.testing.assert_allclose(table.values[k], table_of(fit(alone), ship).values, atol=1e-12)
    assert [round(math.degrees(p["delta"])) for p in table.card["planes"]] == list(THREE)


def test_points_held_out_are_held_out_of_each_plane(read):
    data = read(planes(), validation=(3, 7))
    for plane in sets_of(data):
        assert plane.validation == (3, 7) and len(plane.training) == 10
    errors = [found.errors("single")["K_T"] for found in fit_rudder_angles(data)]
    assert np.shape(errors) == (3, 2) and np.abs(errors).max() < 1e-3  # it is of second order


@pytest.mark.slow
def test_a_scattered_set_scores_its_held_out_points_at_their_own_angles(read):
    first, *_, last = fit_rudder_angles(read(scattered(), validation=(2, 9, 17)), GP)
    assert len(first.validation["single"].points) == 3
    assert first.errors("single") == last.errors("single")
    assert np.abs(first.errors("single")["K_T"]).max() < 1.0
    residuals, _ = last.models["single"]["K_T"].leave_one_out()
    assert len(residuals) == 27


def test_the_rudder_is_an_input_of_the_process(read):
    data = read(scattered())
    assert len(data.angles) == 30 and data.read().X.shape == (30, 3)
    found = fit(data, GP).models["single"]["C_Fy"]
    assert found.length_scales.shape == (3,)
    assert not [text for text in check_samples(data, "kcs_model", GP) if "average" in text]


@pytest.mark.parametrize(
    ("rows", "options", "words"),
    [
        (scattered(), Options(), "scattered set needs the Gaussian process, not 'regression'"),
        (planes((35.0,)), Options(), "rudder angles 35 deg: needed are two"),
        (planes((0.0, 35.0)), Options(), "rudder angles 0, 35 deg: needed are two"),
        (planes((10.0, 20.3, 35.0)), Options(), "rudder angles 10, 20.3, 35 deg: must be 0.5"),
        (planes((5.0, 10.5, 35.0)), Options(), "61 regular steps hold them, allowed are 20"),
    ],
)
def test_angles_that_cannot_be_planes(read, ship, rows, options, words):
    with pytest.raises(ConfigError, match=words):
        table_of_angles(fit_rudder_angles(read(rows), options), ship)


def test_planes_without_a_common_region(read):
    high = [(J + 0.8, beta) for J, beta in PLACES]
    rows = [*planes((10.0,)), *planes((35.0,), high)]
    rows = [f"{int(r.split(',')[0]) + 12},{r.split(',', 1)[1]}" if k > 11 else r
            for k, r in enumerate(rows)]  # fmt: skip
    with pytest.raises(ConfigError, match="no region of J and beta in common"):
        sets_of(read(rows))


def test_drift_to_the_wrong_side_alone_and_an_angle_that_is_not_there(read, ship):
    wrong = [row(i, J, -abs(beta), 20.0) for i, (J, beta) in enumerate(PLACES, 1)]
    with pytest.raises(ConfigError, match="beta is negative"):
        read(wrong)
    data = read(planes())
    with pytest.raises(ConfigError, match="delta_deg = 25: the samples have 10, 20, 35"):
        own_data_set(data.path, ship, delta_deg=25.0)
