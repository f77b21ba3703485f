"""What a sentence orders: a rudder angle or a heading; every field that counts is checked."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any, NamedTuple

from ship_gym_agents.serve.nmea import Dropped

RUDDER, HEADING = "rudder", "heading"
_NUMBER = re.compile(r"[+-]?(\d{1,9}(\.\d{0,9})?|\.\d{1,9})")  # no exponent, no nan
_MOST_RUDDER = 90.0  # [deg]; the gear limits what is between its own largest angle and this


class Order(NamedTuple):
    """One order.

    Attributes
    ----------
    what : str
        `RUDDER` or `HEADING`.
    angle : float
        Rudder angle, positive turns to starboard, or true heading [rad].
    limit : float
        Largest rudder angle that the autopilot may use [rad]; infinite: the gear's.
    """

    what: str
    angle: float
    limit: float = math.inf


def order_of(sentence: Any, apb: bool = False) -> Order | None:
    """The order of a sentence; None: of a kind that orders nothing, or the report of a setting.

    Parameters
    ----------
    sentence : pynmea2.NMEASentence or str
        As ``nmea.read`` gives it.
    apb : bool
        Whether the heading to steer of APB is an order.

    Raises
    ------
    Dropped
        A field that is missing, none, or outside its range; what is not served.
    """
    kind = getattr(sentence, "sentence_type", "")
    reader = None if kind == "APB" and not apb else READERS.get(kind)
    return None if reader is None else reader(sentence)


def _of_htc(sentence: Any) -> Order | None:
    """``HTC``: rudder control (R, M, or with override) or heading control (H, S)."""
    _check_count(sentence, 13, 14)
    if _is_report(sentence):
        return None
    override = _one_of(sentence, "override", "A", "V")
    if override == "A":  # direct control of the steering gear: the mode is to be ignored
        return Order(RUDDER, _sided(sentence))
    mode = _one_of(sentence, "mode", *"MSHTR")
    if mode in "MR":
        return Order(RUDDER, _sided(sentence))
    if mode == "T":
        raise Dropped("not served", "HTC mode T: the ship keeps no track; modes are R, M, H and S")
    if _one_of(sentence, "reference", "T", "M") == "M":
        raise Dropped("not served", "HTC reference M: headings are true, there is no variation")
    limit = math.inf
    if sentence.rudder_limit:
        limit = math.radians(_number(sentence, "rudder_limit", 0.0, _MOST_RUDDER))
    return Order(HEADING, math.radians(_number(sentence, "heading", 0.0, 360.0)), limit)


def _of_hsc(sentence: Any) -> Order | None:
    """``HSC``: heading control by the true heading."""
    _check_count(sentence, 4, 5)
    if len(sentence.data) == 5 and sentence.data[4] not in ("C", ""):
        _refuse_status(sentence, sentence.data[4])
        return None
    if sentence.data[0] == "" and sentence.data[2] != "":
        raise Dropped("not served", "HSC in magnetic degrees: headings are true, no variation")
    _one_of(sentence, "true", "T")
    _one_of(sentence, "magnetic", "M", "")
    return Order(HEADING, math.radians(_number(sentence, "heading_true", 0.0, 360.0)))


def _of_ror(sentence: Any) -> Order:
    """``ROR``: rudder angle; two rudders move together."""
    _check_count(sentence, 5, 5)
    statuses = [_one_of(sentence, f"{side}_status", "A", "V", "") for side in ("starboard", "port")]
    if statuses[0] != "A":
        raise Dropped("fields", f"ROR.starboard_status = {statuses[0]!r}: the order is not valid")
    angle = _number(sentence, "starboard", -_MOST_RUDDER, _MOST_RUDDER)
    if statuses[1] == "A" and _number(sentence, "port", -_MOST_RUDDER, _MOST_RUDDER) != angle:
        raise Dropped("not served", "ROR of two rudder angles: the rudders move together")
    return Order(RUDDER, math.radians(angle))


def _of_apb(sentence: Any) -> Order:
    """``APB``: the heading to steer of a plotter that follows a route."""
    _check_count(sentence, 14, 15)
    _one_of(sentence, "status_gen", "A")
    _one_of(sentence, "status_cycle_lock", "A")
    if _one_of(sentence, "heading_to_dest_type", "T", "M") == "M":
        raise Dropped("not served", "APB in magnetic degrees: headings are true, no variation")
    return Order(HEADING, math.radians(_number(sentence, "heading_to_dest", 0.0, 360.0)))


READERS: dict[str, Callable[[Any], Order | None]] = {
    "HTC": _of_htc,
    "HSC": _of_hsc,
    "ROR": _of_ror,
    "APB": _of_apb,
}


def _check_count(sentence: Any, low: int, high: int) -> None:
    count = len(sentence.data)
    if not low <= count <= high:
        allowed = f"{low}" if low == high else f"{low} or {high}"
        raise Dropped("fields", f"{_kind(sentence)} has {count} fields, allowed are {allowed}")


def _is_report(sentence: Any) -> bool:
    """Whether the status says that a setting is reported and none commanded."""
    if len(sentence.data) < 14 or sentence.status in ("C", ""):
        return False
    _refuse_status(sentence, sentence.status)
    return True


def _refuse_status(sentence: Any, status: str) -> None:
    if status != "R":
        raise Dropped("fields", f"{_kind(sentence)} status = {status!r}: allowed is C or R")


def _sided(sentence: Any) -> float:
    """Rudder angle [rad] of an unsigned angle with its side."""
    angle = math.radians(_number(sentence, "rudder_angle", 0.0, _MOST_RUDDER))
    if angle == 0.0:
        return 0.0
    return angle if _one_of(sentence, "rudder_direction", "L", "R") == "R" else -angle


def _one_of(sentence: Any, name: str, *allowed: str) -> str:
    text = str(getattr(sentence, name))
    if text not in allowed:
        told = ", ".join(each or "nothing" for each in allowed)
        raise Dropped("fields", f"{_kind(sentence)}.{name} = {text[:20]!r}: allowed is {told}")
    return text


def _number(sentence: Any, name: str, low: float, high: float) -> float:
    text = sentence.data[sentence.name_to_idx[name]]  # as it came, not as pynmea2 makes of it
    told = f"{_kind(sentence)}.{name} = {text[:20]!r}"
    if not _NUMBER.fullmatch(text):
        raise Dropped("fields", f"{told}: must be a number")
    if not low <= float(text) <= high:
        raise Dropped("range", f"{told}: allowed is {low:g} to {high:g} [deg]")
    return float(text)


def _kind(sentence: Any) -> str:
    return sentence.sentence_type
