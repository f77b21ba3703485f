"""Sentences of NMEA 0183, made and read by pynmea2; and the two orders that it does not know."""

from __future__ import annotations

from collections.abc import Sequence

try:
    import pynmea2
except ImportError as error:
    raise ImportError('sentences need pynmea2: pip install "ship-gym[nmea]"') from error

LONGEST = 82  # characters of a sentence from $ to the line feed, NMEA 0183


class Dropped(Exception):
    """A sentence that is not understood, or asks for what cannot be.

    Attributes
    ----------
    why : str
        One of `REASONS`.
    """

    def __init__(self, why: str, what: str):
        super().__init__(what)
        self.why = why


REASONS = ("no sentence", "too long", "checksum", "fields", "range", "not served", "too many")


class HTC(pynmea2.TalkerSentence):
    """Heading or track control command. Thirteen fields, with the fifth edition's status fourteen.

    Fields as Furuno prints them for VR-3000 and RD-50, after IEC 61162-1.
    """

    fields = (
        ("Override: A in use, V not in use", "override"),
        ("Commanded rudder angle [deg]", "rudder_angle"),
        ("Commanded rudder direction: L port, R starboard", "rudder_direction"),
        ("Selected steering mode: M, S, H, T, R", "mode"),
        ("Turn mode: R radius, T turn rate, N not controlled", "turn_mode"),
        ("Commanded rudder limit [deg]", "rudder_limit"),
        ("Commanded off-heading limit [deg]", "off_heading_limit"),
        ("Commanded radius of turn [nautical miles]", "radius"),
        ("Commanded rate of turn [deg/min]", "rate"),
        ("Commanded heading to steer [deg]", "heading"),
        ("Commanded off-track limit [nautical miles]", "off_track_limit"),
        ("Commanded track [deg]", "track"),
        ("Heading reference: T true, M magnetic", "reference"),
        ("Status: C command, R report", "status"),
    )


class ROR(pynmea2.TalkerSentence):
    """Rudder order status, fields as Navis prints them for NavDP 4000, after IEC 61162-1."""

    fields = (
        ("Starboard or single rudder order [deg], - turns to port", "starboard"),
        ("Status: A valid, V not", "starboard_status"),
        ("Port rudder order [deg]", "port"),
        ("Status: A valid, V not", "port_status"),
        ("Command source location", "source"),
    )


def known_kinds() -> list[str]:
    """Names of the sentences that can be made and read."""
    return sorted(pynmea2.TalkerSentence.sentence_types)


def made(talker: str, kind: str, fields: Sequence[str]) -> str:
    """A sentence with its checksum and line end.

    Parameters
    ----------
    talker : str
        Two letters, such as ``HE``.
    kind : str
        Three letters, such as ``HDT``.
    fields : sequence of str
    """
    sentence = pynmea2.TalkerSentence.sentence_types[kind](talker, kind, fields)
    return sentence.render(newline=True)


def read(line: bytes) -> pynmea2.NMEASentence | str:
    """The sentence of a line, or, of a kind that is not known, the three letters of the kind.

    Raises
    ------
    Dropped
        It is none: not ASCII, no ``$``, too long, no or a wrong checksum.
    """
    if len(line) > LONGEST - 2:
        raise Dropped("too long", f"{len(line)} characters, allowed are {LONGEST - 2}")
    try:
        text = line.decode("ascii")
    except UnicodeDecodeError:
        raise Dropped("no sentence", "not ASCII") from None
    if not text.startswith("$") or not text.isprintable():
        raise Dropped("no sentence", "must begin with $ and be printable")
    try:
        return pynmea2.NMEASentence.parse(text, check=True)
    except pynmea2.ChecksumError as error:
        raise Dropped("checksum", str(error.args[0][0])) from None
    except pynmea2.SentenceTypeError:
        return text[3:6]
    except Exception as error:  # proprietary ones have readers of their own, which raise anything
        raise Dropped("no sentence", f"pynmea2: {type(error).__name__}") from None
