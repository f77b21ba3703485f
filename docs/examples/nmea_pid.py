"""An autopilot on the other end of the wire: the PID of Ship Gym steers a ship over NMEA 0183.

It knows of the ship only what her instruments say (HDT, ROT, RSA, VBW) and answers with rudder
angles (ROR), as an autopilot on a bridge does. The ship is one of ``ship-gym serve``:

    ship-gym serve --lockstep --duration 300
    python docs/examples/nmea_pid.py --heading 20

Put your own law into `Pilot.rudder`. docs/autopilot_loop.md has the fields of every sentence.
"""

from __future__ import annotations

import argparse
import json
import math
import socket
from collections.abc import Iterator

import numpy as np
import pynmea2
from ship_gym_agents import make_controller
from ship_gym_agents.serve.nmea import made  # ROR is not among the sentences of pynmea2

from ship_gym import load_ship
from ship_gym.conventions import KNOT
from ship_gym.scenarios import load_scenario
from ship_gym.tasks.columns import observation_columns

LAST = "VBW"  # of the sentences of an instant, this one comes last of those that are needed


class Pilot:
    """Hears the instruments, orders rudder angles.

    Parameters
    ----------
    heading : float
        To keep [deg].
    ship, controller : str
        Whose tuned gains and which autopilot.
    interval : float
        Between two orders [s].
    """

    def __init__(self, heading: float, ship="kcs", controller="pid", interval=1.0):
        self.heading, self.ship = math.radians(heading), load_ship(ship)
        changes = {"ship": ship, "control_interval": interval, "duration": 600 * interval}
        scenario = load_scenario("heading_keeping", changes)
        self._controller = make_controller(controller)
        self._controller.reset(1, self.ship, scenario)
        self._columns = observation_columns(scenario)
        self._heard: dict[str, pynmea2.TalkerSentence] = {}
        self.errors: list[float] = []  # of the heading [deg]

    def hear(self, line: str) -> str | None:
        """Take a sentence; answer the last one of an instant with an order."""
        sentence = pynmea2.parse(line, check=True)
        self._heard[sentence.sentence_type] = sentence
        if sentence.sentence_type != LAST or not {"HDT", "ROT", "RSA"} <= self._heard.keys():
            return None
        angle = math.degrees(self.rudder())
        return made("AG", "ROR", [f"{angle:.2f}", "A", "", "V", "B"])

    def rudder(self) -> float:
        """Rudder angle [rad], positive turns to starboard, from what was heard."""
        heading = math.radians(float(self._heard["HDT"].heading))
        rate = math.radians(float(self._heard["ROT"].rate_of_turn)) / 60.0
        sway = float(self._heard["VBW"].trans_water_spd) * KNOT
        delta = math.radians(float(self._heard["RSA"].rsa_starboard))
        error = math.remainder(heading - self.heading, 2.0 * math.pi)
        self.errors.append(math.degrees(error))
        seen = {
            "sin_error": math.sin(error),
            "cos_error": math.cos(error),
            "yaw_rate": rate * self.ship.hull.L / self.ship.speed,
            "sway": sway / self.ship.speed,
            "rudder": delta / self.ship.gear.delta_max,
        }
        observation = np.zeros((1, len(self._columns)))
        for name, value in seen.items():
            observation[0, self._columns[name]] = value
        action = self._controller.act(observation)
        return float(action[0, 0]) * self.ship.gear.delta_max


class Wire:
    """A line to the ship, by TCP or UDP; `lines` ends when nothing comes for `patience` s."""

    def __init__(self, address: str, port: int, udp: bool = False, patience: float = 10.0):
        kind = socket.SOCK_DGRAM if udp else socket.SOCK_STREAM
        self._socket = socket.socket(socket.AF_INET, kind)
        self._socket.settimeout(patience)
        self._socket.connect((address, port))
        self._rest = b""
        if udp:  # over UDP a ship knows who hears her only when she was spoken to
            self.say(made("AG", "HDT", ["", "T"]))

    def say(self, sentence: str) -> bool:
        """Send one; False where nobody is there any more."""
        try:
            self._socket.send(sentence.encode("ascii"))
        except OSError:
            return False
        return True

    def lines(self) -> Iterator[str]:
        """What comes in."""
        while True:
            try:
                data = self._socket.recv(4096)
            except OSError:  # nothing came, or nobody is there any more
                return
            if not data:
                return
            *lines, self._rest = (self._rest + data).split(b"\r\n")
            yield from (line.decode("ascii") for line in lines)

    def close(self) -> None:
        """Hang up."""
        self._socket.close()


def steer(pilot: Pilot, wire: Wire, orders: float = math.inf) -> int:
    """Answer the ship until she is silent, or so many times; how many orders were given."""
    given = 0
    for line in wire.lines():
        if (order := pilot.hear(line)) is not None and wire.say(order):
            given += 1
        if given >= orders:
            break
    return given


def main() -> None:
    """Steer, then say how well."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--address", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=10110)
    parser.add_argument("--udp", action="store_true", help="default: TCP")
    parser.add_argument("--heading", type=float, default=20.0, help="to keep [deg]")
    parser.add_argument("--ship", default="kcs")
    parser.add_argument("--controller", default="pid")
    parser.add_argument("--interval", type=float, default=1.0, help="of the ship's orders [s]")
    parser.add_argument("--orders", type=float, default=math.inf, help="then hang up")
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    pilot = Pilot(given.heading, given.ship, given.controller, given.interval)
    try:
        wire = Wire(given.address, given.port, given.udp)
    except OSError as error:
        parser.exit(2, f"error: {given.address} port {given.port}: {error.strerror}\n")
    orders = steer(pilot, wire, given.orders)
    wire.close()
    last = pilot.errors[-60:] or [math.nan]
    found = {
        "orders": orders,
        "heading_error_deg": round(max(map(abs, last)), 3) if orders else None,
    }
    told = (
        f"{orders} orders; largest heading error of the last 60: {found['heading_error_deg']} deg"
    )
    print(json.dumps(found) if given.json else told)


if __name__ == "__main__":
    main()
