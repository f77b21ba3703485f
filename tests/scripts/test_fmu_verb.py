"""ship-gym fmu."""

import json
import math
import zipfile

import pytest

pytest.importorskip("pythonfmu")


def test_without_arguments_it_writes_a_ship_in_calm_water(cli, tmp_path):
    code, out, err = cli("fmu")
    assert (code, err) == (0, "")
    assert "kcs as FMU of FMI 2.0 for co-simulation, sea calm" in out
    assert "wrote runs/kcs.fmu" in out and "wrote runs/kcs_OspModelDescription.xml" in out
    assert "next: python -m fmpy info runs/kcs.fmu" in out
    with zipfile.ZipFile(tmp_path / "runs" / "kcs.fmu") as archive:
        names = archive.namelist()
    assert "modelDescription.xml" in names and "binaries/linux64/kcs.so" in names


def test_options_are_what_the_parameters_start_with(cli, tmp_path):
    arguments = ["--wave-height", 3, "--wave-period", 9, "--wave-from", 90, "--wind-speed", 12]
    arguments += ["--current-speed", 0.5, "--current-to", -90, "--seed", 4, "--heading", 45]
    code, out, _ = cli("fmu", *arguments, "--n", 1.2, "--out", "a.fmu", "--json")
    found = json.loads(out)
    assert code == 0 and found["files"] == ["a.fmu", "a_OspModelDescription.xml"]
    with zipfile.ZipFile(tmp_path / "a.fmu") as archive:
        card = json.loads(archive.read("resources/unit.json"))
    expected = {
        "sea.wave_height": 3.0,
        "sea.wave_direction_from": math.pi / 2,
        "sea.wind_speed": 12.0,
        "sea.current_direction_to": -math.pi / 2,
        "seed": 4,
        "start.heading": math.pi / 4,
        "start.self_propulsion": False,
        "start.propeller_speed": 1.2,
        "propeller.command": 1.2,
    }
    assert expected.items() <= card["values"].items() and card["modelName"] == "a"


def test_a_sea_of_numbers_is_not_called_calm_alone(cli):
    code, out, _ = cli("fmu", "--wave-height", 3, "--wind-speed", 9, "--out", "b.fmu")
    assert code == 0 and "sea calm with waves, wind of its own\n" in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--ship", "kcz"], "unknown ship 'kcz'; did you mean 'kcs'"),
        (["--ship", "none.toml"], "none.toml: no such file"),
        (["--sea", "ss9"], "unknown sea 'ss9'"),
        (["--wave-height", "31"], "--wave-height = 31: allowed is 0 to 30 [m]"),
        (["--wave-height", "5", "--wave-period", "2"], "a wave breaks above 0.142"),
        (["--wave-from", "45"], "sea.wave_direction_from"),
        (["--gusts"], "sea.gusts with wind_speed = 0.0"),
        (["--speed", "100"], "kcs cannot hold 100 m/s"),
        (["--n", "9"], "n = 9.0: allowed is"),
        (["--seed", "-1"], "--seed = -1: allowed is"),
        (["--at", "1000", "0"], "--at = 1000: allowed is"),
        (["--at", "91", "0"], "start.latitude = 91.0: allowed is -90 to 90 [deg]"),
        (["--out", "a.zip"], "--out a.zip: allowed is a .fmu file"),
        (["--out", "my-ship.fmu"], "the name of an FMU is that of its model"),
        (["--regular"], "sea.regular = True: means nothing without sea.wave_height"),
    ],
)
def test_what_cannot_be_is_one_line_and_nothing_is_written(cli, tmp_path, arguments, words):
    code, out, err = cli("fmu", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert words in err and len(err) <= 301
    assert not [file for file in tmp_path.rglob("*") if file.is_file()]


def test_an_fmu_of_fmi_3(cli, tmp_path, monkeypatch):
    pytest.importorskip("pythonfmu3")
    code, out, _ = cli("fmu", "--fmi", "3", "--out", "a.fmu")
    assert code == 0 and "kcs as FMU of FMI 3.0 for co-simulation" in out
    with zipfile.ZipFile(tmp_path / "a.fmu") as archive:
        assert b'fmiVersion="3.0"' in archive.read("modelDescription.xml")


@pytest.mark.parametrize(("fmi", "library"), [("2", "pythonfmu"), ("3", "pythonfmu3")])
def test_a_missing_library_is_one_line(cli, tmp_path, monkeypatch, fmi, library):
    from ship_gym_agents.cli import output

    found = output.find_spec
    monkeypatch.setattr(output, "find_spec", lambda name: None if name == library else found(name))
    code, out, err = cli("fmu", "--fmi", fmi)
    assert (code, out, err.count("\n")) == (2, "", 1) and not list(tmp_path.iterdir())
    assert f'need {library}: pip install "ship-gym[fmu]"' in err


def test_an_fmu_of_another_ship_is_replaced_by_force_only(cli):
    assert cli("fmu", "--out", "a.fmu")[0] == 0
    assert cli("fmu", "--out", "a.fmu", "--sea", "ss4")[0] == 0
    code, _, err = cli("fmu", "--ship", "kvlcc2", "--out", "a.fmu")
    assert (
        code == 2
        and err == "error: --out a.fmu: holds an FMU of kcs, not an FMU of kvlcc2; see --force\n"
    )
    assert cli("fmu", "--ship", "kvlcc2", "--out", "a.fmu", "--force")[0] == 0
