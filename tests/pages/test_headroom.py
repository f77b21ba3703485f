"""The table of the headroom on the pages."""

from pages.headroom import headroom_table
from ship_gym.evaluation import headroom


def test_every_cell_is_a_row_with_its_optimum_and_interval():
    cells, lines = headroom.read(), headroom_table().splitlines()
    assert len(lines) == 2 + len(cells)
    cell = cells["heading_keeping/kcs"]
    row = next(line for line in lines if line.startswith("| `heading_keeping` | kcs |"))
    assert f"{cell['reference']:.3g} `{cell['reference_controller']}`" in row
    assert f"{cell['optimum']:.3g}" in row and f"{cell['headroom']['value']:.1f} %" in row


def test_a_scenario_without_values_says_so():
    assert headroom_table(["drill_sensor_bias"]).startswith("No suite of the package scores it")


def test_a_measure_without_an_optimum_shows_none():
    row = headroom_table(["track_economy"]).splitlines()[2]
    assert row.endswith("| - | - |") and "`just_in_time`" in row
