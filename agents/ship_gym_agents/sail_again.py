"""Sail an episode of a benchmark again, for its picture."""

from __future__ import annotations

from ship_gym.config import ConfigError
from ship_gym.envs.registration import load_task
from ship_gym.evaluation import rollout
from ship_gym.evaluation.report import Episode
from ship_gym.recording.trajectory import Trajectory
from ship_gym_agents.controllers import make_controller


def sail_again(episode: Episode) -> Trajectory | None:
    """The episode as a recording; None where a name or file of it is not known any more."""
    try:
        if episode.task:
            load_task(episode.task)
        controller = make_controller(episode.controller)
        where, seeds = episode.scenario, [episode.seed]
        sailed = rollout(controller, where, seeds=seeds, ship=episode.ship, control=episode.control)
    except (ConfigError, ImportError):
        return None
    return sailed.trajectory(0)
