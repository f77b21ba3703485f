"""A user's own samples: what is accepted, and every refusal with file and line."""

import dataclasses
import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.ships import load_ship
from ship_gym.surrogates.fit import Options, fit
from ship_gym.surrogates.force_table import table_of
from ship_gym.surrogates.own import own_data_set
from ship_gym.surrogates.sample_checks import check_samples
from ship_gym.surrogates.samples import KCS, LEEWARD, ONRT, WINDWARD
from ship_gym.surrogates.sampling import least_sure

HEADER = "# title: t\n# source: s\n# obtained: o\n# conventions: c\n"
TITLES = "point [-],J [-],beta [deg],K_T [-],10K_Q [-],C_Fx [-],C_Fy [-]"
ROWS = (  # the twelve G2 points of KCS, line 6 and on
    "1,0.462,39.38,0.33,0.539,-0.267,0.265",
    "2,0.288,28.12,0.407,0.633,-0.233,0.261",
    "3,0.638,16.88,0.272,0.465,-0.32,0.383",
    "4,0.812,5.62,0.237,0.42,-0.325,0.424",
    "5,0.681,25.31,0.247,0.436,-0.305,0.338",
    "6,0.594,2.81,0.309,0.506,-0.326,0.395",
    "7,0.244,30.94,0.423,0.653,-0.216,0.245",
    "8,0.419,42.19,0.34,0.555,-0.25,0.241",
    "9,0.769,36.56,0.194,0.376,-0.213,0.219",
    "10,0.506,14.06,0.32,0.523,-0.31,0.367",
    "11,0.331,19.69,0.394,0.616,-0.258,0.316",
    "12,0.856,8.44,0.214,0.394,-0.314,0.426",
)


@pytest.fixture(scope="module")
def ship():
    return load_ship("kcs_model", surrogate="none")


@pytest.fixture
def write(tmp_path):
    """Write a file of samples; gives its path."""

    def made(rows=ROWS, titles=TITLES, header=HEADER):
        path = tmp_path / "my.csv"
        path.write_text(header + titles + "\n" + "\n".join(rows) + "\n")
        return path

    return made


def with_row(number, text):
    """Rows with the one of this point replaced."""
    return [text if row.split(",")[0] == str(number) else row for row in ROWS]


def test_own_samples_give_the_table_of_the_project(write, ship):
    data = own_data_set(write(), ship, validation=KCS.validation)
    (few,) = check_samples(data, ship)
    assert "8 training points for the 6 numbers of the second order regression" in few
    assert data.training == KCS.training and data.validation == KCS.validation
    assert data.delta == ship.gear.delta_max and data.sign == 1.0
    assert data.box == (0.244, 0.856, math.radians(2.81), math.radians(42.19))
    found = fit(data)
    assert found.name == "my" and found.errors("single")["K_T"][0] == pytest.approx(2.67, abs=0.05)
    np.testing.assert_allclose(
        found.models["single"]["K_T"].coefficients, fit(KCS).models["single"]["K_T"].coefficients
    )
    card = table_of(found, ship).card
    assert card["made_for"]["ship"] == "kcs_model" and list(card["inputs"]) == ["my.csv"]


def test_project_files_are_own_samples_too(ship, tmp_path):
    data = own_data_set(KCS.path, ship, validation=KCS.validation)
    assert data.choices[:2] == (("G1", "SA"), ("G2", "SA"))
    assert fit(data, None, "G2", "SA").errors("single") == fit(KCS).errors("single")
    path = tmp_path / "twin.csv"
    path.write_text("# turn: port\n" + ONRT.path.read_text())
    twin = load_ship("onrt_model", surrogate="none")
    data = own_data_set(path, twin, validation=ONRT.validation)
    data = dataclasses.replace(data, by_model_speed=True)  # as ONRT, and no user's file, has it
    assert data.sides == {LEEWARD: "port", WINDWARD: "starboard"} and data.sign == -1.0
    ours, theirs = fit(data, None, "G2", "SA"), fit(ONRT)
    assert ours.errors(WINDWARD)["C_Fy"] == theirs.errors(WINDWARD)["C_Fy"]


def test_optional_columns_and_headers(write, ship):
    titles = TITLES.replace("beta [deg]", "beta [rad]").replace("10K_Q [-],", "") + ",set"
    rows = []
    for i, row in enumerate(ROWS):
        cells = row.split(",")
        cells[2] = f"{math.radians(float(cells[2])):.6f}"
        cells[-1] = f"-{cells[-1]}"
        rows.append(",".join([*cells[:4], *cells[5:], "validation" if i < 4 else "training"]))
    header = HEADER + "# side force: starboard\n# delta_deg: 30\n"
    data = own_data_set(write(rows, titles, header), ship)
    assert data.validation == (1, 2, 3, 4) and data.quantities == ("K_T", "C_Fx", "C_Fy")
    assert data.sign == -1.0 and data.delta == pytest.approx(math.radians(30.0))
    assert data.box[3] == pytest.approx(math.radians(42.19), abs=1e-6)
    assert own_data_set(data.path, ship, delta_deg=25.0).delta == pytest.approx(math.radians(25.0))
    with pytest.raises(ConfigError, match="column 'set'"):
        own_data_set(data.path, ship, validation=(1,))


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("5,0.681,25.31,nan,0.437,-0.310,0.338", ":10: K_T = nan is not finite"),
        ("5,0.681,25.31,x,0.437,-0.310,0.338", ":10: K_T = 'x' is not a number"),
        ("5,0.681,25.31,0.246,0.437,-0.310", ":10: 6 cells, but 7 columns"),
        ("5.5,0.681,25.31,0.246,0.437,-0.310,0.338", ":10: point = 5.5 .* whole number"),
        ("5,0,25.31,0.246,0.437,-0.310,0.338", ":10: J = 0 .* above 0, at most 3"),
        ("5,3.2,25.31,0.246,0.437,-0.310,0.338", ":10: J = 3.2 "),
        ("5,0.681,91,0.246,0.437,-0.310,0.338", ":10: beta = 91 .* at most 90 deg"),
        ("5,0.681,25.31,24.6,0.437,-0.310,0.338", ":10: K_T = 24.6 .* at most 2"),
        ("5,0.681,25.31,0.246,0.437,-0.310,-3.38", ":10: C_Fy = -3.38 .* at most 3"),
        ("4,0.812,5.62,0.240,0.420,-0.325,0.424", ":10: point 4 has other values in line 9"),
        ("4,0.812,5.62,0.237,0.420,-0.325,0.424", ":10: point 4 is in line 9 already: delete one"),
        ("4,0.9,5.62,0.237,0.420,-0.320,0.424", ":10: point 4 is at another J or drift in line 9"),
        ("5,0.812,5.62,0.240,0.420,-0.320,0.424", ":10: point 5 has other values in line 9"),
    ],
)
def test_a_wrong_line_is_named(write, ship, row, words):
    with pytest.raises(ConfigError, match=f"my.csv{words}"):
        own_data_set(write(with_row(5, row)), ship)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("beta [deg]", "beta", ":5: column 'beta' has no unit; allowed is 'beta .deg.' or"),
        ("beta [deg]", "beta [grad]", r":5: column 'beta' has unit \[grad\]"),
        ("J [-]", "J [m]", r":5: column 'J' has unit \[m\]"),
        ("10K_Q [-]", "K_Q [-]", ":5: unknown column 'K_Q'; did you mean '10K_Q'"),
        ("C_Fy [-]", "C_Mz [-]", ":5: no column 'C_Fy'"),
        ("K_T [-]", "K_S [-]", ":5: needed is one of the columns 'K_T' and 'K_X'"),
        ("10K_Q [-]", "K_X [-]", ":5: needed is one of the columns 'K_T' and 'K_X'"),
        ("10K_Q [-]", "grid [-]", ":5: column 'grid' holds names"),
    ],
)
def test_wrong_columns_are_named(write, ship, old, new, words):
    with pytest.raises(ConfigError, match=f"my.csv{words}"):
        own_data_set(write(titles=TITLES.replace(old, new, 1)), ship)


def test_degrees_under_a_column_of_radians(write, ship):
    path = write(titles=TITLES.replace("[deg]", "[rad]"))
    with pytest.raises(ConfigError, match=r"my.csv:6: beta = 39.38 \[rad\].* looks like degrees"):
        own_data_set(path, ship)


def test_a_turn_to_the_other_side(write, ship):
    def turned(k):
        return [",".join([*(c := row.split(","))[:k], f"-{c[k]}", *c[k + 1 :]]) for row in ROWS]

    with pytest.raises(ConfigError, match=r"lines 6, 7, .* C_Fy has the sign of a turn to the oth"):
        own_data_set(write(turned(6)), ship)
    data = own_data_set(write(turned(6), header=HEADER + "# turn: port\n"), ship)
    assert data.to_port
    with pytest.raises(ConfigError, match=r"beta is negative"):
        own_data_set(write(turned(2)), ship)
    with pytest.raises(ConfigError, match="unknown turn"):
        own_data_set(write(header=HEADER + "# turn: left\n"), ship)
    with pytest.raises(ConfigError, match="delta_deg: 'large' is not a number"):
        own_data_set(write(header=HEADER + "# delta_deg: large\n"), ship)
    with pytest.raises(ConfigError, match="delta_deg = 0"):
        own_data_set(write(), ship, delta_deg=0.0)
    with pytest.raises(ConfigError, match=r"no points \[13\] to hold out"):
        own_data_set(write(), ship, validation=(13,))


def test_sides_must_fit_the_ship(write, ship):
    both = [f"{row},{side}" for row in ROWS for side in ("leeward", "windward")]
    path = write(both, TITLES + ",side")
    with pytest.raises(ConfigError, match="kcs_model has one rudder"):
        own_data_set(path, ship)
    twin = load_ship("onrt_model", surrogate="none")
    assert own_data_set(path, twin).sides == {LEEWARD: "leeward", WINDWARD: "windward"}
    with pytest.raises(ConfigError, match="needed are leeward and windward"):
        own_data_set(write(), twin)


def checked(path, ship, **options):
    return check_samples(own_data_set(path, ship), ship, Options(**options))


def test_too_few_points_name_their_lines(write, ship):
    with pytest.raises(ConfigError, match=r"lines 6, 7, 8, 9, 10: 5 training points.* needs 6"):
        checked(write(ROWS[:5]), ship)
    assert checked(write(ROWS[:5]), ship, order="first")  # warned of, but fitted
    with pytest.raises(ConfigError, match=r"12 training points, but the fourth order .* needs 15"):
        checked(write(), ship, order="fourth")
    with pytest.raises(ConfigError, match="2 training points, but the gp needs 3"):
        checked(write(ROWS[:2]), ship, family="gp", noise="none")


def on_line(count):
    """Points on one line J = 0.2 + beta / 100."""
    return [
        f"{i},{0.2 + 0.05 * i},{5 * i},0.3,0.5,-0.3,{0.3 + 0.01 * i}" for i in range(1, count + 1)
    ]


@pytest.mark.parametrize("family", ["regression", "gp", "nn"])
def test_collinear_points_are_refused(write, ship, family):
    with pytest.raises(ConfigError, match=r"lines 6, 7, .*: collinear: all points lie on one line"):
        checked(write(on_line(8)), ship, family=family, noise="none")


def test_points_on_two_lines_cannot_carry_squares(write, ship):
    rows = [f"{i},{0.3 if i < 5 else 0.6},{6 * i},0.3,0.5,-0.3,0.3" for i in range(1, 10)]
    with pytest.raises(ConfigError, match="9 places do not span the 6 features"):
        checked(write(rows), ship)
    assert checked(write(rows), ship, order="first") == []


def test_warnings_name_file_and_lines(write, ship):
    rows = [
        *ROWS,
        "13,0.856,8.44,0.214,0.394,-0.314,0.426",  # as point 12, line 17
        "14,2.5,20,-0.1,0.1,0.02,-0.05",
        "15,0.5,70,0.3,0.05,-0.2,0.2",
    ]
    found = checked(write(rows), ship)
    assert all("my.csv: line" in warning for warning in found)
    text = "\n".join(found)
    assert "lines 17, 18: the same point, which counts 2 times" in text
    assert "line 19: J above" in text and "line 19: K_T is not positive" in text
    assert "line 19: C_Fx >= 0" in text and "line 19: C_Fy to the other side than most" in text
    assert "line 20: drift beyond 60 deg" in text
    assert "line 20: more thrust power than shaft power" in text
    assert checked(write(), ship) == []


def test_radians_under_a_column_of_degrees_and_clusters(write, ship):
    def moved(J, beta):
        cells = [row.split(",") for row in ROWS]
        return [",".join([c[0], f"{J(c):.5f}", f"{beta(c):.5f}", *c[3:]]) for c in cells]

    radians = moved(lambda c: float(c[1]), lambda c: math.radians(float(c[2])))
    found = checked(write(radians), ship)
    assert len(found) == 1 and "looks like radians" in found[0]
    near = moved(lambda c: float(c[1]), lambda c: 40.0 * float(c[1]) + 1e-2 * float(c[2]))
    found = checked(write(near), ship)
    assert len(found) == 1 and "clustered or nearly collinear" in found[0]


@pytest.mark.parametrize("factor", [3.0, 1.0 / 3.0])
def test_rudder_forces_in_another_normalisation(write, ship, factor):
    """Times 3 the tactical diameter would be 1.51 L instead of 3.09."""
    cells = [row.split(",") for row in ROWS]
    rows = [",".join([*c[:5], *(f"{factor * float(x):.4f}" for x in c[5:])]) for c in cells]
    (warning,) = checked(write(rows), ship)
    assert "my.csv: C_Fx, C_Fy: normal force" in warning and "usual is 0.35 to 1.27" in warning


def test_one_angle_in_radians_among_degrees(write, ship):
    (warning,) = checked(write(with_row(9, "9,0.769,0.6381,0.194,0.376,-0.213,0.219")), ship)
    assert "my.csv: line 14: drift looks like radians" in warning and "36.6 deg" in warning


def test_the_samples_of_the_thesis_are_spread_well(ship):
    assert all("average out" in warning for warning in check_samples(KCS, ship))


def test_a_double_column_is_refused_and_a_byte_order_mark_is_not(write, ship):
    path = write(titles=TITLES.replace("10K_Q", "K_T"))
    with pytest.raises(ConfigError, match=r"my.csv:5: column 'K_T' is there twice"):
        own_data_set(path, ship)
    path = write()
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert len(own_data_set(path, ship).training) == 12


def test_the_box_is_that_of_the_training_points(write, ship):
    far = "13,1.4,30.0,0.05,0.15,-0.2,0.2"
    data = own_data_set(write((*ROWS, far)), ship, validation=(13,))
    assert data.box[1] == 0.856 and table_of(fit(data), ship).card["domain"]["J_max"] == 0.856
    with pytest.raises(ConfigError, match="all points are held out"):
        own_data_set(write(), ship, validation=tuple(range(1, 13)))


@pytest.fixture
def twin(tmp_path):
    """The printed ONRT samples as a user's own, with changes."""

    def made(change=lambda text: text):
        path = tmp_path / "twin.csv"
        text = ONRT.path.read_text().replace("# conventions", "# turn: port\n# conventions")
        path.write_text(change(text))
        return path

    return made


def test_exchanged_sides_and_a_wrong_side_force_of_the_propeller_are_warned_of(twin):
    ship = load_ship("onrt_model", surrogate="none")

    def warnings(path):
        return " ".join(check_samples(own_data_set(path, ship), ship, None, "G2", "SA"))

    assert "exchanged" not in warnings(twin()) and "K_S" not in warnings(twin())

    def exchanged(text):
        swap = {"port": "starboard", "starboard": "port"}
        rows = [row.split(",") for row in text.splitlines()]
        return "\n".join(",".join(swap.get(x, x) for x in row) for row in rows)

    assert "sides exchanged?" in warnings(twin(exchanged))

    def turned(text):
        rows = [row.split(",") for row in text.splitlines()]
        rows = [[*r[:7], f"-{r[7]}", *r[8:]] if r[0].isdigit() else r for r in rows]
        return "\n".join(",".join(row) for row in rows)

    assert "K_S pushes against the cross flow" in warnings(twin(turned))


def test_a_quantity_that_does_not_vary_has_no_relative_standard_deviation(write, ship):
    rows = [f"{row},0.02" for row in ROWS]
    found = fit(own_data_set(write(rows, TITLES + ",K_S [-]"), ship))
    assert "K_S" not in {row["quantity"] for row in least_sure(found)}


def with_noise(rows=ROWS):
    """Rows with a standard deviation of the thrust, large at points 5 and 6."""
    return [f"{row},{0.05 if row[:2] in ('5,', '6,') else 0.002}" for row in rows]


def test_a_noise_of_each_point_is_that_of_the_process(write, ship):
    data = own_data_set(write(with_noise(), TITLES + ",K_T std [-]"), ship)
    assert data.quantities == ("K_T", "10K_Q", "C_Fx", "C_Fy")
    training = data.read().pick((7, 5))
    assert training.noise["K_T"].tolist() == [0.002, 0.05]
    with pytest.raises(ConfigError, match=r"no column '10K_Q std \[-\]' for noise = 'given'"):
        fit(data, Options("gp", noise="given"))
    every = [f"{row},0.01,0.02,0.03" for row in with_noise()]
    titles = TITLES + "".join(f",{k} std [-]" for k in ("K_T", "10K_Q", "C_Fx", "C_Fy"))
    found = fit(own_data_set(write(every, titles), ship), Options("gp", noise="given"))
    models = found.models["single"]
    assert models["K_T"].sigma_n.tolist() == found.training["single"].noise["K_T"].tolist()
    assert (models["C_Fy"].sigma_n == 0.03).all()
    assert found.name == "gp"


@pytest.mark.parametrize(
    ("titles", "last", "words"),
    [
        (",K_T std [-]", "0", ":6: K_T std = 0 .* above 0"),
        (",K_S std [-]", "0.1", ":5: column 'K_S std' without 'K_S'"),
        (",K_T std", "0.1", ":5: column 'K_T std' has no unit"),
        (",delta [deg]", "95", r":6: delta = 95 \[deg\]: allowed is 0 to 90 deg"),
        (",delta [rad]", "35", ":6: delta = 35 .* looks like degrees"),
        (",delta [deg]", "-35", ":6: delta = -35 "),
        (",delta [deg]", "0", "delta = 0: a surrogate needs the rudder over"),
    ],
)
def test_wrong_noise_and_rudder_angles_are_named(write, ship, titles, last, words):
    with pytest.raises(ConfigError, match=words):
        own_data_set(write([f"{row},{last}" for row in ROWS], TITLES + titles), ship)


@pytest.mark.slow
def test_a_process_builds_on_the_cheap_grid_without_the_held_out_points():
    options = Options("gp", noise="none", cheap="G1_SA")
    found = fit(KCS, options, "G2", "SA")
    model = found.models["single"]["C_Fx"]
    assert len(model.cheap._process.X_train_) == 8 and model.rho == pytest.approx(1.1, abs=0.1)
    assert found.name == "gp_exact_on_G1_SA"
    with pytest.raises(ConfigError, match=r"cheap samples of kcs.* 'G4_SA'.*G1_SA"):
        fit(KCS, Options("gp", noise="none", cheap="G4_SA"))
    with pytest.raises(ConfigError, match="dear grid itself"):
        fit(KCS, Options("gp", noise="none", cheap="G2_SA"))
    with pytest.raises(ConfigError, match="of the Gaussian process"):
        Options(cheap="G1_SA")
