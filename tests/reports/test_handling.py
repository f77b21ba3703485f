"""Report of the manoeuvres with engine and of course stability, and their pictures."""

import json
import math

import pytest

from ship_gym.config import ConfigError
from ship_gym.plotting.handling import plot_handling
from ship_gym.reports import handling
from ship_gym.reports.handling import KINDS, sail_handling
from ship_gym.ships import load_ship


@pytest.fixture(scope="module", params=list(KINDS))
def case(request):
    return sail_handling(load_ship("kvlcc2"), request.param)


def test_text_and_data_say_the_same(case):
    data, text = handling.as_dict(case), handling.as_text(case, ["a.png"], "kvlcc2")
    json.dumps(data, allow_nan=False)
    quantities = KINDS[case.manoeuvre].quantities
    assert set(data["measures"]) == set(quantities) == set(data["units"])
    assert all(label in text for label, *_ in quantities.values())
    assert text.startswith("kvlcc2: ") and "wrote a.png" in text and "next: ship-gym" in text
    assert ("imo" in data) == ("MSC.137" in text) == (case.manoeuvre == "stopping")


def test_picture(case, tmp_path):
    plot_handling(case, tmp_path / "p.png")
    data = (tmp_path / "p.png").read_bytes()
    assert data[:4] == b"\x89PNG" and len(data) > 10_000


def test_units_of_display():
    case = sail_handling(load_ship("kcs_model"), "spiral", delta_deg=-10.0)
    data = handling.as_dict(case)
    assert data["delta_deg"] == pytest.approx(-10.0)
    assert data["curve"]["delta_deg"][0] == pytest.approx(10.0)
    assert data["measures"]["loop_width"] == pytest.approx(math.degrees(case.result.loop_width))


def test_in_a_sea_nothing_is_said_of_stability():
    case = sail_handling(load_ship("kcs"), "pull_out", sea="current")
    assert "unstable" not in handling.as_text(case, [], "kcs")


@pytest.mark.parametrize(
    ("what", "options", "word"),
    [
        ("stoping", {}, "stopping"),
        ("coasting", {"order": -3.0}, "order"),
        ("stopping", {"delta_deg": 50.0}, "delta = 50"),
        ("stopping", {"speed": -1.0}, "speed"),
        ("spiral", {"sea": "stormy"}, "stormy"),
    ],
)
def test_bad_input(kcs_model, what, options, word):
    with pytest.raises(ConfigError, match=word):
        sail_handling(kcs_model, what, **options)
