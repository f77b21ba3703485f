"""Options of ``ship-gym serve`` that are more than a number: pairs, addresses, the route."""

from __future__ import annotations

import ipaddress
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

PLACE = (54.0, 8.0)  # latitude and longitude [deg] without a route: the German Bight
_ALL = "all"
_MOST = 1000.0  # sentences in a second


class Waters(NamedTuple):
    """Where the ship sails: chart, track or None, position [m] and heading [rad] at the start."""

    chart: Any
    track: Any
    position: tuple[float, float]
    heading: float

    def meta(self) -> dict[str, Any]:
        """What a recording says of it."""
        found = {"chart": self.chart.to_meta()}
        route = None if self.track is None else self.track.route
        return found if route is None else found | {"route": route.to_meta()}


def waters(route: str | None, at: tuple[float, float] | None, heading: float | None) -> Waters:
    """Chart and start, from ``--route``, ``--at`` and ``--heading`` [deg]."""
    from ship_gym.charts import Chart
    from ship_gym.config import ConfigError
    from ship_gym.tracks.files import load_track

    angle = None if heading is None else math.radians(heading)
    if route is None:
        return Waters(Chart.about(*(at or PLACE)), None, (0.0, 0.0), angle or 0.0)
    track = load_track(route)
    if track.chart is None:
        raise ConfigError(f"--route {route}: is in metres; serve needs a route on a chart")
    places = track.chart.plane(*at) if at else track.points[0]
    position = float(places[0]), float(places[1])
    return Waters(
        track.chart, track, position, float(track.leg_bearings[0]) if angle is None else angle
    )


def check_clock(lockstep: bool, patience: float | None, speed_up: float) -> None:
    """Refuse an option of a clock that is not there."""
    from ship_gym.config import ConfigError

    if patience is not None and not lockstep:
        raise ConfigError(f"--patience {patience:g}: is of --lockstep; else --duration ends it")
    if lockstep and speed_up != 1.0:
        raise ConfigError(f"--speed-up {speed_up:g}: in --lockstep time waits for orders alone")


def rates(given: Sequence[str]) -> dict[str, float]:
    """Sentences in a second by kind, of ``--rate HDT=20 GGA=0``."""
    return _pairs("--rate", given, _rate, f"a number from 0 to {_MOST:g}")


def talkers(given: Sequence[str]) -> dict[str, str]:
    """Two letters by kind, of ``--talker HDT=GP`` or ``all=II``."""
    return _pairs("--talker", given, _talker, "two letters")


def _pairs(
    option: str, given: Iterable[str], value_of: Callable[[str], Any], what: str
) -> dict[str, Any]:
    from ship_gym.config import ConfigError, check_known
    from ship_gym_agents.serve.talk import TALKERS

    found: dict[str, Any] = {}
    for pair in given:
        kind, _, text = pair.partition("=")
        if kind != _ALL:
            check_known(f"sentence of {option}", kind, [*TALKERS, _ALL])
        if (value := value_of(text)) is None:
            raise ConfigError(f"{option} {pair[:60]}: must be KIND=VALUE, {what}")
        found |= dict.fromkeys(TALKERS if kind == _ALL else [kind], value)
    return found


def _rate(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if 0.0 <= value <= _MOST else None


def _talker(text: str) -> str | None:
    return text if len(text) == 2 and text.isascii() and text.isalpha() and text.isupper() else None


def targets(given: Iterable[str], listen: str, kinds: Sequence[str]) -> list[tuple[str, int]]:
    """Addresses and ports of ``--udp-to``, such as 127.0.0.1:2000 or [::1]:2000."""
    from ship_gym.config import ConfigError
    from ship_gym_agents.serve.binding import ip_of

    found, own = [], ip_of(listen)
    for text in given:
        host, _, port = text.rpartition(":")
        try:
            ip = ipaddress.ip_address(host.strip("[]"))
        except ValueError:
            ip = None
        number = int(port) if port.isascii() and port.isdigit() and len(port) < 6 else 0
        if ip is None or not 1 <= number <= 65535:
            raise ConfigError(
                f"--udp-to {text[:60]}: must be an IP address and a port, 127.0.0.1:2000"
            )
        if "udp" not in kinds:
            raise ConfigError(f"--udp-to {text}: with --only tcp there is no UDP")
        if ip.version != own.version or (own.is_loopback and not ip.is_loopback):
            raise ConfigError(f"--udp-to {text}: cannot be reached from {own}; see --listen")
        found.append((str(ip), number))
    return found


def told(found: Mapping[str, Any]) -> str:
    """The result for people."""
    now = found["now"]
    where = " and ".join(f"{kind} {address}:{port}" for kind, address, port in found["listened"])
    heading = round(now["heading_deg"], 1) % 360.0
    lines = [
        f"served on {where}: {found['intervals']} intervals of {found['interval']:g} s, "
        f"ended: {found['ended']}",
        f"heading {heading:.1f} deg, speed {now['speed']:.2f} m/s, rudder "
        f"{now['rudder_deg']:.1f} deg at {now['time']:.1f} s, steered by a {found['steered_by']}",
    ]
    for name in ("sent", "orders", "ignored", "clients"):
        counts = ", ".join(f"{kind} {count}" for kind, count in found[name].items())
        lines.append(f"{name:<8} {counts or 'none'}")
    for why, each in found["dropped"].items():
        lines.append(f"dropped  {each['count']} for {why}, the latest: {each['what']}")
    if found["late_intervals"]:
        lines.append(
            f"late     {found['late_intervals']} intervals; {found['speed_up']:g} seconds of the "
            "ship in one was all"
        )
    return "\n".join(lines)
