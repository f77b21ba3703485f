"""Sockets: TCP and UDP on one address and port, many clients, one thread.

Whoever connects by TCP hears everything. Over UDP a client is one whose datagram held a valid
sentence; it hears everything from then on at the address it sent from. No one is asked who he is:
docs/autopilot_loop.md says what that means.
"""

from __future__ import annotations

import contextlib
import selectors
import socket
import time
from collections import deque
from typing import Any, NamedTuple

from ship_gym_agents.serve.binding import LOOPBACK, bound_pair, ip_of

MOST = 32  # clients of each kind
_WAITING = 1 << 20  # bytes that a slow reader may leave, then he is left
_UNENDED = 1024  # bytes of a line that does not end
_READ = 4096


class Peer(NamedTuple):
    """Who sent a line: ``tcp`` or ``udp``, and his address."""

    kind: str
    address: Any


class Line(NamedTuple):
    """A line without its end."""

    peer: Peer
    data: bytes


class _Client:
    """A TCP client."""

    def __init__(self, held: socket.socket, peer: Peer):
        held.setblocking(False)
        with contextlib.suppress(OSError):  # a sentence is small and must not wait for the next
            held.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.held, self.peer = held, peer
        self.heard, self.waiting = b"", b""


class Ports:
    """Bound sockets; a context manager that closes them.

    Parameters
    ----------
    address : str
        Literal IP address to listen on.
    port : int
        0: any free one.
    kinds : sequence of str
        ``tcp``, ``udp`` or both.
    to : sequence of (str, int)
        Addresses that get every sentence as datagrams unasked.

    Attributes
    ----------
    address, port
        As bound.
    refused : dict
        Clients that were not taken (``too many``) or left since they read too slowly.

    Raises
    ------
    ConfigError
        No such address here, or the port is in use.
    """

    def __init__(
        self,
        address: str = LOOPBACK,
        port: int = 10110,
        kinds: tuple[str, ...] = ("tcp", "udp"),
        to: tuple[tuple[str, int], ...] = (),
    ):
        self.address, self._to = address, [*to]
        self.refused = {"too many": 0, "too slow": 0}
        self._clients: dict[socket.socket, _Client] = {}
        self._known: dict[Any, None] = {}  # UDP clients, the one silent longest first
        self._new: list[Peer] = []
        self._lines: deque[Line] = deque()
        self._tcp, self._udp, self.port = bound_pair(ip_of(address), port, kinds)
        self._selector = selectors.DefaultSelector()
        self._wake, self._woken = socket.socketpair()
        for held in (self._tcp, self._udp, self._woken):
            if held is not None:
                held.setblocking(False)
                self._selector.register(held, selectors.EVENT_READ)

    @property
    def bound(self) -> list[tuple[str, str, int]]:
        """Kind, address and port of each listening socket, as the system has them."""
        pairs = (("tcp", self._tcp), ("udp", self._udp))
        return [(kind, *held.getsockname()[:2]) for kind, held in pairs if held is not None]

    @property
    def has_clients(self) -> bool:
        """Whether anyone listens who may send orders."""
        return bool(self._clients or self._known)

    def receive(self, timeout: float) -> list[Line]:
        """Lines that came until the first ones came, after at most `timeout` [s]."""
        end = time.monotonic() + timeout
        while not self._lines and not self._new:
            left = end - time.monotonic()
            ready = self._selector.select(max(left, 0.0))
            for key, events in ready:
                self._serve(key.fileobj, events)
                if key.fileobj is self._woken:
                    return self._taken()
            if left <= 0.0:
                break
        return self._taken()

    def _taken(self) -> list[Line]:
        found = [*self._lines]
        self._lines.clear()
        return found

    def newcomers(self) -> list[Peer]:
        """Clients that came since the last call."""
        found, self._new = self._new, []
        return found

    def welcome(self, peer: Peer) -> None:
        """Take who sent a valid sentence by UDP as a client, or as one that is there still."""
        if peer.kind != "udp":
            return
        if peer.address in self._known:
            del self._known[peer.address]
        elif peer.address not in self._to:
            self._new.append(peer)
            if len(self._known) >= MOST:
                del self._known[next(iter(self._known))]
                self.refused["too many"] += 1
        self._known[peer.address] = None

    def wake(self) -> None:
        """End a `receive` that waits; may be called by a handler of a signal."""
        with contextlib.suppress(OSError):
            self._wake.send(b"w")

    def send(self, sentences: list[str], to: Peer | None = None) -> None:
        """Send sentences to all clients, or to one: a stream by TCP, a datagram each by UDP."""
        data = [sentence.encode("ascii") for sentence in sentences]
        for client in [*self._clients.values()]:
            if to in (None, client.peer):
                client.waiting += b"".join(data)
                self._flush(client)
        if self._udp is not None:
            known = [*self._known, *(each for each in self._to if each not in self._known)]
            for address in known if to is None else [to.address] if to.kind == "udp" else []:
                for datagram in data:
                    with contextlib.suppress(OSError):  # full, or nobody is there: so is UDP
                        self._udp.sendto(datagram, address)

    def _serve(self, held: Any, events: int) -> None:
        if held is self._woken:
            with contextlib.suppress(OSError):
                held.recv(_READ)
        elif held is self._tcp:
            self._accept()
        elif held is self._udp:
            self._datagram()
        else:
            client = self._clients[held]
            if events & selectors.EVENT_WRITE:
                self._flush(client)
            if events & selectors.EVENT_READ and held in self._clients:
                self._read(client)

    def _accept(self) -> None:
        try:
            held, address = self._tcp.accept()
        except OSError:
            return
        if len(self._clients) >= MOST:
            self.refused["too many"] += 1
            held.close()
            return
        client = self._clients[held] = _Client(held, Peer("tcp", address))
        self._selector.register(held, selectors.EVENT_READ)
        self._new.append(client.peer)

    def _datagram(self) -> None:
        try:
            data, address = self._udp.recvfrom(_READ)
        except OSError:  # the answer of a client that is gone
            return
        peer = Peer("udp", address)
        self._lines.extend(Line(peer, line) for line in _split(data))

    def _read(self, client: _Client) -> None:
        try:
            data = client.held.recv(_READ)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            return self._leave(client)
        *lines, rest = (client.heard + data).replace(b"\r", b"\n").split(b"\n")
        if len(rest) > _UNENDED:
            lines, rest = [*lines, rest], b""
        client.heard = rest
        self._lines.extend(Line(client.peer, line) for line in lines if line.strip())
        return None

    def _flush(self, client: _Client) -> None:
        try:
            sent = client.held.send(client.waiting) if client.waiting else 0
        except BlockingIOError:
            sent = 0
        except OSError:
            return self._leave(client)
        client.waiting = client.waiting[sent:]
        if len(client.waiting) > _WAITING:
            self.refused["too slow"] += 1
            return self._leave(client)
        wanted = selectors.EVENT_READ | (selectors.EVENT_WRITE if client.waiting else 0)
        self._selector.modify(client.held, wanted)
        return None

    def _leave(self, client: _Client) -> None:
        self._selector.unregister(client.held)
        del self._clients[client.held]
        client.held.close()

    def close(self) -> None:
        """Close every socket; what a client has not read yet is sent if it goes at once."""
        for client in [*self._clients.values()]:
            self._leave(client)
        for held in (self._tcp, self._udp, self._wake, self._woken):
            if held is not None:
                held.close()
        self._selector.close()

    def __enter__(self) -> Ports:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _split(data: bytes) -> list[bytes]:
    return [line for line in data.replace(b"\r", b"\n").split(b"\n") if line.strip()]
