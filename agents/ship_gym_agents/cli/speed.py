"""``ship-gym speed``."""

from __future__ import annotations

import click

from ship_gym_agents.cli.options import Several, environment, verb
from ship_gym_agents.cli.values import whole


@verb(
    "            # about a minute, compiles once from nothing",
    "--quick     # seconds; less steady, no compilation",
    "--ship my_ship.toml --scenario heading_calm --quick",
    "--json > runs/speed.json",
)
@environment("heading_keeping, kcs, rudder")
@click.option("--quick", is_flag=True, help="Short repeats, no compilation time.")
@click.option(
    "--against",
    metavar="FOLDER",
    help="Only compare with another checkout of this project: both measured in turns.",
)
@click.option("--n", type=whole(1, 10**6), default=4096, help="Ships, with --against.")
@click.option(
    "--only", cls=Several, help='With --against: some of what is measured, such as calm "waves".'
)
def command(as_json, quick, against, n, only, task, **options) -> None:
    """Measure how fast physics and environments step, beside Gymnasium's CartPole."""
    if against is not None:
        compare(as_json, quick, against, n, options["ship"] or "kcs", only)
        return
    from ship_gym.reports import speed
    from ship_gym_agents.cli.output import progress, show
    from ship_gym_agents.cli.sailing import own_task, resolved, wanted

    name = own_task(task)
    env = wanted(options, name)
    resolved(env, name)
    repeats, seconds = (2, 0.03) if quick else (7, 0.4)
    jobs = list(speed.jobs(**env))
    steps = [speed.measure(job, repeats, seconds) for job in progress(jobs, "measuring")]
    n, repeats = (64, 3) if quick else (4096, 30)
    scenarios = [env.pop("scenario")] if "scenario" in env else speed.COMPARED
    overhead = [speed.overhead(scenario, n, repeats, **env) for scenario in scenarios]
    start = speed.start_times(cold=not quick)
    data = {"machine": speed.machine(), "steps": steps, "overhead": overhead, "start": start}
    show(as_json, data, speed.as_text(data))


def compare(
    as_json: bool, quick: bool, other: str, n: int, ship: str, only: tuple[str, ...]
) -> None:
    """Both checkouts in turns."""
    from ship_gym.reports import speed_against
    from ship_gym_agents.cli.output import progress, show

    folder = speed_against.check_checkout(other)
    rounds, seconds = (2, 0.05) if quick else (5, 0.2)
    data = speed_against.against(
        folder,
        only,
        n=n,
        ship=ship,
        rounds=rounds,
        seconds=seconds,
        start=not quick,
        progress=progress,
    )
    show(as_json, data, speed_against.as_text(data))
