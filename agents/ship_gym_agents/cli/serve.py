"""``ship-gym serve``."""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import Several, environment, force, out, seed, verb
from ship_gym_agents.cli.values import Name, Number, whole

_INTERVAL = 0.1  # [s] between orders in real time: a gyro talks ten times a second
_NOTES = """
Sent: HDT ROT RSA VBW RMC GGA MWV, with a route XTE APB. Understood: HSC and HTC (headings, HTC
also rudder angles), ROR (rudder angles), with --apb APB. docs/autopilot_loop.md has every field.
Whoever reaches the port steers the ship: no one is asked who he is.
"""


@verb(
    "  # kcs in calm water, real time, 127.0.0.1 port 10110, until Ctrl-C",
    "--scenario heading_ss5_bow --speed-up 10 --duration 3600 --record runs/served.rrd",
    "--route route.rtz --ship kvlcc2 --rate HDT=5 GGA=0 --talker all=II",
    "--lockstep --duration 600 --json  # waits for an order in every interval",
    notes=_NOTES,
)
@click.option("--port", type=whole(0, 65535), default=10110, help="0: any free one.")
@click.option("--listen", metavar="ADDRESS", default="127.0.0.1", help="IP address to bind to.")
@click.option("--only", type=click.Choice(["tcp", "udp"]), help="Default: both.")
@click.option(
    "--udp-to",
    cls=Several,
    metavar="ADDRESS:PORT",
    help="Also send all sentences there as datagrams, unasked.",
)
@click.option(
    "--controller", type=Name("controllers"), default="pid", help="Keeps headings that are ordered."
)
@environment("heading_calm, kcs, rudder")
@seed("Of sea and noise.")
@click.option(
    "--heading", type=Number(0.0, 360.0, "deg"), help="At the start; default: 0 or the route's."
)
@click.option(
    "--at",
    type=(Number(-89.0, 89.0, "deg"), Number(-180.0, 180.0, "deg")),
    metavar="LAT LON",
    help="Place at the start [deg]; default: 54 8, or where the route begins.",
)
@click.option("--route", type=click.Path(), help="File of a route on a chart, for XTE and APB.")
@click.option(
    "--interval",
    type=Number(1e-3, 60.0, "s"),
    help=f"Between orders [s]; default: {_INTERVAL}, in lockstep the scenario's.",
)
@click.option(
    "--duration", type=Number(1e-3, 1e6, "s"), help="Of the voyage [s]; default: to Ctrl-C."
)
@click.option(
    "--speed-up", type=Number(1e-2, 1e4), default=1.0, help="Seconds of the ship in a second."
)
@click.option("--lockstep", is_flag=True, help="Time stands still until an order comes.")
@click.option(
    "--patience", type=Number(1e-3, 1e6, "s"), help="Longest wait of lockstep; default: for ever."
)
@click.option(
    "--rate",
    cls=Several,
    metavar="KIND=NUMBER",
    help="Sentences in a second, HDT=5; 0: none; all=1.",
)
@click.option("--talker", cls=Several, metavar="KIND=XX", help="Who talks, HDT=GP; all=II.")
@click.option(
    "--apb", is_flag=True, help="Also obey the heading to steer of APB, as plotters send it."
)
@click.option(
    "--simulated", is_flag=True, help="Mark positions as a simulator's; receivers may refuse them."
)
@out(".rrd", "Also record the voyage.", "--record")
@force()
def command(as_json, task, controller, record, force, **options) -> None:
    """Sail a ship on NMEA 0183 over TCP and UDP, steered by another autopilot.

    In real or accelerated time, for an autopilot, a plotter or your own program. She keeps her
    heading until an order comes, of a rudder angle or of a heading; the last one holds. What was
    sent, understood and dropped is printed at the end. Times are the ship's own.
    """
    from ship_gym_agents.cli.output import need, show
    from ship_gym_agents.cli.serve_settings import told

    need("pynmea2", "pyproj", *(["rerun"] if record else []))
    found = _serve(task, controller, record, force, options)
    text, following = told(found), {}
    if found["file"]:
        from ship_gym_agents.cli.review.files import next_review

        following = {"next": next_review("show", record)}
        text += f"\n\nwrote {found['file']}\nnext: {following['next']}"
    show(as_json, found | following, text)


def _serve(task, controller, record: Path | None, force, options) -> dict[str, Any]:
    """Sail; all is refused before a port is opened, and nothing is written before one is."""
    from ship_gym_agents.cli import serve_settings as settings
    from ship_gym_agents.cli.replace import check_replaced, recording
    from ship_gym_agents.serve.ports import Ports
    from ship_gym_agents.serve.record import CONTROLLER, VoyageRecord
    from ship_gym_agents.serve.server import Server
    from ship_gym_agents.serve.voyage import Voyage

    kinds = (options["only"],) if options["only"] else ("tcp", "udp")
    how = {
        "rates": settings.rates(options["rate"]),
        "talkers": settings.talkers(options["talker"]),
        **{
            name: options[name] for name in ("speed_up", "lockstep", "patience", "apb", "simulated")
        },
    }
    settings.check_clock(options["lockstep"], options["patience"], options["speed_up"])
    to = settings.targets(options["udp_to"], options["listen"], kinds)
    waters = settings.waters(options["route"], options["at"], options["heading"])
    vessel = _vessel(task, controller, waters, options)
    if waters.track is not None:
        how["voyage"] = Voyage(waters.track, vessel.ship.hull.L)
    held = recording(CONTROLLER, vessel.seed, vessel.scenario.to_dict())
    check_replaced(record, held, force, "--record")
    with Ports(options["listen"], options["port"], kinds, tuple(to)) as ports:
        kept = VoyageRecord(record, vessel, waters.meta()) if record else None
        server = Server(vessel, ports, waters.chart, **how)
        _announce(ports)
        try:
            with _signals(server):
                server.run(_bar)
        except BaseException:
            if kept is not None:
                kept.give_up()
            raise
        found = {"listened": [list(each) for each in ports.bound], **server.plain()}
    return found | {"file": str(record) if kept is not None and kept.finish() else None}


def _vessel(task, controller, waters, options: Mapping[str, Any]) -> Any:
    from ship_gym_agents.cli.sailing import own_task, wanted
    from ship_gym_agents.controllers import make_controller
    from ship_gym_agents.serve.vessel import SteeredShip

    named = ("scenario", "ship", "control", "overrides")
    env = wanted({name: options[name] for name in named}, own_task(task))
    interval = options["interval"]
    if interval is None and not options["lockstep"]:
        interval = _INTERVAL
    return SteeredShip(
        make_controller(controller),
        **env,
        seed=options["seed"],
        heading=waters.heading,
        position=waters.position,
        interval=interval,
        duration=options["duration"],
    )


def _announce(ports: Any) -> None:
    """Say on stderr where to connect, and who may if that is more than this machine."""
    from ship_gym_agents.serve.binding import ip_of

    kinds = " and ".join(kind.upper() for kind, *_ in ports.bound)
    if not ip_of(ports.address).is_loopback:
        print(
            f"warning: listening on {ports.address}: whoever reaches port {ports.port} hears the "
            "ship and steers her, nobody is asked who he is",
            file=sys.stderr,
        )
    told = f"NMEA 0183 on {ports.address} port {ports.port}, {kinds}; Ctrl-C ends the voyage"
    print(told, file=sys.stderr, flush=True)


@contextlib.contextmanager
def _signals(server: Any) -> Iterator[None]:
    """The first Ctrl-C or SIGTERM ends the voyage in order, the second one at once."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before: dict[int, Any] = {k: signal.getsignal(k) for k in (signal.SIGINT, signal.SIGTERM)}

    def end(number: int, frame: object) -> None:
        server.stop()
        signal.signal(number, before[number])

    for each in before:
        signal.signal(each, end)
    try:
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)


def _bar(steps: Iterable) -> Iterable:
    from ship_gym_agents.cli.output import progress

    return progress(steps, "sailing")
