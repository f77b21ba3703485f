"""The report on a fit: ours beside the printed numbers, as data, as text and as sections."""

import dataclasses
import json

import numpy as np
import pytest

from ship_gym.csv_file import read_csv
from ship_gym.reports import surrogate as report
from ship_gym.reports.page import plain_text
from ship_gym.reports.surrogate_sections import provenance, sections
from ship_gym.ships import load_ship
from ship_gym.surrogates.fit import Options, fit
from ship_gym.surrogates.force_table import table_of
from ship_gym.surrogates.samples import KCS, ONRT


def made(data, options=None, grid=None, turbulence=""):
    found = fit(data, options, grid, turbulence)
    return found, table_of(found, load_ship(data.ship, surrogate="none"))


@pytest.fixture(scope="module")
def kcs():
    return made(KCS)


@pytest.fixture(scope="module")
def onrt():
    return made(ONRT)


def words(text, start):
    """Words of the first line that starts so."""
    return next(x for x in text.splitlines() if x.strip().startswith(start)).split()


def test_kcs_beside_the_printed_numbers(kcs):
    data = report.as_dict(*kcs)
    side = data["sides"]["single"]
    assert side["printed_errors_percent"]["K_T"] == [2.652, 0.47, -0.332, 1.596]  # Table 3.7
    assert side["printed_coefficients"]["K_T"][0] == 0.5345290305  # Table A.9
    budget = {row["quantity"]: row for row in data["error_budget"]}
    assert budget["C_Fy"]["printed_total"] == 19.89
    assert budget["C_Fy"]["total"] == pytest.approx(19.89, abs=0.07)
    text = plain_text(sections(data, {}))
    assert words(text, "K_T  ")[1:5] == ["+2.67", "+0.42", "-0.07", "+1.62"]
    assert "printed norm" in text and "K_S (printed)" in text
    assert json.loads(json.dumps(data)) == data


def test_onrt_beside_the_printed_numbers(onrt):
    data = report.as_dict(*onrt)
    leeward = data["sides"]["leeward"]
    assert leeward["printed_errors_percent"]["K_X"] == [2.021, -3.828, 6.348, 7.054]  # Table 5.9
    assert leeward["printed_coefficients"]["K_X"][0] == 0.738995787  # Table B.11, port
    assert all(row["printed_total"] is None for row in data["error_budget"])
    text = plain_text(sections(data, {}))
    assert "K_X, windward" in text and "printed norm" not in text
    assert "gamma_R, leeward" in text and "open-water torque" in text


def test_the_process_beside_its_printed_means():
    found, table = made(KCS, Options("gp", noise="none"))
    data = report.as_dict(found, table)
    side = data["sides"]["single"]
    # Table 3.11; those of the rudder are of its movable part, whose forces are not printed
    assert side["printed_mean_errors_percent"] == {"K_T": 1.384, "10K_Q": 0.967}
    assert side["printed_errors_percent"] == {} and side["printed_coefficients"] == {}
    assert np.abs(side["held_out_errors_percent"]["K_T"]).mean() == pytest.approx(1.384, abs=1.5)
    total = next(row for row in data["error_budget"] if row["quantity"] == "K_T")
    assert total["surrogate"] == pytest.approx(
        np.abs(side["held_out_errors_percent"]["K_T"]).mean()
    )
    assert total["printed_total"] is None  # printed of the regression only
    assert "length_scales" in plain_text(sections(data, {}))
    assert report.printed_means(ONRT, "none", "leeward") == {
        "K_X": 6.47, "K_S": 10.36, "C_Fx": 3.86, "C_Fy": 2.71,
    }  # fmt: skip


def test_what_is_not_printed_is_not_compared():
    own = dataclasses.replace(KCS, name="own")
    assert report.printed_errors(own, "G2", "SA", "single") == {}
    assert report.printed_means(own, "none", "single") == {}
    assert report.printed_means(KCS, "computed", "single") == {}
    assert report.printed_errors(KCS, "G2", "SST", "single") == {}
    assert report.printed_errors(ONRT, "G3", "SA", "leeward") == {}


def test_without_held_out_points_each_is_left_out(kcs):
    data = dataclasses.replace(KCS, name="own", validation=(), training=tuple(range(1, 13)))
    facts = report.as_dict(*made(data))
    left_out = facts["sides"]["single"]["leave_one_out_errors_percent"]
    assert [len(errors) for errors in left_out.values()] == [12] * 4
    assert facts["error_budget"] == []  # its grids are those of the thesis
    assert "each point left out of the fit in turn" in plain_text(sections(facts, {}))
    six = dataclasses.replace(data, training=(5, 6, 7, 8, 9, 10))
    side = report.as_dict(*made(six))["sides"]["single"]
    assert "6 features, but 5 points" in side["leave_one_out_refused"]


def test_printed_coefficients_have_no_errors_of_their_own_points():
    facts = report.as_dict(*made(KCS, None, "G2", "SST"))
    text = plain_text(sections(facts, {}))
    assert facts["sides"]["single"]["fitted"] == [] and "K_T (printed)" in text
    assert "largest std" not in text and "Latin hypercube" in text


@pytest.mark.slow
def test_turning_circle_of_the_trial(kcs, onrt):
    found, table = kcs
    turn = report.turning_check(load_ship("kcs_model", surrogate="none"), table, found.name)
    assert turn["delta_deg"] == 35.0 and turn["trial"]["max_advance"] == 3.1
    assert turn["measures"]["max_advance"] == pytest.approx(3.1, rel=0.08)
    found, table = onrt
    turn = report.turning_check(load_ship("onrt_model", surrogate="none"), table, found.name)
    assert turn["delta_deg"] == -35.0 and turn["trial"]["tactical_diameter"] == 3.0
    # sailed in the waves of the trial: the circle drifts
    assert turn["measures"]["drift_distance"] > 0.05
    # a ship without trial turns with its largest angle
    bare = dataclasses.replace(load_ship("kcs_model", surrogate="none"), trials=())
    turn = report.turning_check(bare, kcs[1], "G2_SA")
    assert turn["delta_deg"] == pytest.approx(35.0) and turn["trial"] == {}


def test_how_to_use_and_file_names(kcs):
    found, _ = kcs
    assert report.file_stem(found) == "surrogate_kcs_G2_SA"
    own = dataclasses.replace(found, data=dataclasses.replace(KCS, name="G2"))
    assert report.file_stem(own) == "surrogate_G2_SA"
    text = report.how_to_use("a.npz", found, "kcs_model")
    assert 'Table.load("a.npz"), "G2_SA")' in text and 'surrogate="G2_SA"' in text
    third = dataclasses.replace(found, options=Options(order="first"))
    assert "comes with the package" not in report.how_to_use("a.npz", third, "kcs_model")


def test_provenance_names_inputs_and_commit(kcs):
    data = report.as_dict(*kcs)
    text = plain_text([provenance(data)])
    assert data["inputs"]["kcs_propeller_rudder_cfd.csv"] in text and data["git_commit"] in text


def test_every_shipped_table_has_a_data_set():
    assert {row[0] for row in report.SHIPPED} == {"kcs", "onrt", "onrt_16"}
    assert len(set(report.SHIPPED)) == len(report.SHIPPED) == 13
    assert read_csv(KCS.path).path.endswith("kcs_propeller_rudder_cfd.csv")
