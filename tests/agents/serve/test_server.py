"""A ship that is steered over the wire: by our own PID, by headings, by what is wrong."""

import math
import socket
import time

import numpy as np
import pytest

pynmea2 = pytest.importorskip("pynmea2")
pytest.importorskip("pyproj")

from ship_gym_agents.serve.nmea import made  # noqa: E402
from ship_gym_agents.serve.orders import HEADING, Order  # noqa: E402
from ship_gym_agents.serve.voyage import Voyage  # noqa: E402

from ship_gym.conventions import DELTA, PSI  # noqa: E402
from ship_gym.tracks import Track  # noqa: E402

from .conftest import PATIENCE, served, vessel  # noqa: E402

pytestmark = pytest.mark.compiled
DURATION = 240.0
RUDDER = ["A", "", "V", "B"]


def built_in(degrees, **given):
    """Headings [rad] of a ship whose own autopilot gets the order at the start."""
    ship = vessel(duration=DURATION, **given)
    ship.obey(Order(HEADING, math.radians(degrees)))
    found = []
    for _ in range(ship.steps):
        ship.sail()
        found.append(ship.batch.sim.state[0, PSI])
    return np.array(found)


def over_the_wire(nmea_pid, degrees, udp, **given):
    """The same by our PID on the other end, in lockstep: statistics, headings of the client."""
    ship = vessel(duration=DURATION, **given)
    path = []
    sail = ship.sail
    ship.sail = lambda: (sail(), path.append(ship.batch.sim.state[0].copy()))
    with served(ship, lockstep=True, patience=PATIENCE) as (server, ports, thread):
        pilot = nmea_pid.Pilot(degrees)
        wire = nmea_pid.Wire(ports.address, ports.port, udp, patience=PATIENCE)
        for line in wire.lines():
            if (order := pilot.hear(line)) is None:
                continue
            if len(pilot.errors) > ship.steps:
                break  # the instruments at the end
            wire.say(order)
        wire.close()
        thread.join(PATIENCE)
    return server.plain(), np.array(path), pilot


@pytest.mark.parametrize("scenario", ["heading_calm", "heading_ss5_bow"])
def test_our_pid_on_the_wire_steers_as_the_one_on_board(nmea_pid, scenario):
    stats, path, pilot = over_the_wire(nmea_pid, 20.0, udp=False, scenario=scenario)
    aboard = built_in(20.0, scenario=scenario)
    off = np.degrees(np.abs(path[:, PSI] - aboard))
    # a sentence says 0.01 deg, 0.01 deg/min, 0.001 kn: no more than that comes between them
    assert off.max() < 0.02  # 0.0012 when this was written
    assert max(map(abs, pilot.errors[-60:])) < (1.0 if scenario == "heading_calm" else 3.0)
    steps = int(DURATION)
    assert stats["orders"] == {"ROR": steps} and stats["dropped"] == {}
    assert stats["sent"]["HDT"] == steps + 1 and stats["ended"] == "end of time"
    assert stats["clients"] == {"tcp": 1} and stats["steered_by"] == "rudder"


def test_lockstep_is_the_same_every_time_by_tcp_and_udp(nmea_pid):
    runs = [over_the_wire(nmea_pid, -15.0, udp, seed=3)[1] for udp in (False, False, True)]
    assert len(runs[0]) == int(DURATION)
    assert all(np.array_equal(runs[0], other) for other in runs[1:])
    assert not np.array_equal(runs[0], over_the_wire(nmea_pid, -15.0, False, seed=4)[1])


def test_accelerated_time_with_a_client_that_keeps_up_as_it_can(nmea_pid):
    """Four seconds for forty: wide margins, since the machine may be busy."""
    ship = vessel(duration=40.0, interval=0.2)
    with served(ship, speed_up=10.0, rates={"VBW": 5.0}) as (server, ports, thread):
        pilot = nmea_pid.Pilot(10.0, interval=0.2)
        wire = nmea_pid.Wire(ports.address, ports.port, patience=2.0)
        orders = nmea_pid.steer(pilot, wire)
        wire.close()
        thread.join(PATIENCE)
    assert server.why == "end of time" and server.sailed == ship.steps == 200
    assert orders > 10
    assert 2.0 < math.degrees(ship.batch.sim.state[0, PSI]) < 18.0


def talk(ports, sentences, wait="HDT"):
    """Say sentences by TCP, hear an instant after each; what was heard last of a kind."""
    with socket.create_connection((ports.address, ports.port), PATIENCE) as wire:
        stream = wire.makefile("rb")
        heard = {}
        for sentence in [None, *sentences]:
            if sentence is not None:
                wire.sendall(sentence if isinstance(sentence, bytes) else sentence.encode())
            while True:
                found = pynmea2.parse(stream.readline().decode(), check=True)
                heard[found.sentence_type] = found
                if found.sentence_type == wait:
                    break
    return heard


def test_headings_are_kept_by_the_autopilot_on_board():
    ship = vessel(duration=200.0, heading=math.radians(350.0))
    first = made("AG", "HSC", ["355.00", "T", "", "M"])
    then = made("AG", "HTC", ["V", "", "", "H", "N", "10.0", "", "", "", "20.00", "", "", "T", "C"])
    limits = []
    sail = ship.sail
    ship.sail = lambda: (sail(), limits.append(ship.batch.sim.commands[0, 0]))
    with served(ship, lockstep=True, patience=PATIENCE) as (server, ports, _):
        heard = talk(ports, [first] * 20 + [then] * 180, wait="GGA")
    assert server.counts.orders == {"HSC": 20, "HTC": 180}
    assert float(heard["HDT"].heading) == pytest.approx(20.0, abs=1.0)
    assert math.degrees(max(map(abs, limits[20:]))) == pytest.approx(10.0, abs=0.01)
    assert server.plain()["steered_by"] == "heading"


def test_rudder_angles_are_obeyed_within_the_gear():
    ship = vessel(duration=60.0)
    with served(ship, lockstep=True, patience=PATIENCE) as (_, ports, _):
        orders = [made("AG", "ROR", ["-5.0", *RUDDER])] * 20
        assert float(talk(ports, orders, "RSA")["RSA"].rsa_starboard) == -5.0
        assert float(talk(ports, orders, "ROT")["ROT"].rate_of_turn) < -5.0  # to port
        hard = made("AG", "HTC", ["A", "60", "R", "M", "N", *[""] * 7, "T"])
        talk(ports, [hard] * 20, "RSA")
    assert ship.batch.sim.state[0, DELTA] == pytest.approx(ship.ship.gear.delta_max)


def test_what_is_wrong_is_dropped_and_told():
    ship = vessel(duration=10.0)
    good = made("AG", "ROR", ["1.0", *RUDDER])
    with served(ship, lockstep=True, patience=PATIENCE) as (server, ports, _):
        bad = b"$AGROR,5.0,A,,V,B*00\r\n"
        junk = b"\xff\x00hello\r\n" + b"x" * 5000 + b"\r\n"
        range_ = made("AG", "HSC", ["400", "T", "", "M"]).encode()
        other = made("II", "HDT", ["12.0", "T"]).encode()
        talk(ports, [bad + junk + range_ + other + good.encode(), good], "GGA")
    stats = server.plain()
    dropped = {why: found["count"] for why, found in stats["dropped"].items()}
    assert dropped["checksum"] == dropped["no sentence"] == dropped["range"] == 1
    assert dropped["too long"] >= 1
    assert "allowed is 0 to 360" in stats["dropped"]["range"]["what"]
    assert stats["dropped"]["checksum"]["latest"] == "$AGROR,5.0,A,,V,B*00"
    assert stats["ignored"] == {"HDT": 1} and stats["orders"] == {"ROR": 2}
    assert stats["intervals"] == 2 and stats["ended"] == "stopped"


def test_lockstep_waits_no_longer_than_its_patience():
    ship = vessel(duration=10.0)
    with served(ship, lockstep=True, patience=0.05) as (server, _, thread):
        thread.join(PATIENCE)
    assert (server.why, server.sailed) == ("no order came", 0)


def test_several_clients_hear_the_same_and_each_may_steer():
    ship = vessel(duration=10.0)
    order = made("AG", "ROR", ["2.0", *RUDDER]).encode()
    with served(ship, lockstep=True, patience=PATIENCE) as (server, ports, _):
        wires = [socket.create_connection((ports.address, ports.port), PATIENCE) for _ in range(2)]
        udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        udp.settimeout(PATIENCE)
        udp.sendto(made("II", "HDT", ["", "T"]).encode(), (ports.address, ports.port))
        streams = [wire.makefile("rb") for wire in wires]
        seen = [[stream.readline() for _ in range(6)] for stream in streams]
        seen.append([udp.recv(4096) for _ in range(6)])
        assert seen[0] == seen[1] == seen[2]
        for sender in (wires[0], wires[1], udp):
            where = (sender.sendto, (order, (ports.address, ports.port)))
            where = where if sender is udp else (sender.sendall, (order,))
            where[0](*where[1])
            seen = [[stream.readline() for _ in range(6)] for stream in streams]
            seen.append([udp.recv(4096) for _ in range(6)])
            assert seen[0] == seen[1] == seen[2]
        for each in (*streams, *wires, udp):
            each.close()
    assert server.sailed == 3 and server.plain()["clients"] == {"tcp": 2, "udp": 1}


def test_real_time_is_real():
    ship = vessel(duration=1.0, interval=0.1)
    begun = time.monotonic()
    with served(ship, speed_up=2.0) as (server, _, thread):
        thread.join(PATIENCE)
    assert server.sailed == 10 and time.monotonic() - begun >= 0.5


def test_off_track_is_as_the_ship_lies_to_the_leg():
    """She sails north 300 m to starboard of a leg to the north, then past its end."""
    from ship_gym.charts import Chart

    chart = Chart.laid([54.0, 54.02, 54.02], [8.0, 8.0, 8.1])
    track = Track(np.column_stack([chart.north, chart.east]), chart=chart)
    ship = vessel(duration=400.0, position=(0.0, 300.0))
    voyage = Voyage(track, ship.ship.hull.L)
    keep = made("AG", "HSC", ["0.0", "T", "", "M"])
    with served(ship, chart, lockstep=True, patience=PATIENCE, voyage=voyage) as (_, ports, _):
        heard = talk(ports, [keep], "APB")
        assert heard["XTE"].data == ["A", "A", f"{300.0 / 1852.0:.4f}", "L", "N"]
        pilot = heard["APB"]
        assert (pilot.dest_waypoint_id, pilot.bearing_to_dest) == ("W001", "000.00")
        expected = math.degrees(math.atan2(-300.0, chart.north[1]))
        assert float(pilot.bearing_pres_dest) == pytest.approx(360.0 + expected, abs=0.1)
        ahead = math.degrees(math.atan(-300.0 / (3.0 * ship.ship.hull.L)))
        assert float(pilot.heading_to_dest) == pytest.approx(360.0 + ahead, abs=0.1)
        place = heard["RMC"]
        here = [float(value) for value in chart.place(0.0, 300.0)]
        assert [place.latitude, place.longitude] == pytest.approx(here, abs=1e-4)
        heard = talk(ports, [keep] * 380, "APB")
        assert heard["APB"].dest_waypoint_id == "W002"
        assert float(heard["APB"].bearing_to_dest) == pytest.approx(90.0, abs=0.1)
        assert heard["XTE"].data[3] == "R"  # beyond the leg to the east: to port of it


def test_planned_turns_lead_to_the_way_points_of_the_route():
    """A ship that is moved along a route with an arc: names, bearings and sides all the way."""
    from ship_gym_agents.serve.instruments import Seen

    from ship_gym.charts.geodesy import rhumb
    from ship_gym.tracks import Route, Waypoint

    points = [(54.0, 8.0, "START"), (54.05, 8.0, "corner, *$!"), (54.05, 8.1, "")]
    radii = (None, 1500.0, None)
    route = Route("test", tuple(Waypoint(*p, radius=r) for p, r in zip(points, radii, strict=True)))
    track = route.track()
    voyage, found = Voyage(track, 200.0), []
    assert len(track.points) > 4  # an arc
    for north, east in np.concatenate([track.points, track.points[-1:] + [0.0, 50.0]]):
        now = Seen(
            *[0.0] * 7,
            north=north,
            east=east,
            course=0.0,
            speed=0.0,
            rudder=0.0,
            rudders=1,
            wind=None,
        )
        voyage.follow(now)
        found.append(voyage.at(now))
    assert list(dict.fromkeys(leg.name for leg in found)) == ["corner", "W002"]
    assert max(abs(leg.cross) for leg in found[:-1]) < 1e-6
    legs = rhumb([54.0, 54.05], [8.0, 8.0], [54.05, 54.05], [8.0, 8.1])
    assert [found[0].bearing, found[-1].bearing] == pytest.approx(list(legs.bearing), abs=1e-6)
    assert found[0].bearing_there == pytest.approx(float(legs.bearing[0]) % math.tau, abs=1e-9)
    assert [leg.passed for leg in (found[0], found[-1])] == [False, True]
    assert found[-1].arrived and not found[0].arrived
