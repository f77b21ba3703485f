"""Where sockets listen: on this machine alone, unless an address says otherwise."""

from __future__ import annotations

import ipaddress
import socket
from typing import Any

from ship_gym.config import ConfigError

LOOPBACK = "127.0.0.1"
_TRIES = 20  # of a free port for both kinds


def ip_of(address: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address:
    """A literal IP address; names of hosts are not asked for."""
    try:
        return ipaddress.ip_address(address)
    except ValueError:
        raise ConfigError(
            f"listen = {address[:60]!r}: must be an IP address such as 127.0.0.1"
        ) from None


def bound_pair(ip: Any, port: int, kinds: tuple[str, ...]) -> tuple[Any, Any, int]:
    """Sockets of TCP and UDP, None where a kind is not wanted, on one port."""
    tries = _TRIES if port == 0 and len(kinds) == 2 else 1
    for k in range(tries):
        tcp = udp = None
        try:
            if "tcp" in kinds:
                tcp = _listening(ip, port, socket.SOCK_STREAM)
            at = tcp.getsockname()[1] if tcp is not None else port
            if "udp" in kinds:
                udp = _listening(ip, at, socket.SOCK_DGRAM)
                at = udp.getsockname()[1]
        except OSError as error:
            if tcp is not None:
                tcp.close()
            if k == tries - 1:
                what = error.strerror or str(error)
                raise ConfigError(f"cannot listen on {ip} port {port}: {what}") from error
        else:
            return tcp, udp, at
    raise AssertionError  # pragma: no cover


def _listening(ip: Any, port: int, kind: socket.SocketKind) -> socket.socket:
    held = socket.socket(socket.AF_INET if ip.version == 4 else socket.AF_INET6, kind)
    try:
        if kind == socket.SOCK_STREAM:
            held.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        held.bind((str(ip), port))
        if kind == socket.SOCK_STREAM:
            held.listen()
    except OSError:
        held.close()
        raise
    return held
