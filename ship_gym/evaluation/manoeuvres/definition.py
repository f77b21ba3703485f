"""What a suite says of a manoeuvre: kind, rudder, heading, sides and seas."""

from __future__ import annotations

import dataclasses

from ship_gym.config import ConfigError, check_fields, check_known
from ship_gym.reports.case import MANOEUVRES
from ship_gym.reports.handling import KINDS as HANDLING

KINDS = (*MANOEUVRES, *HANDLING)
CALM = "calm"
_BOTH = ("starboard", "port")
SIDES = {"turning": _BOTH, "zigzag": _BOTH}  # of the others one, to both sides or to none


@dataclasses.dataclass(frozen=True)
class Manoeuvre:
    """One manoeuvre of a suite.

    Attributes
    ----------
    kind : str
        ``turning``, ``zigzag`` (both sailed to either side), ``pull_out``, ``spiral``,
        ``stopping``, ``coasting`` or ``acceleration``.
    rudder_deg, heading_deg : float, optional
        Rudder angle, and heading of the reversals of a zig-zag; what is usual if omitted.
    seas : tuple of str
        Named seas; waves and wind come from ahead of the approach.
    """

    kind: str
    rudder_deg: float | None = None
    heading_deg: float | None = None
    seas: tuple[str, ...] = (CALM,)

    def __post_init__(self) -> None:
        check_known("kind of manoeuvre", self.kind, KINDS)
        ranges = {"rudder_deg": (0.1, 90.0, "deg"), "heading_deg": (0.1, 90.0, "deg")}
        check_fields(f"manoeuvre {self.kind}", self, ranges)
        object.__setattr__(self, "seas", tuple(self.seas))
        if self.heading_deg is not None and self.kind != "zigzag":
            raise ConfigError(f"manoeuvre {self.kind}: heading_deg: allowed for a zigzag only")
        if not self.seas:
            raise ConfigError(f"manoeuvre {self.kind}: seas: at least one is needed")

    @property
    def sides(self) -> tuple[str, ...]:
        """To which side it is sailed, one after the other; an empty name where there is none."""
        return SIDES.get(self.kind, ("",))

    @property
    def name(self) -> str:
        """In words, without the side, such as ``zig-zag 20/10``."""
        rudder = "" if self.rudder_deg is None else f" {self.rudder_deg:g}"
        if self.kind == "turning":
            return f"turning circle{rudder or ' 35'} deg"
        if self.kind == "zigzag":
            heading = self.heading_deg or self.rudder_deg or 10.0
            return f"zig-zag {self.rudder_deg or heading:g}/{heading:g}"
        return HANDLING[self.kind].title + (f"{rudder} deg" if rudder else "")
