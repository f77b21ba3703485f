import dataclasses

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from ship_gym import load_ship
from ship_gym.config import ConfigError
from ship_gym.sea.wave_table import UNCERTAINTY, WaveTable, snnm_weight
from ship_gym.seakeeping import database
from ship_gym.seakeeping.database import (
    Grid,
    across_critical,
    build,
    cell,
    head_weight,
    make_problem,
    work_name,
)
from ship_gym.seakeeping.drift import encounter_frequency
from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.seakeeping.motions import Radiation
from ship_gym.seakeeping.radiation_diffraction import diffraction, radiation
from ship_gym.seakeeping.snnm import added_resistance, snnm_hull
from ship_gym.seakeeping.table_checks import compare_with_snnm, critical, uncertainty

pytest.importorskip("capytaine")
pytest.importorskip("joblib")
SHIP = load_ship("kcs_model")
MESH = parametric_mesh(SHIP, 16, 4)
TINY = Grid((0.0, 0.2), 5, 4, longest=12.0, shortest=0.5, encounter=8, encounter_max=6.0)


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    return build(SHIP, MESH, tmp_path_factory.mktemp("waves") / "kcs.npz", TINY)


def test_shape_bounds_and_card(table):
    assert table.CX_bem.shape == table.CY.shape == table.uncertainty.shape == (2, 5, 4)
    assert table.motions.shape == (2, 5, 4, 6) and table.motions.dtype == np.complex64
    assert table.card["checks"]["within_bounds"]
    assert table.card["panels"] == 2 * len(make_problem(SHIP, MESH).hull.panels)
    assert {"capytaine", "versions", "git_commit", "calibration", "mesh", "minutes"} <= set(
        table.card
    )


def test_signs_in_ship_axes(table):
    short = -1  # lambda = 0.5 L
    head, beam, following = -1, 2, 0
    assert table.CX_bem[0, head, short] < 0.0 < table.CX_bem[0, following, short]
    assert table.CY[0, beam, short] < 0.0  # waves from starboard push to port
    for coefficient in (table.CY, table.CN, *np.moveaxis(table.motions, -1, 0)[[1, 3, 5]]):
        assert (coefficient[:, [0, -1]] == 0.0).all()


def test_motions_follow_the_surface_of_a_long_wave(table):
    # lambda = 12 L, elevation Re(A e^{i theta}) upwards; z is down, rotations by k A
    head, beam = table.motions[0, -1, 0], table.motions[0, 2, 0]
    assert head[2] == pytest.approx(-1.0, abs=0.05)
    assert head[4] == pytest.approx(1j, abs=0.1)  # bow up where the surface rises towards the bow
    assert head[0] == pytest.approx(1j, abs=0.1)  # particles move aft behind the crest
    assert beam[1] == pytest.approx(1j, abs=0.1)  # to port
    assert beam[2] == pytest.approx(-1.0, abs=0.05)


def test_save_and_load(table, tmp_path):
    path = tmp_path / "t.npz"
    table.save(path)
    again = WaveTable.load(path)
    for field in dataclasses.fields(WaveTable):
        if field.name != "card":
            np.testing.assert_array_equal(getattr(again, field.name), getattr(table, field.name))
    assert again.card == table.card
    again.save(tmp_path / "u.npz")
    assert path.read_bytes() == (tmp_path / "u.npz").read_bytes()
    with pytest.raises(ConfigError, match="no such wave table"):
        WaveTable.load(tmp_path / "none.npz")
    path.write_bytes(b"nothing")
    with pytest.raises(ConfigError, match="not a wave table"):
        WaveTable.load(path)


def test_non_finite_cells_are_refused(table):
    bad = table.CY.copy()
    bad[0, 0, 0] = np.nan
    with pytest.raises(ConfigError, match=r"CY\[0, 0, 0\] = nan: allowed"):
        dataclasses.replace(table, CY=bad)
    with pytest.raises(ConfigError, match="CY has shape"):
        dataclasses.replace(table, CY=table.CY[:, :-1])


def test_an_interrupted_build_goes_on(table, tmp_path, monkeypatch):
    path, calls = tmp_path / "kcs.npz", []
    row = database.frequency_row

    def broken(problem, waves, index):
        calls.append(index)
        if index == 2:
            raise KeyboardInterrupt
        return row(problem, waves, index)

    monkeypatch.setattr(database, "frequency_row", broken)
    with pytest.raises(KeyboardInterrupt):
        build(SHIP, MESH, path, TINY)
    work = path.parent / work_name(make_problem(SHIP, MESH, TINY))
    assert sorted(p.name for p in work.glob("waves_*")) == ["waves_000.npy", "waves_001.npy"]
    assert not path.exists()

    def counted(problem, waves, index):
        calls.append(index)
        return row(problem, waves, index)

    calls.clear()
    monkeypatch.setattr(database, "frequency_row", counted)
    monkeypatch.setattr(database, "radiation", None)  # all of it is there
    again = build(SHIP, MESH, path, TINY)
    assert calls == [2, 3] and not work.exists()
    np.testing.assert_array_equal(again.CX_bem, table.CX_bem)  # and the same numbers
    np.testing.assert_array_equal(again.motions, table.motions)


def test_another_problem_has_another_work_folder(monkeypatch):
    names = {
        work_name(make_problem(SHIP, MESH, TINY)),
        work_name(make_problem(SHIP, MESH, Grid())),
        work_name(make_problem(SHIP, parametric_mesh(SHIP, 18, 4), TINY)),
    }
    monkeypatch.setattr(database.calibration, "TAU_BAND", 0.04)
    assert len(names | {work_name(make_problem(SHIP, MESH, TINY))}) == 4


def test_progress_sees_every_task(tmp_path):
    seen = {}

    def progress(items, description, total):
        for item in items:
            seen[description] = seen.get(description, 0) + 1
            yield item
        assert seen[description] == total

    build(SHIP, MESH, tmp_path / "k.npz", Grid((0.0,), 2, 2, encounter=2), progress=progress)
    assert seen == {"radiation": 2, "waves": 2}


def test_surge_models(table):
    np.testing.assert_array_equal(table.surge("bem"), table.CX_bem)
    np.testing.assert_array_equal(table.surge("snnm"), table.CX_snnm)
    blend, low, high = table.surge(), *np.sort([table.CX_bem, table.CX_snnm], axis=0)
    assert ((blend >= low - 1e-6) & (blend <= high + 1e-6)).all()
    np.testing.assert_array_equal(blend[0], table.CX_bem[0])  # at rest
    resistance = added_resistance(snnm_hull(SHIP), 0.2, 0.5 * SHIP.hull.L, np.pi)
    assert table.CX_snnm[1, -1, -1] == pytest.approx(-float(resistance), rel=1e-5)
    with pytest.raises(ConfigError, match="did you mean 'blend'"):
        table.surge("blende")


def test_snnm_weight():
    froude, heading = np.array([0.0, 0.05, 0.2]), np.radians([0.0, 75.0, 90.0, 180.0])
    omega = np.sqrt(2.0 * np.pi / np.array([1.0, 0.45, 0.3]))
    weight = snnm_weight(froude, heading, omega)
    assert (weight[0] == 0.0).all()
    np.testing.assert_allclose(weight[1], 0.5 * weight[2])
    np.testing.assert_allclose(weight[2, :, 0], [1.0, 0.5, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(weight[2, 3], [0.0, 0.5, 1.0], atol=1e-9)


def test_surge_and_sway_just_above_tau_one_quarter_lie_between_slower_and_faster_speeds():
    grid = Grid((0.0, 0.05, 0.10, 0.15, 0.20), 3, 4, longest=2.0, shortest=0.5)
    force = np.random.default_rng(1).normal(size=(5, 3, 4))
    found = across_critical(grid, force)
    axes = np.array(grid.froude), grid.heading_points, grid.omega_points
    U, mu, w = np.meshgrid(*axes, indexing="ij")
    tau = U * (w - w**2 * U * np.cos(mu))
    outside = (tau <= 0.22) | (tau >= 0.45) | (mu < 1.5)
    np.testing.assert_array_equal(found[outside], force[outside])
    assert (found == force)[:, 0].all()  # following seas
    # head sea, omega 1.77: tau 0.10, 0.21, 0.34, 0.48, so Fn 0.15 alone
    assert grid.omega_points[0] == pytest.approx(1.7725, abs=1e-4)
    assert found[3, 2, 0] == pytest.approx(0.5 * (force[2, 2, 0] + force[4, 2, 0]))
    # beam sea: tau 0.27 and 0.35 at the last two speeds; without a faster one they stay
    assert critical(*axes)[3:, 1, 0].all()
    assert (found[3:, 1, 0] == force[3:, 1, 0]).all()


def test_uncertainty_classes():
    froude, heading = np.array([0.0, 0.2]), np.radians([0.0, 90.0, 150.0, 180.0])
    omega = np.sqrt(2.0 * np.pi / np.array([1.5, 1.0, 0.3]))
    found = uncertainty(froude, heading, omega)
    assert (found[0] == 0).all() and set(np.unique(found)) <= set(UNCERTAINTY)
    np.testing.assert_array_equal(found[1, :, 1], [5, 2, 1, 1])  # tau 0.25 in following sea
    assert (found[1, 2:, 2] == 4).all()
    assert (uncertainty(np.array([0.10]), np.radians([180.0]), omega)[0, 0] == [5, 5, 4]).all()


def test_head_weight():
    assert head_weight(2.0 * np.pi / 1.5, np.pi) == 1.0
    assert head_weight(2.0 * np.pi / 0.8, np.pi) == pytest.approx(0.5)
    assert head_weight(2.0 * np.pi / 1.5, np.radians(135.0)) == pytest.approx(0.5)
    assert head_weight(2.0 * np.pi / 0.5, np.pi) == head_weight(4.0, np.radians(80.0)) == 0.0


def test_bad_ships_are_refused_before_any_work(tmp_path):
    heavy = dataclasses.replace(
        SHIP, hull=dataclasses.replace(SHIP.hull, volume=1.1 * SHIP.hull.volume)
    )
    with pytest.raises(ConfigError, match="a difference of 5 %"):
        build(heavy, MESH, tmp_path / "t.npz", TINY)
    with pytest.raises(ConfigError, match="symmetric hull"):
        build(SHIP, MESH.both_sides(), tmp_path / "t.npz", TINY)
    with pytest.raises(ConfigError, match="increasing from 0"):
        Grid((0.1, 0.2))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, speeds, allowed",
    [
        ("kcs_model", (0.26, 0.10), 0.15),
        ("dtc_model", (0.14,), 0.15),
        ("s175", (0.25,), 0.20),
    ],
)
def test_surge_beside_snnm(name, speeds, allowed):
    # head and 150 deg seas, 0.4 to 2 L; SNNM also served to calibrate the far field, see
    # calibration.py
    ship = load_ship(name)
    problem, snnm = make_problem(ship, parametric_mesh(ship)), snnm_hull(ship)
    beam = ship.hull.B / ship.hull.L
    ratio = np.array([0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.35, 1.6, 2.0])
    omega = np.linspace(1.5, 7.7, 32)
    waves = Radiation(omega, np.array([radiation(problem.hull, w**2) for w in omega]))
    headings = np.radians([150.0, 180.0])
    flows = [diffraction(problem.hull, 2.0 * np.pi / r, headings) for r in ratio]
    for speed in speeds:
        for j, mu in enumerate(headings):
            found = []
            for r, flow in zip(ratio, flows, strict=True):
                k = 2.0 * np.pi / r

                def second(k=k, mu=mu, speed=speed):
                    encounter_k = encounter_frequency(k, mu, speed) ** 2
                    return diffraction(problem.hull, k, np.array([mu]), encounter_k)[0]

                found.append(cell(problem, flow[j], second, waves, k, mu, speed)[0].real / beam**2)
            even = np.linspace(0.4, 2.0, 161)
            surge = CubicSpline(ratio, found)(even)
            expected = -added_resistance(snnm, speed, even * ship.hull.L, mu)
            rms = np.sqrt(np.mean((surge - expected) ** 2)) / -expected.min()
            assert rms <= allowed, (speed, mu)
            shift = abs(even[surge.argmin()] - even[expected.argmin()])
            assert round(shift, 2) <= 0.1, (speed, mu)  # to the step of `even`


def test_comparison_with_snnm_has_one_value_per_heading(table):
    found = compare_with_snnm(table)
    assert set(found) == {"rms", "peak", "peak_snnm", "at", "at_snnm"}
    assert len(found["rms"]["0.20"]) == 5
