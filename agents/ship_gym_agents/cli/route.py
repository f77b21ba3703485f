"""``ship-gym route``."""

from __future__ import annotations

from typing import Any

import click

from ship_gym_agents.cli.options import force, out, verb
from ship_gym_agents.cli.values import Number

_NOTES = """
formats:
  rtz      RTZ 1.0 to 1.2 (ECDIS); written as 1.2
  gpx      GPX routes, else tracks; radius, limits and speeds in an extension of ours
  geojson  LineString, MultiLineString or Points in degrees; or in metres with "units": "m"
"""


@verb(
    "voyage.rtz                              # its legs and turns",
    "voyage.rtz --out voyage.gpx",
    "track.gpx --geometry orthodrome --out track.rtz --picture track.png",
    "logged.gpx --simplify 20 --out route.gpx            # a track as a receiver logs it",
    "tank.geojson --origin 52.0 4.37 --out tank.gpx      # metres from a place",
    notes=_NOTES,
)
@click.argument("file", type=click.Path())
@click.option(
    "--geometry",
    metavar="loxodrome|orthodrome",
    help="Legs of which the file says nothing; default: loxodrome (rhumb line).",
)
@click.option(
    "--origin",
    nargs=2,
    type=Number(-180.0, 180.0, "deg"),
    metavar="LATITUDE LONGITUDE",
    help="Where north = east = 0 of a track in metres lies [deg].",
)
@click.option("--name", help="Which route or track of a GPX file that holds several.")
@click.option(
    "--simplify",
    type=Number(1e-3, 1e6, "m"),
    metavar="METRES",
    help="Leave out way-points of a logged track that lie so near to the rest of it.",
)
@out(".rtz", "Write the route; the extension says how.", more=(".gpx", ".geojson"))
@out(".png", "Also draw it.", "--picture")
@force()
def command(as_json, file, geometry, origin, name, simplify, out, picture, force) -> None:
    """Show a route of an ECDIS or a plotter: legs, turns, limits; write it anew.

    Bearings and lengths are those on the earth (WGS84) of each leg as it runs: rhumb line or great
    circle. Turns with a radius are sailed as arcs.
    """
    from ship_gym.config import ConfigError, told_of
    from ship_gym.tracks import load_route, save_track, simplified
    from ship_gym_agents.cli.output import need, next_command, show
    from ship_gym_agents.cli.replace import check_replaced
    from ship_gym_agents.cli.replace import route as result_of

    if picture:
        need("matplotlib")
    if origin and geometry:
        raise ConfigError(f"--geometry {geometry}: --origin is for a track in metres, on no chart")
    if origin and name:
        raise ConfigError(f"--name {name}: --origin is for a track in metres, which has none")
    route = _placed(file, origin) if origin else load_route(file, geometry, name)
    with told_of(file):
        route = route if simplify is None else simplified(route, simplify)
        track = route.track()
    if out is not None:
        check_replaced(out, result_of(route.to_meta(), out), force)
        save_track(route, out)
    if picture is not None:
        from ship_gym.plotting.route import plot_route

        plot_route(track, picture)
    written = [str(path) for path in (out, picture) if path is not None]
    data = _data(file, route, track, written)
    settings = ["track.kind=points", f"track.file={out or file}"]
    settings += [f"track.geometry={geometry}"] if geometry and out is None else []
    following = next_command("record", task="track_following", set=settings)
    text = "\n".join([_text(data), *(f"wrote {name}" for name in written), f"next: {following}"])
    show(as_json, data, text)


def _placed(file: str, origin: tuple[float, float]) -> Any:
    """Route of a track in metres about a place."""
    from ship_gym.charts import Chart
    from ship_gym.config import ConfigError
    from ship_gym.tracks import Route, Waypoint, load_track

    chart, track = Chart.about(*origin), load_track(file)
    if track.chart is not None:
        raise ConfigError(f"--origin: {file} has places on the earth; it is for a track in metres")
    places = zip(*(v.tolist() for v in chart.place(*track.points.T)), strict=True)
    return Route("", tuple(Waypoint(*place) for place in places))


def _data(file: str, route: Any, track: Any, written: list[str]) -> dict[str, Any]:
    """What is known of the route, for JSON."""
    import numpy as np

    made, lines = route.to_meta(), route.lines()
    degrees = np.degrees([lines.bearing, lines.bearing_there]) % 360.0
    legs = [
        leg | {"bearing_deg": there, "bearing_at_end_deg": end, "length": length}
        for leg, there, end, length in zip(
            made["legs"], *degrees.tolist(), lines.length.tolist(), strict=True
        )
    ]
    return {
        "file": str(file),
        "name": route.name,
        "length": float(lines.length.sum()),
        "waypoints": made["waypoints"],
        "legs": legs,
        "plane": {"legs": len(track.points) - 1, "length": track.total_length},
        "written": written,
    }


def _text(data: dict[str, Any]) -> str:
    from ship_gym.conventions import KNOT
    from ship_gym.text import table

    head = [*("", "way-point", "latitude", "longitude", "by", "bearing", "length", "port")]
    head += ["starboard", "speed", "radius"]
    units = ("", "", "deg", "deg", "", "deg", "NM", "m", "m", "kn", "m")
    rows = [units]
    for i, point in enumerate(data["waypoints"]):
        leg = data["legs"][i - 1] if i > 0 else None
        place = (f"{point['latitude']:.6f}", f"{point['longitude']:.6f}")
        rows.append((str(i), point["name"], *place, *_leg(leg, KNOT), _number(point["radius"])))
    plane = data["plane"]
    name = data["name"] or "without a name"
    return "\n".join(
        [
            f"route {name}: {len(data['waypoints'])} way-points, {data['length'] / 1852.0:.2f} NM "
            f"= {data['length'] / 1e3:.2f} km",
            "",
            table(head, rows),
            "",
            f"sailed as {plane['legs']} straight pieces, {plane['length'] / 1e3:.2f} km with its "
            "turns",
        ]
    )


def _leg(leg: dict[str, Any] | None, knot: float) -> tuple[str, ...]:
    """Cells of the leg that leads to a way-point."""
    if leg is None:
        return ("",) * 6
    bearing = f"{leg['bearing_deg']:05.1f}"
    end = f"{leg['bearing_at_end_deg']:05.1f}"
    return (
        leg["geometry"],
        bearing if bearing == end else f"{bearing}-{end}",
        f"{leg['length'] / 1852.0:.2f}",
        _number(leg["port"]),
        _number(leg["starboard"]),
        _speeds(*(v and f"{v / knot:.3g}" for v in (leg["speed_min"], leg["speed_max"]))),
    )


def _speeds(low: str | None, high: str | None) -> str:
    if low and high:
        return f"{low}-{high}"
    return f"from {low}" if low else f"to {high}" if high else ""


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.0f}"
