"""A 20/20 zig-zag of a ship's FMU, sailed by FMPy, and the same by `ShipSim`: bit for bit."""

from __future__ import annotations

import argparse
import json
import math
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

from ship_gym import ShipSim
from ship_gym.cosim import write_fmu
from ship_gym.sea import load_sea

# names of the unit in the order of ship_gym.conventions.STATE_NAMES
STATES = (
    *("body_velocity.surge", "body_velocity.sway", "body_velocity.yaw"),
    *("ned_position.north", "ned_position.east", "ned_position.yaw"),
    *("rudder.angle", "propeller.speed"),
)
YAW = STATES.index("ned_position.yaw")
LIMIT = math.radians(20.0)  # of rudder and of heading
INTERVAL = 0.5  # communication step [s]


def zigzag(
    states: Callable[[], Sequence[float]], sail: Callable[[float, float], None], duration: float
) -> np.ndarray:
    """States at the end of every step, (T, 8); the rudder goes to starboard first."""
    side, found = 1.0, []
    for k in range(round(duration / INTERVAL)):
        if side * states()[YAW] >= LIMIT:
            side = -side
        sail(k * INTERVAL, side * LIMIT)
        found.append(list(states()))
    return np.array(found)


def by_fmpy(path: Path, sea: str, seed: int, duration: float) -> np.ndarray:
    """The FMU in FMPy: what any master does, in the order in which FMI asks for it."""
    description = fmpy.read_model_description(str(path))
    reference = {v.name: v.valueReference for v in description.modelVariables}
    with tempfile.TemporaryDirectory() as folder:
        fmpy.extract(str(path), unzipdir=folder)
        ship = FMU2Slave(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="ship",
        )
        ship.instantiate(loggingOn=True)
        ship.setString([reference["sea.name"]], [sea])  # parameters: before initialisation
        ship.setInteger([reference["seed"]], [seed])
        ship.setupExperiment(startTime=0.0)
        ship.enterInitializationMode()
        ship.exitInitializationMode()
        state = [reference[name] for name in STATES]

        def sail(t: float, rudder: float) -> None:
            ship.setReal([reference["rudder.command"]], [rudder])
            ship.doStep(t, INTERVAL)

        found = zigzag(lambda: ship.getReal(state), sail, duration)
        ship.terminate()
        ship.freeInstance()
    return found


def by_simulation(name: str, sea: str, seed: int, duration: float) -> np.ndarray:
    """The same ship in `ShipSim`."""
    sim = ShipSim(name)
    sim = ShipSim(name, sea=load_sea(sea).scaled(sim.ships[0].scale))
    sim.reset(seed)
    n = float(sim.state[0, STATES.index("propeller.speed")])
    return zigzag(
        lambda: sim.state[0], lambda t, rudder: sim.step([[rudder, n]], INTERVAL), duration
    )


def overshoots(yaw: np.ndarray) -> list[float]:
    """How far the heading goes beyond each reversal [deg]."""
    found, side = [], 1.0
    start = 0
    for k in range(1, len(yaw)):
        if side * yaw[k] < -LIMIT:  # the next reversal: the extreme lies before it
            found.append(math.degrees(np.abs(yaw[start:k] * (side * yaw[start:k] > 0)).max()))
            side, start = -side, k
    return [x - math.degrees(LIMIT) for x in found]


def main() -> None:
    """Write the FMU, sail it twice and compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ship", default="kcs", help="name or ship file (kcs)")
    parser.add_argument("--sea", default="ss5", help="named sea (ss5)")
    parser.add_argument("--seed", type=int, default=7, help="of the waves (7)")
    parser.add_argument("--duration", type=float, default=600.0, help="[s] (600)")
    parser.add_argument("--out", type=Path, default=Path("runs/zigzag.fmu"), help="FMU to write")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    args = parser.parse_args()
    path, groups = write_fmu(args.ship, args.out)
    given = args.sea, args.seed, args.duration
    sailed, expected = by_fmpy(path, *given), by_simulation(args.ship, *given)
    result = {
        "fmu": str(path),
        "groups": str(groups),
        "steps": len(sailed),
        "same_bits": bool(np.array_equal(sailed, expected)),
        "overshoots_deg": overshoots(sailed[:, YAW]),
    }
    if args.json:
        print(json.dumps(result, indent=2))
        return
    angles = ", ".join(f"{x:.1f}" for x in result["overshoots_deg"])
    print(f"wrote {path} and {groups}")
    print(f"{args.ship} in {args.sea}: {len(sailed)} steps by FMPy, overshoots {angles} deg")
    print(f"states of ShipSim bit for bit: {'yes' if result['same_bits'] else 'NO'}")


if __name__ == "__main__":
    main()
