"""What sentences order. Examples with a checksum are as their sources print them."""

import math

import pytest

pynmea2 = pytest.importorskip("pynmea2")

from ship_gym_agents.serve.nmea import REASONS, Dropped, made, read  # noqa: E402
from ship_gym_agents.serve.orders import HEADING, RUDDER, order_of  # noqa: E402


def with_checksum(text):
    return f"${text}*{pynmea2.NMEASentence.checksum(text):02X}".encode()


def ordered(line):
    return order_of(read(line if isinstance(line, bytes) else with_checksum(line)))


# Navis NavDP 4000 (RCROR, RCHDT, RCRSA), go-nmea (FTHSC), Java Marine API (AGHTC)
PRINTED = [
    b"$RCROR,-22.0,A,34.0,A,B*1A",
    b"$RCHDT,335.2,T*34",
    b"$RCRSA,-22.0,A,34.0,A*7B",
    b"$FTHSC,40.12,T,39.11,M*5E",
    b"$AGHTC,V,0.1,R,M,,15.0,15.0,,,90.3,,,T*53",
]


@pytest.mark.parametrize("line", PRINTED)
def test_printed_examples_are_read_and_made_again(line):
    sentence = read(line)
    kind = sentence.sentence_type
    assert made(sentence.talker, kind, sentence.data).encode() == line + b"\r\n"


@pytest.mark.parametrize(
    ("line", "what", "degrees", "limit"),
    [
        (PRINTED[3], HEADING, 40.12, math.inf),
        (PRINTED[4], RUDDER, 0.1, math.inf),
        ("AGHSC,92.5,T,,M,C", HEADING, 92.5, math.inf),
        ("AGHSC,0,T,,", HEADING, 0.0, math.inf),
        ("AGHSC,360.0,T,,M", HEADING, 360.0, math.inf),
        ("AGHTC,V,,,H,N,,,,,92.5,,,T,C", HEADING, 92.5, math.inf),
        ("AGHTC,V,,,S,R,10.5,,0.5,,92.5,,,T", HEADING, 92.5, 10.5),
        ("AGHTC,V,12.0,L,R,N,,,,,,,,T", RUDDER, -12.0, math.inf),
        ("AGHTC,V,12.0,R,R,N,,,,,,,,T", RUDDER, 12.0, math.inf),
        ("AGHTC,A,5,L,H,N,,,,,92.5,,,T", RUDDER, -5.0, math.inf),  # override goes before the mode
        ("AGHTC,V,0,,R,N,,,,,,,,", RUDDER, 0.0, math.inf),
        ("RCROR,-22.0,A,,V,B", RUDDER, -22.0, math.inf),
        ("RCROR,7.25,A,7.25,A,B", RUDDER, 7.25, math.inf),
    ],
)
def test_orders(line, what, degrees, limit):
    order = ordered(line)
    assert order.what == what
    assert math.degrees(order.angle) == pytest.approx(degrees, abs=1e-12)
    assert math.degrees(order.limit) == pytest.approx(limit)


def test_a_plotter_is_obeyed_where_it_is_wanted():
    def apb(heading, flags="A,A", reference="T"):
        text = f"ECAPB,{flags},0.1,L,N,V,V,10,T,W1,11,T,{heading},{reference}"
        return order_of(read(with_checksum(text)), apb=True)

    assert apb("12.5") == (HEADING, math.radians(12.5), math.inf)
    for bad, why in ((("", "A,A"), "fields"), (("1", "V,A"), "fields"), (("1", "A,V"), "fields")):
        with pytest.raises(Dropped) as error:
            apb(*bad)
        assert error.value.why == why
    with pytest.raises(Dropped, match="magnetic"):
        apb("12.5", reference="M")


@pytest.mark.parametrize(
    "line",
    [
        "GPHDT,12.0,T",
        "GPGGA,,,,,,,,,,,,,,",
        "ECAPB,A,A,0.1,L,N,V,V,10,T,W1,11,T,12,T",
        "AGHTC,V,,,H,N,,,,,92.5,,,T,R",  # a report, no command
        "AGHSC,92.5,T,,M,R",
        "AGHTD,V,0.1,R,M,,15.0,15.0,,,,,,T,A,A,A,90.3",  # unknown to pynmea2
        "PGRME,15.0,M,45.0,M,25.0,M",
        "CCGPQ,GGA",
    ],
)
def test_sentences_that_order_nothing(line):
    assert ordered(line) is None


@pytest.mark.parametrize(
    ("line", "why", "words"),
    [
        (b"$AGHSC,92.5,T,,M*00", "checksum", "00"),
        (b"$AGHSC,92.5,T,,M", "checksum", "missing"),
        (b"AGHSC,92.5,T,,M", "no sentence", "$"),
        (b"$\xffGHSC,92.5,T,,M", "no sentence", "ASCII"),
        (b"", "no sentence", "$"),
        (b"$", "no sentence", "pynmea2"),
        (b"$,,,*00", "no sentence", "pynmea2"),
        (b"!AIVDM,1,1,,A,13,0*00", "no sentence", "$"),
        (b"$AGHSC," + b"9" * 90, "too long", "97 characters"),
        ("AGHSC,92.5,T,,M,X", "fields", "status = 'X'"),
        ("AGHSC,92.5,T", "fields", "2 fields, allowed are 4 or 5"),
        ("AGHSC,,T,,M", "fields", "HSC.heading_true = ''"),
        ("AGHSC,nan,T,,M", "fields", "'nan': must be a number"),
        ("AGHSC,1e2,T,,M", "fields", "'1e2'"),
        ("AGHSC,1_0,T,,M", "fields", "'1_0'"),
        ("AGHSC,0x10,T,,M", "fields", "'0x10'"),
        ("AGHSC,12.5,M,,M", "fields", "HSC.true = 'M'"),
        ("AGHSC,360.1,T,,M", "range", "allowed is 0 to 360"),
        ("AGHSC,-1,T,,M", "range", "allowed is 0 to 360"),
        ("AGHSC,,T,92.5,M", "not served", "magnetic"),
        ("AGHTC,V,,,H,N,,,,,,,,T", "fields", "HTC.heading = ''"),
        ("AGHTC,V,,,H,N,,,,,92.5,,,M", "not served", "M"),
        ("AGHTC,V,,,H,N,,,,,92.5,,,", "fields", "HTC.reference = ''"),
        ("AGHTC,V,,,T,N,,,,,,,92.5,T", "not served", "mode T"),
        ("AGHTC,V,,,X,N,,,,,92.5,,,T", "fields", "HTC.mode = 'X'"),
        ("AGHTC,,,,H,N,,,,,92.5,,,T", "fields", "HTC.override = ''"),
        ("AGHTC,V,5,,R,N,,,,,,,,T", "fields", "HTC.rudder_direction = ''"),
        ("AGHTC,V,-5,L,R,N,,,,,,,,T", "range", "HTC.rudder_angle = '-5'"),
        ("AGHTC,V,,,R,N,,,,,,,,T", "fields", "HTC.rudder_angle = ''"),
        ("AGHTC,V,,,H,N,99,,,,92.5,,,T", "range", "HTC.rudder_limit"),
        ("AGHTC,V,,,H,N,,,,,92.5,,,T,C,A", "fields", "15 fields, allowed are 13 or 14"),
        (PRINTED[0], "not served", "two rudder angles"),
        ("RCROR,-22.0,V,,V,B", "fields", "starboard_status"),
        ("RCROR,91,A,,V,B", "range", "-90 to 90"),
        ("RCROR,5", "fields", "1 fields, allowed are 5"),
    ],
)
def test_sentences_that_are_dropped(line, why, words):
    with pytest.raises(Dropped) as error:
        ordered(line)
    assert error.value.why == why and why in REASONS
    assert words in str(error.value) and len(str(error.value)) <= 120


def test_no_line_ever_raises_anything_else():
    import random

    draw = random.Random(1)
    good = [*PRINTED, with_checksum("AGHTC,V,,,H,N,,,,,92.5,,,T,C"), with_checksum("AGHSC,1,T,,M")]
    found = set()
    for _ in range(3000):
        line = bytearray(draw.choice(good))
        for _ in range(draw.randint(1, 3)):
            line[draw.randrange(len(line))] = draw.choice(b",*$AT0159.-\xff\x00 MHRLV")
        if draw.random() < 0.7:
            line = bytearray(with_checksum(line[1:-3].decode("latin-1")).replace(b"$$", b"$"))
        try:
            ordered(bytes(line))
        except Dropped as error:
            found.add(error.why)
    assert {"fields", "checksum", "no sentence"} <= found
