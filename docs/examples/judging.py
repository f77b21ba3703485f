"""What the examples share: a torch network as a controller, beside the classical autopilot.

Not an example itself. PPO of every library takes the same options and says the same at the end. The
network and the usual autopilot of the task (`pid` for headings,
`drift_los` for tracks) sail the same evaluation seeds, which no training sees.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from ship_gym_agents import make_controller
from ship_gym_agents.cli.output import show
from torch import nn

from ship_gym.config import check_number
from ship_gym.evaluation import compare, evaluation_seeds, rollout
from ship_gym.scenarios.scenario import load_scenario
from ship_gym.tasks import TASKS
from ship_gym.text import signed_interval

MeanAction = Callable[[torch.Tensor], torch.Tensor]
LOG_STD = (-1.0, -2.5)  # of actions in [-1, 1], at the start and at the end of a training


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


def options(
    description: str, examples: str, iterations: int = 100, **more: tuple[Any, str]
) -> argparse.Namespace:
    """Options of the command line that PPO of every library has, and `more` of an example's own.

    Those by name: the default, whose type is that of the option, and its help.
    """
    p = argparse.ArgumentParser(
        description=description.splitlines()[0],
        epilog=examples,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument(
        "--iterations", type=int, default=iterations, help="rollouts (default %(default)s)"
    )
    p.add_argument("--envs", type=int, default=64, help="ships (default 64)")
    p.add_argument("--ship", default="kcs", help="default kcs")
    p.add_argument("--episode", type=float, default=200.0, help="full-scale s (default 200)")
    p.add_argument("--judge", type=int, default=16, help="evaluation episodes (default 16)")
    p.add_argument("--seed", type=int, default=0)
    for name, (default, words) in more.items():
        words += " (default %(default)s)"
        p.add_argument(f"--{name}", type=type(default), default=default, help=words)
    p.add_argument("--json", action="store_true", help="print the result as JSON on stdout")
    a = p.parse_args()
    check_number("iterations", a.iterations, 1, 10**6)
    check_number("envs", a.envs, 1, 10**5)
    return a


def network(n_in: int, n_out: int) -> nn.Sequential:
    """Two hidden layers, as ``ship-gym train`` makes them; the outputs begin near zero."""
    layers = [nn.Linear(n_in, 64), nn.Linear(64, 64), nn.Linear(64, n_out)]
    for layer, gain in zip(layers, (2.0**0.5, 2.0**0.5, 0.01), strict=True):
        nn.init.orthogonal_(layer.weight, gain)
        nn.init.zeros_(layer.bias)
    return nn.Sequential(layers[0], nn.Tanh(), layers[1], nn.Tanh(), layers[2])


def tell(
    a: argparse.Namespace,
    mean_action: MeanAction,
    name: str,
    samples: int,
    seconds: float,
    scenario: str = "heading_keeping",
    **more: Any,
) -> None:
    """Judge what was learned with `options` `a`, and print it with the speed of the training.

    `more` is added to what ``--json`` prints; where the example has an option ``--out``, it wrote
    there.
    """
    judged = judge(mean_action, name, a.judge, scenario, ship=a.ship)
    speed = samples / seconds
    result = {
        "samples": samples,
        "seconds": round(seconds, 1),
        "samples_per_second": round(speed),
        **more,
        "judged": judged,
    }
    text = f"{samples} samples in {seconds:.1f} s ({speed:.0f} a second)\n{in_words(judged, name)}"
    if hasattr(a, "out"):
        result["out"] = str(a.out)
        text += f"\nwrote {a.out}"
    show(a.json, result, text)
