import pytest

from ship_gym.config import ConfigError
from ship_gym.envs.registration import ENVIRONMENTS
from ship_gym.scenarios import available_scenarios, load_scenario


def test_every_scenario_and_every_id_load():
    for name in {*available_scenarios(), *ENVIRONMENTS.values()}:
        assert load_scenario(load_scenario(name).to_dict()) == load_scenario(name)


def test_overrides_nested_and_dotted():
    a = load_scenario("heading_keeping", {"reward": {"rudder": 8.0}, "duration": 100})
    b = load_scenario("heading_keeping", {"reward.rudder": 8.0, "duration": 100.0})
    assert a == b and a.reward.rudder == 8.0 and a.steps == 100
    assert a.reward.heading == load_scenario().reward.heading


def test_a_scenario_file_from_outside(tmp_path):
    from ship_gym.scenarios.scenario import _FOLDER

    text = (_FOLDER / "heading_keeping.toml").read_text()
    path = tmp_path / "mine.toml"
    path.write_text(text.replace("duration = 600.0", "duration = 60.0"))
    assert load_scenario(path).steps == 60


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"reward.ruder": 1.0}, ["reward", "ruder", "did you mean 'rudder'"]),
        ({"durations": 1.0}, ["durations", "did you mean 'duration'"]),
        ({"control": "rudders"}, ["control", "did you mean 'rudder'"]),
        ({"task": "parking"}, ["task", "heading_keeping"]),
        ({"control_interval": 0.0}, ["control_interval = 0"]),
        ({"start.heading_error_deg": 70.0}, ["start.heading_error_deg = 70", "below"]),
        ({"duration": 10.4, "control_interval": 4.0}, ["duration = 10.4", "multiple"]),
        ({"reward.heading": -1.0}, ["reward.heading = -1"]),
        ({"sea.current_speed": "fast"}, ["sea.current_speed", "fast"]),
    ],
)
def test_bad_overrides(overrides, words):
    with pytest.raises(ConfigError) as error:
        load_scenario("heading_keeping", overrides)
    for word in words:
        assert word in str(error.value)


def test_unknown_scenario():
    with pytest.raises(ConfigError, match="did you mean 'heading_keeping'"):
        load_scenario("heading_keepin")
