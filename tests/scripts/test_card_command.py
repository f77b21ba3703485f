"""The command on the card of a recording makes the same recording again."""

import shlex

import pytest

from ship_gym.recording import Trajectory
from ship_gym.recording.card import again
from ship_gym.recording.comparison_card import content_hash


@pytest.mark.parametrize("controller", ["pid", "run"])  # by its name, and a policy by its file
def test_card_sails_the_episode_again(cli, policy, controller):
    pytest.importorskip("rerun")
    changed = ("--set", "duration=20", 'sea.states=["ss5"]', "sensors.noise=false")
    given = ("--scenario", "heading_ss6_beam", "--ship", "kcs_model", "--seed", "7", *changed)
    code, _, err = cli("record", "--controller", controller, *given, "--out", "first.rrd")
    assert code == 0, err
    first = Trajectory.from_rrd("first.rrd")
    program, verb, *words = shlex.split(again(first.meta))
    assert (program, verb) == ("ship-gym", "record")
    code, _, err = cli("record", *words, "--out", "again.rrd")
    assert code == 0, err
    repeated = Trajectory.from_rrd("again.rrd")
    assert all(first[name].tobytes() == repeated[name].tobytes() for name in first.names)
    if controller == "pid":
        assert content_hash(first) == content_hash(repeated)
