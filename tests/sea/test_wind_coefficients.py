import dataclasses
import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.csv_file import read_csv
from ship_gym.sea.wind_coefficients import (
    _DATA,
    WindAreas,
    blendermann,
    isherwood,
    ship_types,
    wind_table,
)
from ship_gym.ships.loader import load_ship

BEAM = 32.2
KCS = WindAreas(
    L_oa=243.8, A_F=1050.0, A_L=6400.0, s_L=-1.0, s_H=13.5, A_SS=4400.0, perimeter=330.0, masts=1.0
)
CONTAINER = "container ship loaded"
GAMMA = np.radians(np.arange(-180.0, 181.0, 1.0))
MODELS = {
    "blendermann": lambda gamma: blendermann(gamma, KCS, CONTAINER),
    "isherwood": lambda gamma: isherwood(gamma, KCS, BEAM),
}


@pytest.mark.parametrize("ship_type", sorted(ship_types()))
def test_blendermann_gives_back_its_table(ship_type):
    p = ship_types()[ship_type]
    CX, CY, CN = blendermann(np.radians([0.0, 90.0, 180.0, -90.0]), KCS, ship_type).T
    assert CX[0] == pytest.approx(-p["CDl_AF_bow"])  # head wind holds back
    assert CX[2] == pytest.approx(p["CDl_AF_stern"])  # following wind pushes
    assert CY[1] == pytest.approx(-p["CDt"])  # from starboard: to port
    assert CY[3] == pytest.approx(p["CDt"])
    np.testing.assert_allclose(CX[[1, 3]], 0.0, atol=1e-12)
    np.testing.assert_allclose(CY[[0, 2]], 0.0, atol=1e-12)
    assert CN[1] == pytest.approx(KCS.s_L / KCS.L_oa * CY[1])  # beam wind: at the centroid


def test_printed_parameters():
    # the rows that the shipped ships use, as in the reference
    names = ("CDt", "CDl_AF_bow", "CDl_AF_stern", "delta", "kappa")
    types = ship_types()
    for name, row in {
        "container ship loaded": (0.90, 0.55, 0.55, 0.40, 1.4),
        "tanker loaded": (0.70, 0.90, 0.55, 0.40, 3.1),
        "destroyer": (0.85, 0.60, 0.65, 0.65, 1.1),
    }.items():
        assert tuple(types[name][n] for n in names) == row
    assert len(types) == 17


def test_blendermann_formula_at_45_deg():
    # sin^2(2 gamma) = 1; CDl/CDt = 0.55 * 1050 / 6400 / 0.9
    damping = 1.0 - 0.2 * (1.0 - 0.55 * 1050.0 / 6400.0 / 0.9)
    CX, CY, CN = blendermann(math.radians(45.0), KCS, CONTAINER)
    assert CX == pytest.approx(-0.55 * math.sqrt(0.5) / damping)
    assert CY == pytest.approx(-0.90 * math.sqrt(0.5) / damping)
    assert CN == pytest.approx((-1.0 / 243.8 + 0.18 * math.pi / 4.0) * CY)


def test_largest_side_force_is_near_the_beam():
    CY = -MODELS["blendermann"](np.radians(np.arange(181.0)))[:, 1]
    assert 60 <= CY.argmax() <= 120
    assert 0.90 <= CY.max() < 0.93


@pytest.mark.parametrize("name", ["CX", "CY", "CN"])
@pytest.mark.parametrize("row", range(19))
def test_isherwood_gives_back_each_row(name, row):
    """Each row times the ship's ratios, by hand; and no coefficient is in the wrong column."""
    table = read_csv(_DATA / f"isherwood_{name}.csv")
    angle, *b = (table.columns[column][row] for column in table.columns)
    ratios = {
        0: 1.0,
        1: 2.0 * 6400.0 / 243.8**2,
        2: 2.0 * 1050.0 / 32.2**2,
        3: 243.8 / 32.2,
        4: 330.0 / 243.8,
        5: (0.5 * 243.8 + 1.0) / 243.8,
        6: 1.0 if name == "CX" else 4400.0 / 6400.0,
    }
    expected = -sum(value * ratios[i] for i, value in enumerate(b))  # wind from starboard
    found = isherwood(math.radians(angle), KCS, BEAM)[("CX", "CY", "CN").index(name)]
    if angle == 180.0 and name != "CX":
        assert found == pytest.approx(0.0, abs=1e-12)
    else:
        assert found == pytest.approx(expected, abs=1e-12)


def test_isherwood_s_printed_rows():
    # spot values of the published tables
    rows = {
        "CX": (0, [2.152, -5.00, 0.243, -0.164, 0, 0, 0]),
        "CY": (90, [0.889, 0, 0.138, 0, 0, -0.66, 0]),
        "CN": (130, [-0.0189, 0, -0.0488, 0.0101, 0.1128, -0.420]),
    }
    for name, (angle, row) in rows.items():
        table = read_csv(_DATA / f"isherwood_{name}.csv").where(gamma_w=angle)
        assert [float(table.columns[c][0]) for c in list(table.columns)[1:]] == row


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_mirror_symmetry(model):
    ours, mirrored = model(GAMMA), model(-GAMMA)
    np.testing.assert_allclose(ours[:, 0], mirrored[:, 0], atol=1e-12)
    np.testing.assert_allclose(ours[:, 1:], -mirrored[:, 1:], atol=1e-12)


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_signs(model):
    starboard = model(np.radians(np.arange(10.0, 171.0, 10.0)))
    assert (starboard[:, 1] < 0.0).all()  # wind from starboard pushes to port
    bow, quarter = model(np.radians(30.0)), model(np.radians(150.0))
    assert bow[0] < 0.0 < quarter[0]
    assert bow[2] < 0.0 < quarter[2]  # bow to port, bow to starboard: to lie beam-on


def test_two_sources_agree_on_a_container_ship():
    """Independent sources: largest side force within 10 %, head resistance within a factor 2."""
    one, other = MODELS["blendermann"](GAMMA), MODELS["isherwood"](GAMMA)
    assert other[:, 1].max() == pytest.approx(one[:, 1].max(), rel=0.10)
    assert 0.5 < other[180, 0] / one[180, 0] < 1.0
    assert np.abs(one[:, 2] - other[:, 2]).max() < 0.06


@pytest.mark.parametrize("method", ["blendermann", "isherwood"])
def test_table(method):
    table = wind_table(KCS, CONTAINER, BEAM, method)
    assert table.values.shape == (181, 3) and table.names == ("CX", "CY", "CN")
    assert table.axes[0].stop == pytest.approx(2.0 * np.pi)
    np.testing.assert_allclose(table.values[0], table.values[-1], atol=1e-9)
    gamma = np.linspace(0.0, 2.0 * np.pi, 1000)
    np.testing.assert_allclose(table(gamma), MODELS[method](gamma), atol=2e-3)
    assert max(table.card["interpolation_error"].values()) < 2e-3


def test_bad_input():
    with pytest.raises(ConfigError, match="did you mean 'container ship loaded'"):
        blendermann(0.0, KCS, "container ship")
    with pytest.raises(ConfigError, match="did you mean 'isherwood'"):
        wind_table(KCS, CONTAINER, BEAM, "isherwod")
    ship = load_ship("kcs")
    for name, value in (("A_L", -1.0), ("s_L", 200.0)):  # areas are checked with their ship
        areas = dataclasses.replace(ship.wind, **{name: value})
        with pytest.raises(ConfigError, match=rf"wind\.{name} = {value:g}"):
            load_ship(dataclasses.replace(ship, wind=areas))
    with pytest.raises(ConfigError, match=r"wind\.perimeter = 0"):
        isherwood(0.0, dataclasses.replace(KCS, perimeter=0.0), BEAM)
