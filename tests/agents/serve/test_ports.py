"""Sockets: where they are bound, who is a client, what becomes of one that misbehaves."""

import socket
import time

import pytest

pytest.importorskip("pynmea2")

from ship_gym_agents.serve import ports as module
from ship_gym_agents.serve.ports import Peer, Ports

from ship_gym.config import ConfigError

WAIT = 20.0  # [s]


def heard(ports, count=1):
    """Lines that came, at least so many."""
    found, end = [], time.monotonic() + WAIT
    while len(found) < count and time.monotonic() < end:
        found += [line.data for line in ports.receive(0.1)]
    return found


def joined(ports):
    """A client that the ports know of."""
    wire = socket.create_connection((ports.address, ports.port), WAIT)
    while not ports.newcomers():
        ports.receive(0.1)
    return wire


def test_bound_to_this_machine_unless_told_otherwise():
    with Ports(port=0) as ports:
        assert [kind for kind, *_ in ports.bound] == ["tcp", "udp"]
        assert all(address == "127.0.0.1" for _, address, _ in ports.bound)
        assert {port for *_, port in ports.bound} == {ports.port}
    with Ports("0.0.0.0", 0, ("udp",)) as ports:
        assert ports.bound == [("udp", "0.0.0.0", ports.port)]


def test_a_port_in_use_is_one_line():
    with Ports(port=0) as ports, pytest.raises(ConfigError) as error:
        Ports(port=ports.port)
    assert str(error.value).startswith(f"cannot listen on 127.0.0.1 port {ports.port}: ")


@pytest.mark.parametrize("address", ["localhost", "", "127.0.0.1:80", "999.1.1.1"])
def test_an_address_is_literal(address):
    with pytest.raises(ConfigError, match="must be an IP address"):
        Ports(address, 0)


def test_an_address_of_another_machine():
    with pytest.raises(ConfigError, match=r"cannot listen on 192\.0\.2\.1 port 0: "):
        Ports("192.0.2.1", 0)  # of RFC 5737, nobody's


def test_lines_however_they_are_cut_and_ended():
    with Ports(port=0) as ports, joined(ports) as wire:
        wire.sendall(b"$A")
        assert ports.receive(0.2) == []
        wire.sendall(b"B\r\n$C\n\n$D\r")
        assert heard(ports, 3) == [b"$AB", b"$C", b"$D"]


def test_a_line_without_end_is_handed_over_in_pieces():
    with Ports(port=0) as ports, joined(ports) as wire:
        wire.sendall(b"x" * 3000)
        assert len(b"".join(heard(ports))) > module._UNENDED


def test_a_datagram_makes_no_client_before_it_is_welcome():
    with Ports(port=0) as ports, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        wire.settimeout(WAIT)
        wire.sendto(b"$A\r\n$B\r\n", (ports.address, ports.port))
        lines = []
        while len(lines) < 2:
            lines += ports.receive(WAIT)
        assert [line.data for line in lines] == [b"$A", b"$B"] and not ports.newcomers()
        ports.send(["nobody\r\n"])
        ports.welcome(lines[0].peer)
        ports.welcome(lines[0].peer)
        assert ports.newcomers() == [lines[0].peer]
        ports.send(["a\r\n", "b\r\n"])
        assert [wire.recv(100), wire.recv(100)] == [b"a\r\n", b"b\r\n"]


def test_only_so_many_clients(monkeypatch):
    monkeypatch.setattr(module, "MOST", 2)
    with Ports(port=0) as ports:
        wires = [joined(ports) for _ in range(2)]
        refused = socket.create_connection((ports.address, ports.port), WAIT)
        while not ports.refused["too many"]:
            ports.receive(0.1)
        assert refused.recv(10) == b""
        for k in range(3):
            ports.welcome(Peer("udp", ("127.0.0.1", 40000 + k)))
        assert [*ports._known] == [("127.0.0.1", 40001), ("127.0.0.1", 40002)]
        for wire in (*wires, refused):
            wire.close()


def test_a_client_that_does_not_read_is_left(monkeypatch):
    monkeypatch.setattr(module, "_WAITING", 1 << 16)
    with Ports(port=0) as ports, joined(ports):
        for _ in range(3000):
            ports.send(["x" * 80 + "\r\n"] * 100)
            if ports.refused["too slow"]:
                break
        assert ports.refused["too slow"] == 1
        ports.send(["to nobody\r\n"])


def test_a_client_that_hangs_up_is_forgotten():
    with Ports(port=0) as ports:
        joined(ports).close()
        end = time.monotonic() + WAIT
        while ports.has_clients and time.monotonic() < end:
            ports.receive(0.05)
        assert not ports.has_clients


def test_a_listener_that_never_spoke_gets_datagrams():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        wire.settimeout(WAIT)
        wire.bind(("127.0.0.1", 0))
        with Ports(port=0, to=(wire.getsockname(),)) as ports:
            ports.send(["$A\r\n"])
            assert wire.recv(100) == b"$A\r\n"


def test_wake_ends_a_wait():
    with Ports(port=0) as ports:
        ports.wake()
        begun = time.monotonic()
        assert ports.receive(WAIT) == [] and time.monotonic() - begun < WAIT / 2
