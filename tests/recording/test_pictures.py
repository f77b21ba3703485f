"""What is drawn points the right way: starboard is east of north, commands turn as they should."""

from __future__ import annotations

import numpy as np
import pytest

from ship_gym.conventions import FORCES
from ship_gym.recording import panels, plan, scene
from ship_gym.recording.card import run_name

SHIP = scene.ShipShape(L=230.0, B=32.2, d=10.8, A_R=115.0, D_P=7.9)


def rotate(quaternion: np.ndarray, vector: list[float]) -> np.ndarray:
    axis, real = quaternion[:3], quaternion[3]
    spin = 2.0 * np.cross(axis, vector)
    return vector + real * spin + np.cross(axis, spin)


def test_heading_east_points_the_bow_east():
    turn = scene.turned(np.array([np.pi / 2]), axis=2)[0]
    assert rotate(turn, [1.0, 0.0, 0.0]) == pytest.approx([0.0, 1.0, 0.0])


def test_starboard_rudder_has_its_trailing_edge_to_starboard():
    _, low, _ = scene.rudder_plate(SHIP)
    trailing = rotate(scene.turned(np.array([-0.6]), axis=2)[0], [low[0], 0.0, 0.0])
    assert trailing[1] > 0.0


def test_propeller_turns_right_handed():
    columns = {"t": np.array([0.0, 1.0]), "n": np.array([0.25, 0.25])}
    angle = scene.propeller_angle(columns)
    top = rotate(scene.turned(angle, axis=0)[1], [0.0, 0.0, -1.0])
    assert top == pytest.approx([0.0, 1.0, 0.0])  # the upper blade goes to starboard


def test_rudder_and_propeller_fit_under_the_counter():
    stock, low, high = scene.rudder_plate(SHIP)
    centre, vertices, _ = scene.propeller_mesh(SHIP)
    assert stock[2] + high[2] < SHIP.d
    assert stock[2] + low[2] > 0.0
    assert (high[0] - low[0]) * (high[2] - low[2]) == pytest.approx(SHIP.A_R)
    assert centre[2] + vertices[:, 2].max() < SHIP.d
    assert np.linalg.norm(vertices[:, 1:], axis=1).max() == pytest.approx(SHIP.D_P / 2, rel=0.05)
    assert (centre[0] + vertices[:, 0]).min() > stock[0] + high[0]


def test_arrows_point_where_their_names_say():
    columns = {"psi_ordered": [0.0], "current_speed": [0.5], "current_direction_to": [np.pi / 2]}
    columns |= {"wind_speed": [9.0], "wind_direction_from": [0.0], "psi": [np.pi / 2]}
    columns |= {"X_disturbance": [0.0], "Y_disturbance": [5.0]}
    found = scene.arrows({name: np.array(value) for name, value in columns.items()}, 100.0)
    ways = {a.name: a.vectors[0] / np.linalg.norm(a.vectors[0]) for a in found}
    assert ways["ordered_heading"] == pytest.approx([1.0, 0.0, 0.0])
    assert ways["current"] == pytest.approx([0.0, 1.0, 0.0])
    assert ways["wind"] == pytest.approx([-1.0, 0.0, 0.0])
    # starboard of east is south
    assert ways["disturbance_force"] == pytest.approx([-1.0, 0.0, 0.0])


def test_wake_is_whole_and_bounded():
    points = np.cumsum(np.ones((36000, 2)), axis=0)
    rows, pieces = scene.wake(points)
    assert len(rows) <= scene.MOST_WAKE_POINTS
    assert rows[0] == 0
    assert rows[-1] == 35999
    assert np.array_equal(pieces[1:, 0], pieces[:-1, 1])


def test_plan_has_north_up_and_east_right():
    assert plan.to_plan(np.array([1.0, 0.0])).tolist() == [0.0, -1.0]
    assert plan.to_plan(np.array([0.0, 1.0])).tolist() == [1.0, 0.0]
    low, high = plan.plan_bounds(np.array([[0.0, 0.0], [400.0, -100.0]]), 50.0)
    assert (high - low).tolist() == [500.0, 500.0]
    lines, places, labels = plan.grid_lines(low, high)
    assert len(places) == len(labels) == len(lines) - 1  # none in the corner
    assert "E 100 m" in labels
    assert "N 100 m" in labels
    assert "E 0 m" not in labels  # it would hide the lowest one of the north


def test_heading_is_drawn_without_jumps():
    psi = (np.linspace(0.0, 4.0 * np.pi, 50) + np.pi) % (2.0 * np.pi) - np.pi
    columns = {"psi": psi, "psi_ordered": np.zeros(50)}
    heading, ordered = panels.steering_panels(columns)[0].series
    assert np.abs(np.diff(heading.values)).max() < 20.0
    assert heading.values[-1] == pytest.approx(720.0)
    assert np.abs(heading.values - ordered.values).max() <= 180.0 + 1e-9


def test_two_propellers_and_rudders_are_drawn_side_by_side_where_they_are_recorded():
    columns = {"thrust": np.array([9e3, 8e3]), "rudder_normal_force": np.array([1.0, 2.0])}
    assert panels.motion_panels(columns) == []  # one of each, and recordings from before
    for side, size in (("starboard", 1.0), ("port", 2.0)):
        columns[f"thrust_{side}"] = size * np.array([3e3, 2e3])
        columns[f"rudder_normal_force_{side}"] = size * np.array([0.3, -0.5])
    thrust, normal = panels.motion_panels(columns)
    assert thrust.title == "Thrust of each propeller [kN]"
    assert normal.title == "Normal force of each rudder [N]"
    assert [s.label for s in thrust.series] == ["starboard", "port"]
    assert thrust.series[1].values.tolist() == [6.0, 4.0]
    assert normal.series[0].values.tolist() == [0.3, -0.5]


def test_forces_are_grouped_by_axis_in_a_fitting_unit():
    columns = {f"{a}_{c}": np.array([-2e3, 1e3]) for a in "XN" for c in ("wind", "rudder", "hull")}
    surge, yaw = panels.motion_panels(columns)
    assert surge.title == "X: surge force [kN]"
    assert yaw.title == "N: yaw moment [kN m]"
    assert [s.label for s in surge.series] == ["hull", "rudder", "wind"]
    assert surge.series[0].values.tolist() == [-2.0, 1.0]


def test_given_heading_error_comes_first():
    columns = {"psi": np.ones(1), "psi_ordered": np.zeros(1), "psi_error": np.full(1, 0.5)}
    assert panels.heading_error(columns) == [0.5]
    del columns["psi_error"]
    assert panels.heading_error(columns) == [1.0]
    del columns["psi_ordered"]
    assert panels.heading_error(columns) is None


def test_run_names():
    assert run_name({}) == "Ship Gym run"
    assert (
        run_name({"task": "heading", "ship": {"name": "kcs"}, "seed": 0}) == "heading, kcs, seed 0"
    )


def test_hull_is_seen_rolling_to_starboard_and_swaying():
    columns = {name: np.zeros(1) for name in ("x", "y", "psi", "wave_yaw")}
    columns["psi"] += 0.5 * np.pi - 0.1
    columns |= {"wave_yaw": np.array([0.1]), "wave_roll": np.array([0.2])}
    columns["wave_sway"] = np.array([3.0])
    places, turns = scene.pose(columns)
    assert places[0] == pytest.approx([-3.0 * np.cos(0.1), 3.0 * np.sin(0.1), 0.0])
    assert rotate(turns[0], [1.0, 0.0, 0.0]) == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    starboard = rotate(turns[0], [0.0, 1.0, 0.0])
    assert starboard == pytest.approx([-np.cos(0.2), 0.0, np.sin(0.2)])  # south and down


def test_old_recordings_have_the_heading_alone():
    columns = {"x": np.zeros(2), "y": np.zeros(2), "psi": np.array([0.0, 0.7])}
    places, turns = scene.pose(columns)
    assert np.array_equal(places, np.zeros((2, 3)))
    assert np.array_equal(turns, scene.turned(columns["psi"], axis=2))


def test_wave_and_wind_forces_have_arrows_of_one_scale_where_they_act():
    columns = {"psi": np.full(2, 0.5 * np.pi), "X_wave": np.zeros(2), "Y_wave": np.array([4.0, 2])}
    columns |= {"X_wind": np.array([1.0, 1.0]), "Y_wind": np.zeros(2)}
    columns |= {f"{axis}_disturbance": np.zeros(2) for axis in "XY"}
    wave, wind = scene.arrows(columns, 100.0)
    assert (wave.name, wind.name) == ("wave_force", "wind_force")
    assert wave.vectors[0] == pytest.approx([-50.0, 0.0, 0.0])  # to starboard of east is south
    assert wind.vectors[1] == pytest.approx([0.0, 12.5, 0.0])


def test_wave_frequency_motion_is_drawn_in_waves_only():
    columns = {name: np.zeros(3) for name in ("psi", "r", "wave_roll", "wave_yaw")}
    columns["wave_yaw_rate"] = np.zeros(3)
    titles = [panel.title for panel in panels.motion_panels(columns)]
    assert titles == ["Rate of turn [deg/s]"]
    columns |= {"wave_roll": np.full(3, 0.1), "wave_yaw": np.full(3, 0.02)}
    columns["wave_yaw_rate"] += 0.03
    heading = panels.steering_panels(columns)[0].series
    rate, motion = panels.motion_panels(columns)
    assert [s.label for s in heading] == ["in waves", "true"]
    assert heading[0].values == pytest.approx(np.degrees(0.02))
    assert rate.series[0].values == pytest.approx(np.degrees(0.03))
    assert [s.label for s in motion.series] == ["roll", "yaw"]
    assert motion.series[0].values == pytest.approx(np.degrees(0.1))


def luminance(color) -> float:
    """Relative luminance of a colour, WCAG 2.1."""
    share = np.array(color) / 255.0
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def test_lines_are_readable_on_black_and_on_white():
    columns = {name: np.array([0.0, 1.0]) for name in ("t", "u", "v", "psi", "delta", "n", "r")}
    columns |= {name: np.array([0.0, 1.0]) for name in ("psi_ordered", "psi_measured", "J")}
    columns |= {f"reward_{k}": np.array([0.0, 1.0]) for k in range(8)}
    columns |= {f"X_{force.name}": np.array([0.0, 1.0]) for force in FORCES}
    meta = {"ship": {"delta_max": 0.6}, "limits": {"heading_error_deg": 60.0}}
    drawn = panels.steering_panels(columns, meta) + panels.motion_panels(columns, None, meta)
    colors = {series.color for panel in drawn for series in panel.series}
    assert len(colors) > 8
    for color in colors:
        light = luminance(color)
        assert 1.05 / (light + 0.05) > 2.6, color  # on white
        assert (light + 0.05) / 0.054 > 2.6, color  # on the viewer's black, 13 of 255


def test_at_most_four_plots_are_seen_at_once_and_the_first_is_what_is_judged():
    columns = {name: np.array([0.0, 1.0]) for name in ("t", "u", "v", "psi", "delta", "n")}
    columns |= {"psi_ordered": np.zeros(2), "reward": np.zeros(2), "off_route": np.zeros(2)}
    names = [panel.name for panel in panels.steering_panels(columns)]
    assert names == ["heading", "rudder", "speed", "reward"]
    meta = panels.plots_meta([("off_route", "Off the route [m]", ("off_route",))])
    meta["limits"] = {"corridor": 300.0, "cross_track": 1000.0}
    first, *rest = panels.steering_panels(columns, meta)
    assert first.name == "off_route"
    assert [line.values[0] for line in first.series if line.limit] == [300, -300, 1000, -1000]
    assert [panel.name for panel in rest] == ["rudder", "speed", "reward"]
    assert "heading" in [panel.name for panel in panels.motion_panels(columns, None, meta)]


def test_heading_is_true_and_begins_in_the_circle():
    psi = np.radians([-10.0, -20.0, -30.0])
    columns = {"psi": psi, "psi_ordered": np.radians([-15.0] * 3), "t": np.arange(3.0)}
    panel = panels.steering_panels(columns, {"limits": {"heading_error_deg": 60.0}})[0]
    lines = {series.label: series.values for series in panel.series if not series.limit}
    assert lines["true"] == pytest.approx([350.0, 340.0, 330.0])
    assert lines["ordered"] == pytest.approx([345.0] * 3)
    assert panel.title == "Heading [deg true]"
    columns["psi"] = np.radians([350.0, 380.0])[[0, 1, 1]]
    panel = panels.steering_panels(columns)[0]
    assert panel.series[0].values[1] == pytest.approx(380.0)
    assert "beyond 000-360" in panel.title


def test_the_penalty_of_the_end_does_not_flatten_the_reward():
    columns = {"t": np.arange(4.0), "reward": np.array([-1.0, -2.0, -203.0, 0.0])}
    columns |= {"reward_heading": np.array([-1.0, -2.0, -3.0, 0.0])}
    columns |= {"reward_termination": np.array([0.0, 0.0, -200.0, 0.0])}
    (panel,) = panels.steering_panels(columns)
    assert "-200 for the end is left out" in panel.title
    assert [series.label for series in panel.series] == ["heading", "all"]
    for series in panel.series:
        assert series.values.tolist() == [-1.0, -2.0, -3.0, -3.0]  # the last row has no interval


def test_speeds_through_water_and_over_ground_and_the_propeller_on_one_axis():
    columns = {"u": np.full(2, 7.0), "v": np.zeros(2), "psi": np.zeros(2), "n": np.full(2, 1.0)}
    columns |= {"current_speed": np.full(2, 1.0), "current_direction_to": np.zeros(2)}
    panel = panels.steering_panels(columns)[-1]
    lines = {series.label: series.values[0] for series in panel.series}
    assert lines == pytest.approx({"over ground": 7.0, "through water": 6.0, "rpm / 10": 6.0})
    columns["current_speed"] = np.zeros(2)
    panel = panels.steering_panels(columns)[-1]
    assert [series.label for series in panel.series] == ["through water", "rpm / 10"]


def test_arrows_say_what_they_show():
    columns = {"t": np.zeros(2), "psi": np.zeros(2), "psi_ordered": np.radians([5.0, 90.0])}
    columns |= {"current_speed": np.full(2, 0.8), "current_direction_to": np.full(2, 0.5 * np.pi)}
    columns |= {"wind_speed": np.full(2, 12.3), "wind_direction_from": np.radians([245.0] * 2)}
    sea = {"wave_height": 6.0, "wave_period": 12.4, "wave_direction_to": np.radians(30.0)}
    found = {arrow.name: arrow for arrow in scene.arrows(columns, 230.0, {"sea": sea})}
    assert found["ordered_heading"].labels.tolist() == [
        "ordered 005\N{DEGREE SIGN}",
        "ordered 090\N{DEGREE SIGN}",
    ]
    assert found["waves"].labels[0] == "waves H 6.0 m, T 12.4 s from 210\N{DEGREE SIGN}"
    assert found["wind"].labels[0] == "wind 12.3 m/s from 245\N{DEGREE SIGN}"
    assert found["current"].labels[0] == "current 0.80 m/s to 090\N{DEGREE SIGN}"
    way = found["waves"].vectors[0] / np.linalg.norm(found["waves"].vectors[0])
    assert way == pytest.approx([np.cos(np.radians(30.0)), np.sin(np.radians(30.0)), 0.0])
    columns["current_speed"] = np.full(2, 0.01)  # next to nothing has no arrow
    assert "current" not in {arrow.name for arrow in scene.arrows(columns, 230.0)}


def test_waves_wind_and_current_from_one_side_do_not_lie_on_each_other():
    columns = {"t": np.zeros(1), "psi": np.zeros(1)}
    columns |= {"current_speed": np.ones(1), "current_direction_to": np.zeros(1)}
    columns |= {"wind_speed": np.full(1, 20.0), "wind_direction_from": np.full(1, np.pi)}
    sea = {"wave_height": 6.0, "wave_period": 12.4, "wave_direction_to": 0.0}
    found = scene.flow_arrows(columns, 230.0, {"sea": sea})
    middles = np.array([arrow.origins[0] + 0.5 * arrow.vectors[0] for arrow in found])
    heights = np.sort(middles[:, 2])
    assert len(found) == 3
    assert np.diff(heights).min() > 0.09 * 230.0
