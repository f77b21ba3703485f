"""Routes of an ECDIS sailed: a short one to its end, those of others as far as is quick."""

import itertools
import json
import math
from pathlib import Path

import numpy as np
import pytest
from ship_gym_agents.los import ILOS

from ship_gym.charts import Chart
from ship_gym.config import ConfigError
from ship_gym.envs.env import ShipEnv
from ship_gym.evaluation.rollout import rollout
from ship_gym.recording.earth import sailed_places
from ship_gym.tracks.files import load_route, load_track

pytest.importorskip("pyproj")
pytest.importorskip("defusedxml")
FIELD = Path(__file__).parents[2] / "../shared/reference/field"
CALM = {"sea.states": [], "sea.gusts": False, "sea.current_speed": 0.0, "sensors.noise": False}
# Three legs off Kiel: north for 1.6 nm, north-east for 1.3 nm, east for 0.9 nm; XTD differs by
# leg and side, planned radii of 0.4 nm [741 m, 3.2 L]
HARBOUR = Path(__file__).parents[2] / "docs/examples/kiel.rtz"


def on_file(path, **changes):
    """Overrides that sail a file."""
    return {"track.kind": "points", "track.file": str(path)} | changes


@pytest.fixture(scope="module")
def sailed():
    return rollout(ILOS(), "track_following", seeds=[5], overrides=on_file(HARBOUR)).trajectory(0)


def test_a_short_route_is_sailed_to_its_end_within_the_limits_of_its_legs(sailed):
    assert sailed.meta["outcome"] == "arrived" and sailed.meta["metrics"]["corridor"] == 1.0
    nmi = 1852.0
    own = {(0.12 * nmi, 0.10 * nmi), (0.20 * nmi, 0.15 * nmi), (0.10 * nmi, 0.10 * nmi)}
    found = {tuple(pair) for pair in np.round(sailed.meta["leg_limits"], 6).tolist()}
    assert found == {tuple(np.round(pair, 6)) for pair in own}
    off = sailed["off_route"]
    assert (off <= sailed["corridor_starboard"]).all() and (-off <= sailed["corridor_port"]).all()
    assert len(np.unique(sailed["corridor_port"])) == 3
    assert len(sailed.meta["leg_of"]) > 3  # planned turns are pieces
    assert len({round(math.degrees(v)) for v in sailed["psi_ordered"]}) > 10


def test_its_recording_lies_on_the_earth(sailed):
    """Its last place is as far from the last way-point as in the plane, by geographiclib."""
    geodesic = pytest.importorskip("geographiclib.geodesic").Geodesic.WGS84
    assert "chart" in sailed.meta["frame"] and json.dumps(sailed.meta)
    chart = Chart.from_meta(sailed.meta["chart"])
    lat, lon = sailed_places(sailed, chart)
    last = sailed.meta["waypoints"][-1]
    plane = math.hypot(sailed["x"][-1] - last[0], sailed["y"][-1] - last[1])
    earth = geodesic.Inverse(lat[-1], lon[-1], 54.492, 10.302)["s12"]
    assert earth == pytest.approx(plane, abs=0.01) and plane < 0.10 * 1852.0
    # sailed length on the earth and in the plane
    places = np.column_stack([lat, lon]).tolist()
    steps = itertools.pairwise(places)
    legs = [geodesic.Inverse(*one, *other)["s12"] for one, other in steps]
    flat = np.hypot(np.diff(sailed["x"]), np.diff(sailed["y"])).sum()
    assert sum(legs) == pytest.approx(flat, rel=1e-4)


def test_a_turn_that_she_cannot_make_is_refused_with_its_way_point():
    told = r"kiel.rtz.*way-point 1 \(id 2\).*planned radius of 741 m.*4600 m.*turn_radius = 20"
    with pytest.raises(ConfigError, match=told):
        ShipEnv(
            scenario="track_following", overrides=on_file(HARBOUR, **{"track.turn_radius": 20.0})
        )


def test_geometry_is_of_files_that_do_not_say_it(tmp_path):
    file = tmp_path / "line.geojson"
    line = {"type": "LineString", "coordinates": [[5.0, 60.0], [9.5, 60.0]]}
    feature = {"type": "Feature", "properties": {"units": "deg"}, "geometry": line}
    file.write_text(json.dumps(feature))
    for geometry, pieces in (("loxodrome", 1), ("orthodrome", 10)):
        env = ShipEnv(
            scenario="track_following", overrides=on_file(file, **{"track.geometry": geometry})
        )
        env.reset(seed=0)
        assert len(env.episodes.plans[0]) - 1 >= pieces
        bearing = math.degrees(env.episodes.tasks["psi_ordered"][0])
        # the great circle sets out half the difference of longitude times sin(lat) to the north
        assert bearing == pytest.approx(90.0 if pieces == 1 else 90.0 - 2.25 * 0.866, abs=0.1)
    with pytest.raises(ConfigError, match=r"only of a track\.file"):
        ShipEnv(scenario="track_following", overrides={"track.geometry": "orthodrome"})
    with pytest.raises(ConfigError, match="geometry"):
        ShipEnv(scenario="track_following", overrides=on_file(file, **{"track.geometry": "arc"}))


@pytest.fixture
def field():
    def path(name):
        found = FIELD / name
        if not found.is_file():
            pytest.skip(f"no {found}")
        return found

    return path


def test_the_field_route_of_all_elements_is_sailed_past_its_first_way_points(field):
    """From the terminal round the pilots' buoy (0.3 nm) into the great circle to California."""
    path = field("RTZ1.2AllOptionalElementsAndAttributes.rtz")
    track = load_track(path)
    assert len(load_route(path).waypoints) == 6 and track.total_length > 8e6
    short = on_file(path, duration=900.0) | CALM
    run = rollout(ILOS(), "track_following", seeds=[0], overrides=short).trajectory(0)
    assert not run.meta["failed"] and run.meta["metrics"]["corridor"] == 1.0
    pieces = np.array(run.meta["leg_of"])
    assert pieces[int(run["leg"][-1])] == 1  # on the ocean leg
    assert run["corridor_port"][0] == pytest.approx(0.1 * 1852.0)  # inherited
    assert run["corridor_port"][-1] == pytest.approx(1.1 * 1852.0)


def test_the_field_route_round_the_world_begins(field):
    path = field("JPNGO_STLAW_BASIC_RTZ.rtz")
    run = rollout(
        ILOS(), "track_following", seeds=[0], overrides=on_file(path, duration=300.0)
    ).trajectory(0)
    assert not run.meta["failed"] and "leg_limits" not in run.meta
    lat, lon = sailed_places(run, Chart.from_meta(run.meta["chart"]))
    assert (lat[0], lon[0]) == pytest.approx((34.25855, 137.178817), abs=2e-3)
    assert lat[-1] < lat[0] and lon[-1] > lon[0]  # south of east, across the antimeridian
