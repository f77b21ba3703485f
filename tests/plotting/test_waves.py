"""Pictures of a wave table: what points where, and that each is drawn."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from ship_gym.plotting import waves
from ship_gym.plotting.figure import picture
from ship_gym.reports.wave_table import PICTURES
from ship_gym.sea.wave_table import UNCERTAINTY, WaveTable
from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.ships.files import DATA
from ship_gym.ships.loader import load_ship

FILE = DATA / "kcs_model" / "waves.npz"
TABLE = WaveTable.load(FILE)
SHIP = load_ship("kcs_model")


def test_bearings_run_clockwise_from_the_bow_and_port_mirrors_starboard():
    heading = np.radians([0.0, 90.0, 180.0])  # following, from starboard, head
    values = np.array([1.0, 2.0, 3.0])
    bearing, even = waves.all_round(heading, values, odd=False)
    np.testing.assert_allclose(np.degrees(bearing), [0.0, 90.0, 180.0, 180.0, 270.0, 360.0])
    np.testing.assert_array_equal(even, [3.0, 2.0, 1.0, 1.0, 2.0, 3.0])
    _, odd = waves.all_round(heading, values, odd=True)
    np.testing.assert_array_equal(odd, [3.0, 2.0, 1.0, -1.0, -2.0, -3.0])


def test_a_rose_has_the_bow_up_and_starboard_right(tmp_path):
    with picture(tmp_path / "rose.png", 3.0, 3.0) as figure:
        axes = figure.add_subplot(projection="polar")
        waves._rose(axes, 2.0)
        figure.draw_without_rendering()
        centre, ahead, starboard = (
            axes.transData.transform(p) for p in ((0.0, -2.7), (0.0, 2.0), (np.pi / 2, 2.0))
        )
        assert tuple(axes.get_ylim()) == (-2.0, 2.0)
    assert ahead[1] > centre[1] + 50.0 and ahead[0] == pytest.approx(centre[0])
    assert starboard[0] > centre[0] + 50.0 and starboard[1] == pytest.approx(centre[1])


def test_each_class_has_a_colour_of_its_own():
    assert len(set(waves._CLASS_COLOURS)) == len(UNCERTAINTY)


def test_lines_are_the_cells_of_the_table(tmp_path):
    with picture(tmp_path / "heave.png", 3.0, 3.0) as figure:
        axes = figure.add_subplot()
        waves._motion(axes, TABLE, 2, "heave")
        head = axes.get_lines()[0]
    assert head.get_label() == "180 deg"
    np.testing.assert_allclose(head.get_ydata(), np.abs(TABLE.motions[2, -1, :, 2]))
    np.testing.assert_allclose(head.get_xdata(), 2.0 * np.pi / TABLE.omega**2)


def check_page(page, pictures):
    text = page.read_text()
    assert text.count("data:image/png;base64,") == pictures
    for outside in ("http:", "https:", "<link", "<script", "url("):
        assert outside not in text
    assert page.stat().st_size < 1.5e6


def test_the_report_is_one_page_of_a_small_table_too(tmp_path):
    """Two speeds, three headings: fewer than the pictures ask for."""
    i, j = np.array([0, 2]), np.array([0, 6, 12])
    cells = {
        name: getattr(TABLE, name)[np.ix_(i, j)]
        for name in ("CX_bem", "CX_snnm", "CY", "CN", "motions", "uncertainty")
    }
    small = dataclasses.replace(TABLE, froude=TABLE.froude[i], heading=TABLE.heading[j], **cells)
    page = tmp_path / "new" / "small.html"
    waves.write_wave_report(page, small, SHIP, None, FILE)
    check_page(page, len(PICTURES) - 1)  # no panels given, none drawn


@pytest.mark.slow
@pytest.mark.parametrize("name", ["kcs_model", "kvlcc2_model"])
def test_the_report_on_a_shipped_table(tmp_path, name):
    file, ship = DATA / name / "waves.npz", load_ship(name)
    page = tmp_path / "report.html"
    waves.write_wave_report(page, WaveTable.load(file), ship, parametric_mesh(ship), file)
    check_page(page, len(PICTURES))
