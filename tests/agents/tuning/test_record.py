import dataclasses

from ship_gym_agents.gains_files import GainsFile, write_gains
from ship_gym_agents.los import ILOS
from ship_gym_agents.pid import PID, Gains
from ship_gym_agents.tuning import Size, is_tuned, settings
from ship_gym_agents.tuning.record import _versions

SMALL = Size(episodes=2, generations=1, candidates=4, polish=2)


def test_settings_say_what_a_tuning_depends_on():
    how = settings(SMALL, "track_current", "track_following", ["guidance"], control="rudder")
    assert how["objective"].startswith("mean of the rms distance to the route [L] + 2e-05 rudder")
    assert how["method"] == "CMA-ES, 1 generations of 4, seed 0; then Nelder-Mead, 2 evaluations"
    assert how["seeds_tuning"] == [500_000, 500_001]
    assert how["seeds_validation"] == [500_002, 500_007]
    assert how["scenario"] == "track_current" and how["control"] == "rudder"


def test_a_tuning_resumes_only_with_the_same_settings(tmp_path):
    path, task = tmp_path / "pid.toml", "heading_keeping"
    how = settings(SMALL, task, task, ["PD"])
    assert not is_tuned(PID, "kcs", how, path)
    write_gains(GainsFile("kcs", Gains(1.0, 1.0), how, _versions()), path)
    assert is_tuned(PID, "kcs", how, path)
    more = dataclasses.replace(SMALL, episodes=3)
    assert not is_tuned(PID, "kcs", settings(more, task, task, ["PD"]), path)
    assert not is_tuned(PID, "kvlcc2", how, path)
    assert not is_tuned(ILOS, "kcs", how, path)
