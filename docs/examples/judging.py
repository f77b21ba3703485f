"""What the examples share: a torch network as a controller, beside the classical autopilot.

Not an example itself. The network and the usual autopilot of the task (`pid` for headings,
`drift_los` for tracks) sail the same evaluation seeds, which no training sees.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from ship_gym_agents import make_controller

from ship_gym.evaluation import compare, evaluation_seeds, rollout
from ship_gym.scenarios.scenario import load_scenario
from ship_gym.tasks import TASKS
from ship_gym.text import signed_interval

MeanAction = Callable[[torch.Tensor], torch.Tensor]


class NetworkController:
    """Anything that gives actions (n, n_actions) for observations (n, n_observations).

    Parameters
    ----------
    mean_action : callable
        Of float32 tensors on the CPU; what it gives is limited to [-1, 1].
    name : str
    """

    def __init__(self, mean_action: MeanAction, name: str):
        self._mean_action, self.name = mean_action, name

    def reset(self, count: int, ship: Any, scenario: Any) -> None:
        """Nothing to forget: what it does depends on the present observation only."""

    @torch.no_grad()
    def act(self, observations: np.ndarray) -> np.ndarray:
        """Actions as a controller gives them."""
        seen = torch.as_tensor(observations, dtype=torch.float32)
        return self._mean_action(seen).clamp(-1.0, 1.0).double().numpy()


def judge(
    mean_action: MeanAction,
    name: str,
    episodes: int,
    scenario: str,
    **env: Any,
) -> dict[str, Any]:
    """A network and the usual autopilot of the task on the same episodes.

    Parameters
    ----------
    mean_action : callable
        As in `NetworkController`.
    name : str
        Of the network.
    episodes : int
        Of the seeds kept for evaluation.
    scenario : str
    **env
        More keyword arguments of ``rollout``.

    Returns
    -------
    dict
        ``seeds`` (first, last), ``autopilot`` and ``metrics``: for the headline metric of the task,
        rudder travel and success the ``unit``, one value for each controller (interquartile mean,
        of success the rate) and the paired ``difference`` with its 95 % interval.
    """
    task, seeds = TASKS[load_scenario(scenario).task], evaluation_seeds(episodes)
    autopilot = make_controller(task.controllers[0])
    both = (autopilot, NetworkController(mean_action, name))
    found = compare([rollout(one, scenario, seeds=seeds, parallel=False, **env) for one in both])
    return {
        "seeds": [seeds[0], seeds[-1]],
        "autopilot": autopilot.name,
        "metrics": {
            metric: {
                "unit": found["metrics"][metric]["unit"],
                **{one: column[metric]["value"] for one, column in found["controllers"].items()},
                "difference": found["differences"][name][metric],
            }
            for metric in dict.fromkeys((task.headline, "rudder_travel", "success"))
        },
    }


def in_words(judged: dict[str, Any], name: str) -> str:
    """What `judge` found, one line for each metric."""
    (first, last), other = judged["seeds"], judged["autopilot"]
    lines = [f"{name} beside {other}, seeds {first} to {last}:"]
    for metric, row in judged["metrics"].items():
        words = "an episode has no such value"
        if None not in (row[name], row[other]):
            d = row["difference"]
            words = (
                f"{row[name]:.4g} against {row[other]:.4g} {row['unit']}, "
                f"paired difference {signed_interval(d['value'], d['low'], d['high'])}"
            )
        lines.append(f"  {metric}: {words}")
    return "\n".join(lines)
