"""``ship-gym fmu``."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import force, out, seed, ship, verb
from ship_gym_agents.cli.values import Name, Number

# option -> parameter of the unit, and its factor to SI
_PARAMETERS = {
    "surrogate": ("ship.surrogate", None),
    "variant": ("ship.variant", None),
    "sea": ("sea.name", None),
    "wave_height": ("sea.wave_height", 1.0),
    "wave_period": ("sea.wave_period", 1.0),
    "regular": ("sea.regular", None),
    "spreading": ("sea.spreading", 1.0),
    "wave_from": ("sea.wave_direction_from", math.pi / 180.0),
    "swell_height": ("sea.swell_height", 1.0),
    "swell_period": ("sea.swell_period", 1.0),
    "swell_spreading": ("sea.swell_spreading", 1.0),
    "swell_from": ("sea.swell_direction_from", math.pi / 180.0),
    "wind_speed": ("sea.wind_speed", 1.0),
    "wind_from": ("sea.wind_direction_from", math.pi / 180.0),
    "gusts": ("sea.gusts", None),
    "current_speed": ("sea.current_speed", 1.0),
    "current_to": ("sea.current_direction_to", math.pi / 180.0),
    "current_variation": ("sea.current_variation", 1.0),
    "current_period": ("sea.current_period", 1.0),
    "seed": ("seed", None),
    "speed": ("start.speed", 1.0),
    "heading": ("start.heading", math.pi / 180.0),
    "n": ("start.propeller_speed", 1.0),
    "interval": ("integration.interval", 1.0),
}
_OWN = (
    *(("sea.wave_height", "waves"), ("sea.swell_height", "swell")),
    *(("sea.wind_speed", "wind"), ("sea.current_speed", "current")),
)
_COMPASS = Number(-360.0, 360.0, "deg")


@verb(
    "                                   # KCS in calm water: runs/kcs.fmu",
    "--ship onrt --sea ss5 --wave-from 45 --seed 7",
    "--ship mine/ship.toml --wave-height 3.5 --wave-period 9 --wind-speed 12 \\\n"
    "      --current-speed 0.5 --current-to 90 --at 57.70 11.85 --out mine.fmu",
)
@ship(default="kcs")
@click.option("--surrogate", help="Propeller and rudder, e.g. G2_SA or none (MMG rudder).")
@click.option("--variant", help="Other published hull set, e.g. hull_a.")
@click.option("--sea", type=Name("seas"), default="calm", help="calm, current, ss2 to ss8, ...")
@click.option("--wave-height", type=Number(0.0, 30.0, "m"), help="Instead of the sea's waves [m].")
@click.option("--wave-period", type=Number(0.1, 40.0, "s"), help="Peak period of these [s]; 10.")
@click.option("--regular", is_flag=True, help="These are one regular wave, not JONSWAP.")
@click.option("--spreading", type=Number(0.0, 100.0), help="s of cos^(2s); 0: long-crested.")
@click.option("--wave-from", type=_COMPASS, help="Where waves come from [deg]; 0 is north.")
@click.option("--swell-height", type=Number(0.0, 30.0, "m"), help="Of a swell beside them [m].")
@click.option("--swell-period", type=Number(0.1, 40.0, "s"), help="Its peak period [s]; 14.")
@click.option("--swell-spreading", type=Number(0.0, 100.0), help="Its spreading.")
@click.option("--swell-from", type=_COMPASS, help="Where it comes from [deg].")
@click.option("--wind-speed", type=Number(0.0, 60.0, "m/s"), help="Instead of the sea's [m/s].")
@click.option("--wind-from", type=_COMPASS, help="Where wind comes from [deg].")
@click.option("--gusts", is_flag=True, help="The wind has gusts.")
@click.option("--current-speed", type=Number(0.0, 10.0, "m/s"), help="Instead of the sea's [m/s].")
@click.option("--current-to", type=_COMPASS, help="Where this current flows to [deg].")
@click.option("--current-variation", type=Number(0.0, 1.0), help="Share of a slow variation.")
@click.option("--current-period", type=Number(1.0, 1e6, "s"), help="Period of that [s]; 1800.")
@seed("Of waves, gusts, current and disturbance.", largest=2**31 - 1)
@click.option("--speed", type=Number(unit="m/s"), help="At the start [m/s]; default: the ship's.")
@click.option("--heading", type=_COMPASS, help="At the start [deg]; 0 is north.")
@click.option("--n", type=Number(unit="rev/s"), help="Propeller; default: self-propulsion [rev/s].")
@click.option("--interval", type=Number(0.0, 1e3, "s"), help="Longest step inside [s].")
@click.option(
    "--at",
    nargs=2,
    type=Number(-540.0, 540.0, "deg"),
    metavar="LAT LON",
    help="Place of the start [deg]; the unit then gives latitude and longitude.",
)
@click.option("--fmi", type=click.Choice(["2", "3"]), default="2", help="Version of FMI.")
@out(".fmu", "The file's name is the model's; default: runs/ and the ship's name.")
@force()
def command(as_json, ship, at, fmi, out, force, **options) -> None:
    """Write a ship in a sea as FMU (FMI 2.0 or 3.0) for co-simulation.

    All that is set here is only what its parameters start with: a master may set them before it
    initialises the unit. Inputs are rudder and propeller orders; outputs motion, loads, flow and
    wave motion. Beside the FMU stand groups of its variables for the Open Simulation Platform.
    The Python that runs the FMU needs Ship Gym.
    """
    from ship_gym.cosim.write import EXPORTERS, usual_name, write_fmu
    from ship_gym.ships.loader import load_ship
    from ship_gym_agents.cli.output import need, place, show
    from ship_gym_agents.cli.replace import check_replaced, fmu

    need(EXPORTERS[fmi])
    path = place(out, Path("runs") / usual_name(ship))
    check_replaced(out, fmu(load_ship(ship).name), force)
    given = _given(options)
    if at:
        given |= {"start.latitude": at[0], "start.longitude": at[1]}
    files = write_fmu(ship, path, fmi, **given)
    found = {"ship": str(ship), "fmi": fmi, "files": [str(file) for file in files], "values": given}
    show(as_json, found | {"bytes": files[0].stat().st_size}, _as_text(found, files[0]))


def _given(options: dict[str, Any]) -> dict[str, Any]:
    """Values of the parameters whose options were given."""
    given = {
        _PARAMETERS[name][0]: value * _PARAMETERS[name][1] if _PARAMETERS[name][1] else value
        for name, value in options.items()
        if value is not None
    }
    if options["n"] is not None:
        given["start.self_propulsion"] = False
    return given


def _as_text(found: dict[str, Any], path: Path) -> str:
    values = found["values"]
    own = [kind for key, kind in _OWN if values.get(key)]
    sea = values["sea.name"] + (f" with {', '.join(own)} of its own" if own else "")
    lines = [f"{found['ship']} as FMU of FMI {found['fmi']}.0 for co-simulation, sea {sea}"]
    lines += [f"wrote {file}" for file in found["files"]]
    lines.append(f"next: python -m fmpy info {path}; docs/cosimulation.md sails a zig-zag with it")
    return "\n".join(lines)
