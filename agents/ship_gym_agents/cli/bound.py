"""``ship-gym bound``."""

from __future__ import annotations

from typing import Any

import click

from ship_gym_agents.cli.options import Several, environment, force, out, verb
from ship_gym_agents.cli.values import Name, Number, whole


@verb(
    "--scenario heading_ss6_quartering --ship kvlcc2 --seeds 32",
    "--scenario track_current --seeds 8 --lambdas 0.1 1 8 --json",
    notes="""
A controller steers; corrections of its rudder, given every 0.7 ship lengths (tracks: every one),
are optimised by Gauss-Newton through the simulator, which knows the sea to come. The smallest of
several starts is an estimate of what no controller can pass, not a bound.""",
)
@environment("heading_keeping, kcs, rudder")
@click.option("--seeds", type=whole(1, 10_000), default=32, help="Number of evaluation seeds.")
@click.option("--measure", help="Metric to minimise; default: the one that the task is scored by.")
@click.option(
    "--controller",
    "--controllers",
    "controllers",
    cls=Several,
    type=Name("controllers"),
    help="Start from these, the reference first; default: the autopilots of the task.",
)
@click.option("--iterations", type=whole(1, 1000), default=8, help="From each start, at most.")
@click.option(
    "--lambdas",
    cls=Several,
    type=Number(0.0, 1e6),
    help="Instead: the front of error against wear, one optimum for each weight of the rudder.",
)
@out(".json", "Results; default: runs/bound.json.")
@force()
def command(as_json, task, seeds, measure, controllers, iterations, lambdas, out, force, **options):
    """Estimate the best that control can reach: optimised plans with full knowledge.

    Intervals: 95 % bootstrap over the episodes.
    """
    from ship_gym.evaluation import evaluation_seeds
    from ship_gym.locks import held
    from ship_gym_agents.cli.output import place, progress, show
    from ship_gym_agents.cli.replace import Named, bound
    from ship_gym_agents.cli.sailing import own_task, resolved, wanted

    named, out = Named(out, force), place(out, "runs/bound.json")
    name = own_task(task)
    env = wanted(options, name)
    scenario = resolved(env, name)
    made = _controllers(scenario, controllers)
    asked = _asked(scenario, made, evaluation_seeds(seeds), measure, iterations, lambdas)
    named.check(bound(asked))
    how = {"seeds": evaluation_seeds(seeds), "iterations": iterations, **env}
    how |= {"progress": lambda steps, text: progress(steps, text, iterations)}
    with held(out, "works on this file"):
        found = _front(made, measure, lambdas, how) if lambdas else _best(made, measure, how)
        text = found.pop("text")
        found["bound"] = asked
        _write(found, out)
    show(as_json, {**found, "file": str(out)}, f"{text}\n\nwrote {out}")


def _controllers(scenario: Any, named: Any) -> list:
    """Controllers to start from, refused before any work."""
    from ship_gym.ships.loader import load_ship
    from ship_gym.tasks import TASKS
    from ship_gym_agents.controllers import make_controller

    made = [make_controller(name) for name in named or TASKS[scenario.task].controllers]
    ship = load_ship(scenario.ship, surrogate=scenario.surrogate)
    for controller in made:
        controller.reset(1, ship, scenario)
    return made


def _asked(scenario, controllers, seeds, measure, iterations, lambdas) -> dict[str, Any]:
    """What was asked for, as plain values: by it the file is known."""
    from ship_gym.ships.loader import load_ship
    from ship_gym.tasks import TASKS

    return {
        "scenario": scenario.to_dict(),
        "ship": load_ship(scenario.ship, surrogate=scenario.surrogate).name,
        "seeds": list(seeds),
        "measure": measure or TASKS[scenario.task].headline,
        "controllers": [controller.name for controller in controllers],
        "iterations": iterations,
        "lambdas": list(lambdas),
    }


def _best(controllers: list, measure: str | None, how: dict[str, Any]) -> dict[str, Any]:
    """The optimum beside the reference, and what was found from each start."""
    from ship_gym.evaluation import compare, rollout, table
    from ship_gym.evaluation.bound import optimum
    from ship_gym.evaluation.headroom import relative, values_of

    found = optimum(controllers, measure=measure, **how)
    env = {k: v for k, v in how.items() if k not in ("iterations", "progress")}
    reference = rollout(controllers[0], **env)
    values = [values_of(one, found.measure) for one in (found.rollout, reference)]
    headroom = relative(*values)
    compared = compare([reference, found.rollout])
    from_starts = {name: float(cost.mean()) for name, cost in found.costs.items()}
    chosen = {name: found.starts.count(name) for name in dict.fromkeys(found.starts)}
    text = (
        f"{reference.ship.name}, {len(reference)} episodes, interquartile mean [95 % interval]\n"
        f"{table(compared)}\n\nestimate of the bound of {found.measure}: "
        f"{headroom.value:.1f} % {_interval(headroom)}below {reference.controller}; best from "
        + ", ".join(f"{name} in {count}" for name, count in chosen.items())
    )
    return {
        "measure": found.measure,
        "headroom_percent": vars(headroom),
        "mean_cost": from_starts,
        "chosen": chosen,
        **compared,
        "text": text,
    }


def _interval(found: Any) -> str:
    return "" if found.low is None else f"[{found.low:.1f}, {found.high:.1f}] "


def _front(controllers, measure, lambdas, how: dict[str, Any]) -> dict[str, Any]:
    """Metrics of the optima of several weights."""
    from ship_gym.evaluation.bound import front
    from ship_gym.text import table

    points = front(controllers, lambdas, measure=measure, **how)
    names = list(points[0])
    rows = [[f"{point[name]:.4g}" for name in names] for point in points]
    text = f"optima of {len(how['seeds'])} episodes, interquartile means\n{table(names, rows, 0)}"
    return {"front": points, "seeds": list(how["seeds"]), "text": text}


def _write(found: dict[str, Any], path: Any) -> None:
    import json

    from ship_gym.writing import atomic_path

    with atomic_path(path) as temporary:
        temporary.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
