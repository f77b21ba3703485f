"""``ship-gym warm-up``."""

from __future__ import annotations

import time

import click

from ship_gym_agents.cli.options import Several, jobs, verb
from ship_gym_agents.cli.values import Name


@verb(
    "                                     # all ships and tasks; some minutes once",
    "--ship kcs --task heading_keeping",
    "--ship my_ship.toml --jobs 4 --json",
    "--mixed                              # also for randomised ships",
)
@click.option(
    "--ship", "ships", cls=Several, type=Name("ships"), help="Names or ship files; default: all."
)
@click.option("--task", "tasks", cls=Several, type=Name("tasks"), help="Tasks; default: all.")
@click.option("--mixed", is_flag=True, help="Also for ships that differ: randomised, drills.")
@jobs()
def command(as_json, ships, tasks, mixed, jobs) -> None:
    """Compile beforehand what ships and tasks need, so that nobody waits later.

    The machine code serves one ship and many, any water, and every process of this user on this
    machine; another version of Ship Gym or numba needs its own.
    """
    from ship_gym.reports import warm_up
    from ship_gym_agents.cli.output import progress, show

    start = time.perf_counter()
    todo = warm_up.jobs_of(ships, tasks, mixed)
    running = warm_up.run(todo, jobs)
    done = list(progress(running, "compiling", len(todo)))
    done.sort(key=lambda one: todo.index(one.job))
    wall = time.perf_counter() - start
    text = warm_up.as_text(done, wall) + "\nnext: ship-gym train --minutes 2"
    show(as_json, warm_up.as_data(done, wall), text)
