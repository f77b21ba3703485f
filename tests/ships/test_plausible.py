"""Ships that cannot exist are refused; every number has a range that spans the published ships."""

from __future__ import annotations

import dataclasses
import math
import re
import shutil
import warnings

import numpy as np
import pytest

import ship_gym
from ship_gym.config import LONGEST, MOST_FINDINGS, ConfigError, ImplausibleShip
from ship_gym.recording.about import ship_meta
from ship_gym.reports.manoeuvre import estimates
from ship_gym.ships import available_ships, available_variants, load_ship, scaled
from ship_gym.ships.files import DATA
from ship_gym.ships.loader import available_surrogates
from ship_gym.ships.plausible import basis, checked, findings_of, values_of
from ship_gym.ships.ranges import RANGES, Range

MODEL = DATA / "kvlcc2_model" / "ship.toml"

# text of the model's file -> text in its place, what the finding says
REFUSED = [
    (
        "rho = { value = 999.103",
        "rho = { value = 1.025",
        "rho = 1.025 kg/m3: allowed is 985 to 1035",
    ),
    ("rho = { value = 999.103", "rho = { value = 0.999", "rho = 0.999"),
    ("rho = { value = 999.103", "rho = { value = 1e6", "rho = 1e+06"),
    ("nu = { value = 1.1386e-6", "nu = { value = -1.1386e-6", "nu = -1.1386e-06 m2/s"),
    ("m_x = 0.022", "m_x = -0.5", "hull.m_x = -0.5"),
    ("R_0 = { value = 0.", "R_0 = { value = -0.", "hull.R_0 = -0."),
    ("x_R = { value = -0.5", "x_R = { value = 0.5", "rudder.x_R = 3.5 m = 0.5 L: allowed is -0.65"),
    ("x_H = { value = -0.464", "x_H = { value = 0.464", "rudder.x_H = 3.248 m = 0.464 L"),
    ("x_P = { value = -0.48", "x_P = { value = -48", "propeller.x_P = -336 m = -48 L"),
    ("a_H = 0.312", "a_H = 90", "rudder.a_H = 90: allowed is -0.1 to 1"),
    ("epsilon = 1.09", "epsilon = -1", "rudder.epsilon = -1"),
    ("eta = { value = 0.626", "eta = { value = 626", "rudder.eta = 626"),
    ("w_P0 = 0.40", "w_P0 = 40", "propeller.w_P0 = 40"),
    ("x_G = { value = 0.25", "x_G = { value = 25", "hull.x_G = 25 m = 3.571 L"),
    ("D = { value = 0.216", "D = { value = 9.86", "propeller.D = 9.86 m = 21.43 d: allowed is 0.2"),
    ("A_R = { value = 0.0539", "A_R = { value = 112.5", "rudder.A_R = 112.5 m2 = 34.94 L d"),
    ("J_range = [0.0, 0.8]", "J_range = [0.8, 0.0]", "open_water.J_range = [0.8, 0.0]"),
    ("J_range = [0.0, 0.8]", "J_range = [1, 0]", "low < high"),
    (
        "K_T = [0.2931, -0.2753, -0.1385]",
        "K_T = [0.2931, -0.1]",
        "open_water.mean slope of K_T = -0.1",
    ),
    ("speed = { value = 1.179", "speed = { value = 0", "speed = 0 m/s"),
    ("full_length = { value = 320.0", "full_length = { value = -320.0", "full_length = -320 m"),
    ("full_length = { value = 320.0", "full_length = { value = 0", "full_length = 0 m"),
    ("S = { value = 13.073", "S = { value = 6.5365", "hull.S = 6.5365 m2"),  # of one side
    (
        "delta_max = { value = 35.0",
        "delta_max = { value = 0.61",
        "gear.delta_max = 0.0106465 rad =",
    ),
    ("time_constant = { value = ", "time_constant = { value = -", "engine.time_constant = -"),
    ('title = "', 'title = ["a"] #', "title = ['a']: must be a text"),
    ('unit = "m3"', "unit = {}", "hull.volume.unit = {}: must be a text"),
    ("m_y = 0.223", f"m_y = 1{'0' * 400}", "hull.m_y = an integer of"),
    ("m_y = 0.223", "m_y = 1e-300", "hull.m_y = 1e-300: allowed is 0, or"),
    ("m_y = 0.223", "m_y = nan", "hull.m_y = nan"),
    ("m_y = 0.223", f"m_y = {'[' * 300}{']' * 300}", "hull.m_y = [["),
    ("[gear]", "[other]", "unknown key 'other'"),
    ("[hull]", "surrogate = 3\n[hull]", "surrogate = 3: must be a table of keys"),
    (
        'manoeuvre = "turning_circle"',
        'manoeuvre = "circle"',
        "unknown manoeuvre of a trial 'circle'",
    ),
]


@pytest.fixture
def own(tmp_path):
    """A user's copy of the model's file, given changes of its text."""

    def made(*changes):
        text = MODEL.read_text()
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new, 1)
        path = tmp_path / "mine.toml"
        path.write_text(text)
        return str(path)

    return made


@pytest.mark.parametrize(("old", "new", "words"), REFUSED)
def test_an_impossible_number_is_refused(own, old, new, words):
    with pytest.raises(ConfigError) as error:
        load_ship(own((old, new)))
    lines = str(error.value).splitlines()
    assert any(words in line for line in lines), lines
    assert all("mine.toml: " in line and len(line) <= LONGEST for line in lines)


@pytest.mark.parametrize(
    ("table", "value", "words"),
    [
        ("hull", "7", "hull = 7: must be a table of keys"),
        ("propeller", "[]", "propeller = []: must be a table of keys"),
        ("open_water", "nan", "open_water = nan: must be a table of keys"),
        ("trial", "[nan]", "trial[0] = nan: must be a table of keys"),
        ("trial", "3", "trial = 3: must be a list of tables, [[trial]]"),
        ("trial", '[{ measures = "a" }]', "trial[0].measures = 'a': must be"),
        ("propulsion", '[{ source = "a", speed = 1e9 }]', "propulsion[0].speed = 1e+09 m/s"),
    ],
)
def test_a_section_of_the_wrong_type_is_one_line(tmp_path, table, value, words):
    kept, skip = [], False
    for line in MODEL.read_text().splitlines():
        if line.startswith("["):
            skip = line.strip("[]").split(".")[0] == table
        kept += [] if skip else [line]
    path = tmp_path / "mine.toml"
    path.write_text("\n".join([f"{table} = {value}", *kept]))
    with pytest.raises(ConfigError) as error:
        load_ship(str(path))
    assert words in str(error.value)


def test_all_findings_are_told_at_once(own):
    path = own(
        ("m_y = 0.223\n", ""),
        ("t_P = 0.220", "t_p = 0.220"),
        ('title = "', 'colour = "'),
        ('volume = { value = 3.27, unit = "m3"', 'volume = { value = 3.27, unit = "kg"'),
        ("a_H = 0.312", "a_H = 90"),
        ("R_0 = { value = 0.", "R_0 = { value = -0."),
        ("J_range = [0.0, 0.8]", "J_range = [1, 0]"),
        ("delta_deg = 35.0", "delta_deg = 350.0"),
    )
    with pytest.raises(ConfigError) as error:
        load_ship(path)
    text = str(error.value)
    for words in (
        "missing key hull.'m_y'",
        "unknown key propeller.'t_p'; did you mean 't_P'",
        "missing key propeller.'t_P'",
        "unknown key 'colour'",
        "missing key 'title'",
        "hull.volume: unit 'kg' given",
        "rudder.a_H = 90",
        "hull.R_0 = -0.01588: allowed is 0.002 to 0.08",
        "open_water.J_range = [1.0, 0.0]",
        "trial.delta_deg = 350.0",
    ):
        assert words in text
    assert len(text.splitlines()) == 10


def test_what_estimates_need_is_missing_where_it_is(tmp_path):
    path = tmp_path / "mine.toml"
    text = (DATA / "onrt_model" / "ship.toml").read_text().replace('default = "G2_SA"', "")
    path.write_text(re.sub(r"\n(B|N_r) = .*", "", text))
    with pytest.raises(ConfigError) as error:
        load_ship(path)
    assert [line.split("mine.toml: ")[1] for line in str(error.value).splitlines()] == [
        "missing key hull.'B'; hull.estimate = true fills up added masses, derivatives, S, k_zz "
        "and C_D only"
    ]


def test_limits_without_an_end_are_in_words():
    ship = dataclasses.replace(changed("propeller", t_P=1.2), strict=False)
    with pytest.raises(ConfigError, match=r"propeller.t_P = 1.2: allowed is 0.99 or less$"):
        load_ship(ship)


def test_one_slip_is_one_finding(own):
    """Numbers by a number that is wrong are not wrong with it."""
    for change in (
        ("rho = { value = 999.103", "rho = { value = 0.999"),
        ("L = { value = 7.00", "L = { value = 700.0"),
    ):
        with pytest.raises(ConfigError) as error:
            load_ship(own(change))
        first, *rest = str(error.value).splitlines()
        assert change[1].split(" =")[0] in first and "strict = false" in rest[-1] and len(rest) == 1


def test_a_ship_that_is_not_strict_warns_of_ranges_alone(own):
    free = ('title = "', 'strict = false\ntitle = "')
    with pytest.warns(ImplausibleShip, match=r"not strict:\n  hull.x_G = 1 m = 0.1429 L: allowed"):
        ship = load_ship(own(free, ("x_G = { value = 0.25", "x_G = { value = 1.0")))
    assert not ship.strict and len(ship.implausible) == 1
    for text in (ship.describe(), estimates(ship), *ship_meta(ship)["implausible"]):
        assert "hull.x_G = 1 m" in text
    for change in (("R_0 = { value = 0.", "R_0 = { value = -0."), ("m_x = 0.022", "m_x = -0.5")):
        with pytest.raises(ConfigError, match=change[1].split()[0]):
            load_ship(own(free, change))
    with pytest.raises(ConfigError, match="strict = 0: allowed is true or false"):
        load_ship(own(("title", "strict = 0\ntitle")))


def test_findings_of_a_file_full_of_nonsense_are_not_endless(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("".join(f"key_{k} = {k}\n" for k in range(1000)))
    with pytest.raises(ConfigError, match="more is wrong, see to these first") as error:
        load_ship(path)
    assert len(str(error.value).splitlines()) == MOST_FINDINGS + 1


def test_what_is_not_strict_stays_so_when_scaled(own, tmp_path):
    own(('title = "', 'strict = false\ntitle = "'), ("a_H = 0.312", "a_H = 1.5"))
    other = tmp_path / "large.toml"
    text = 'scaled_from = "mine.toml"\nlength = { value = 320.0, unit = "m" }\n'
    other.write_text(text)
    with pytest.warns(ImplausibleShip, match=r"large.toml is not strict:\n  rudder.a_H") as told:
        ship = load_ship(str(other))
    assert len(told) == 1 and ship.implausible == ("rudder.a_H = 1.5: allowed is -0.1 to 1",)
    with warnings.catch_warnings():  # of a ship at hand nothing is said twice
        warnings.simplefilter("error")
        assert load_ship(ship) is ship
        assert scaled(ship, 100.0).implausible == ship.implausible
    other.write_text(text + "strict = true\n")
    with pytest.raises(ConfigError, match=r"large.toml: rudder.a_H = 1.5"):
        load_ship(str(other))
    with pytest.raises(ConfigError, match=r"a_H = -1"):
        load_ship(own(("a_H = 0.312", "a_H = -1")))


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("[rudder]\nD = 1", "unknown key rudder.'D'"),
        ("[hull]\nx_G = { value = 25.0, unit = 'L' }", "hull.x_G = 5750 m = 25 L"),
        ("rudder = 7", "rudder = 7: must be a table"),
        ("wake_correction = 3", "wake_correction = 3: allowed is true or false"),
        ("title = 3", "title = 3: must be a text"),
    ],
)
def test_a_scaled_file_is_checked_too(tmp_path, lines, words):
    path = tmp_path / "mine.toml"
    path.write_text(f'scaled_from = "kcs_model"\nlength = {{ value = 230.0, unit = "m" }}\n{lines}')
    with pytest.raises(ConfigError) as error:
        load_ship(str(path))
    assert f"{path}: {words}" in str(error.value)


@pytest.mark.parametrize("length", ["-5.0", "1e9", "nan", "'a'", "{}"])
def test_a_length_to_scale_to(tmp_path, length):
    path = tmp_path / "mine.toml"
    path.write_text(f'scaled_from = "kcs"\nlength = {{ value = {length}, unit = "m" }}')
    with pytest.raises(ConfigError, match=r"mine.toml: length"):
        load_ship(str(path))


def test_files_that_scale_each_other_end(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('scaled_from = "mine.toml"')
    for read in (load_ship, available_variants, available_surrogates):
        with pytest.raises(ConfigError, match=r"in a circle: mine.toml -> mine.toml"):
            read(str(path))
    for k in range(12):
        text = f'scaled_from = "{k + 1}.toml"\nlength = {{ value = 5.0, unit = "m" }}'
        (tmp_path / f"{k}.toml").write_text(text)
    with pytest.raises(ConfigError, match="more than 8 files in a row"):
        load_ship(str(tmp_path / "0.toml"))


def test_points_of_an_open_water_curve_are_checked(tmp_path):
    shutil.copytree(DATA / "kcs_model", tmp_path / "mine")
    points, ship = tmp_path / "mine" / "kp505_open_water.csv", tmp_path / "mine" / "ship.toml"
    printed = points.read_text()
    for old, new, words in (
        ("0.10,", "10.0,", "J = 10.0: allowed is -3 to 3"),
        ("0.10,", "1e300,", "J = 1e+300: allowed is "),
    ):
        assert old in printed
        points.write_text(printed.replace(old, new))
        with pytest.raises(ConfigError) as error:
            load_ship(str(ship))
        assert words in str(error.value) and "kp505_open_water.csv:" in str(error.value)


def changed(section, **values):
    """The 7 m KVLCC2 with other numbers in a section; in none: her own."""
    ship = load_ship("kvlcc2_model")
    part = dataclasses.replace(getattr(ship, section), **values) if section else None
    return dataclasses.replace(ship, **({section: part} if section else values))


@pytest.mark.parametrize(
    ("ship", "words"),
    [
        (lambda: changed("", full_length=-320.0), "full_length = -320 m"),
        (lambda: changed("", full_length=0.0), "full_length = 0 m"),
        (lambda: changed("", share=0.0), "speed = 0"),
        (lambda: changed("", speed=math.nan), "speed = nan"),
        (lambda: changed("hull", R_0=-0.022), "hull.R_0 = -0.022"),
        (lambda: changed("hull", m_y=math.inf), "hull.m_y = inf"),
        (lambda: changed("engine", time_constant=-5.0), "engine.time_constant = -5 s"),
    ],
)
def test_a_ship_that_was_made_in_python_is_checked_at_the_door(ship, words):
    for door in (load_ship, ship_gym.ShipSim, lambda s: scaled(s, 5.0)):
        with pytest.raises(ConfigError, match=f"kvlcc2_model: {words}"):
            door(ship())


def test_a_share_of_the_speed_is_no_reason_to_doubt():
    ship = load_ship("kcs_model").at_share(0.1)
    assert checked(ship) is ship


@pytest.fixture(scope="module")
def spans():
    """(section, name) of every range to the range and the numbers of the package's ships."""
    found: dict[tuple[str, str], tuple[Range, list[float]]] = {}
    for name in available_ships():
        sets = [{}, {"surrogate": "none"}, *({"variant": v} for v in available_variants(name))]
        for given in sets:
            ship = load_ship(name, **given)
            for prefix, values, table, speed in values_of(ship):
                for key, allowed in table.items():
                    if (value := values.get(key)) is not None:
                        place = (prefix.split("[")[0].rstrip("."), key)
                        ratio = value / basis(ship, allowed.by, speed)
                        found.setdefault(place, (allowed, []))[1].append(ratio)
    return found


def test_ranges_state_what_the_published_ships_span_and_leave_room(spans):
    for place, (allowed, values) in spans.items():
        span = tuple(float(f"{end:.3g}") for end in (min(values), max(values)))
        assert span == allowed.published, place
        assert allowed.low <= span[0] and span[1] <= allowed.high, place
        assert allowed.must[0] <= allowed.low and allowed.high <= allowed.must[1], place


def test_every_number_of_a_ship_has_a_range():
    ship = load_ship("kcs")
    for name, table in RANGES.items():
        assert set(table) == {field.name for field in dataclasses.fields(getattr(ship, name))}


def unnoticed(factor):
    """Numbers of the 7 m KVLCC2 that may be multiplied by `factor`, each alone."""
    ship, found = load_ship("kvlcc2_model"), set()
    for name, table in RANGES.items():
        for key in table:
            part = getattr(ship, name)
            changed = dataclasses.replace(part, **{key: factor * getattr(part, key)})
            if changed != part and not any(
                findings_of(dataclasses.replace(ship, **{name: changed}))
            ):
                found.add(f"{name}.{key}")
    return found


def test_slips_of_a_unit_and_of_a_sign_are_noticed():
    assert unnoticed(1e3) == set()
    sized = {"hull": ("L", "B", "d", "volume", "k_zz", "S"), "rudder": ("A_R", "l_R", "x_R", "x_H")}
    sized |= {"propeller": ("D", "x_P"), "gear": ("delta_max", "rate"), "form": ("k_xx", "k_yy")}
    sized |= {"engine": ("n_max", "rate", "torque_max"), "wind": ("L_oa", "A_F", "A_L", "s_H")}
    sized = {f"{name}.{key}" for name, keys in sized.items() for key in keys}
    assert not sized & unnoticed(1e-3)
    damping = {"hull.Y_v", "hull.N_v", "hull.N_r", "hull.X_vv", "hull.N_vvr", "hull.Y_vrr"}
    rudder = {f"rudder.{key}" for key in RANGES["rudder"]} - {"rudder.neutral"}
    assert not (sized | damping | rudder) & unnoticed(-1.0)


@pytest.mark.parametrize(("factor", "words"), [(10.0, "= 0.05"), (0.1, "= 5."), (-1.0, "= inf")])
def test_a_torque_of_another_power_of_ten_is_noticed(factor, words):
    """Tables of open-water tests print 10 K_Q; the efficiency shows it."""
    ship = load_ship("kvlcc2_model")
    card = {**ship.open_water.card, "K_Q": factor * np.asarray(ship.open_water.card["K_Q"])}
    table = dataclasses.replace(ship.open_water, card=card)
    found = findings_of(dataclasses.replace(ship, open_water=table))
    lines = [
        line for line in [*found.impossible, *found.implausible] if "largest efficiency" in line
    ]
    assert len(lines) == 1 and words in lines[0], lines
    assert bool(found.impossible) == (factor < 1.0)


def test_all_that_is_missing_of_a_section_is_one_line(tmp_path):
    text = MODEL.read_text()
    gone = {"hull": ("Y_v", "N_r", "m_x"), "propeller": ("w_P0", "t_P"), "engine": ("rate",)}
    for key in sum(gone.values(), ()):
        text = re.sub(rf"(?m)^{key} = .*$", "", text, count=1 if key != "rate" else 0)
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(ConfigError) as error:
        load_ship(str(path))
    assert [line.partition("mine.toml: ")[2] for line in str(error.value).splitlines()] == [
        "missing keys of [hull]: Y_v, N_r, m_x; hull.estimate = true fills all of them up",
        "missing keys of [propeller]: t_P, w_P0",
        "missing key gear.'rate'",
        "missing key engine.'rate'",
    ]
    path.write_text("")
    with pytest.raises(ConfigError) as error:
        load_ship(str(path))
    (line,) = str(error.value).splitlines()
    assert "missing keys 'title', 'status'" in line and len(line) <= LONGEST


def test_of_a_wrong_length_only_the_length_is_told(own):
    """What is judged by it, the form too, is passed over."""
    path = own(("L = { value = 7.0", "L = { value = 7000"))
    with pytest.raises(ConfigError) as error:
        load_ship(path)
    keys = {
        line.partition("mine.toml: ")[2].split(" = ")[0] for line in str(error.value).splitlines()
    }
    assert keys == {"hull.L", "full_length / hull.L", "if these numbers are meant: strict"}


def test_a_hull_variant_is_named_with_its_file(tmp_path):
    shutil.copytree(DATA / "kcs_model", tmp_path / "mine")
    variant = tmp_path / "mine" / "hull_a.toml"
    variant.write_text(variant.read_text().replace("Y_vrr = -0.8341", "Y_vrr = 0.8341"))
    path = str(tmp_path / "mine" / "ship.toml")
    with pytest.raises(ConfigError, match=r"ship.toml with hull_a.toml: hull.Y_vrr = 0.8341: all"):
        load_ship(path, variant="hull_a")
    assert load_ship(path, surrogate="none").strict


@pytest.mark.parametrize("value", ["230", None, 1j, [230.0], np.array(230.0)])
def test_a_ship_made_in_python_has_numbers(value):
    ship = load_ship("kcs")
    bad = dataclasses.replace(ship, hull=dataclasses.replace(ship.hull, L=value), rudder=None)
    with pytest.raises(ConfigError) as refused:
        load_ship(bad)
    lines = sorted(str(refused.value).splitlines())
    assert len(lines) == 2
    assert lines[0].startswith("kcs: hull.L = ") and lines[0].endswith(": must be a number")
    assert lines[1] == "kcs: rudder = None: must be a section of numbers"
