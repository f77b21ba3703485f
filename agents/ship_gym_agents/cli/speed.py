"""``ship-gym speed``."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import Several, environment, out, verb
from ship_gym_agents.cli.values import whole

# repeats, seconds of one, counts of the tables (steps, growth, waves), overhead n and repeats,
# environments of the memory's growth, rollouts of training
_DEPTH: dict[str, dict[str, Any]] = {
    "quick": {
        "best": (2, 0.02),
        "tables": {"counts": (1, 64), "growth": (1, 256, 1024), "waves": (0, 60)},
        "overhead": (64, 3),
        "memory": 256,
        "rollouts": 0,
    },
    "default": {
        "best": (3, 0.1),
        "tables": {},
        "overhead": (4096, 10),
        "memory": 4096,
        "rollouts": 10,
    },
    "full": {
        "best": (7, 0.4),
        "tables": {},
        "overhead": (4096, 30),
        "memory": 16384,
        "rollouts": 40,
    },
}


@verb(
    "            # some two minutes",
    "--training  # only training, beside stable-baselines3's own way",
    "--quick     # seconds; less steady, without training and start",
    "--full --plot docs/speed.png --page docs/speed.md",
    "--ship my_ship.toml --scenario heading_calm --quick",
    "--against ../other_checkout --only calm waves memory",
    "--json > runs/speed.json",
)
@environment("heading_keeping, kcs, rudder")
@click.option("--quick", is_flag=True, help="Short repeats, few sizes, no training, no start.")
@click.option("--full", is_flag=True, help="Long repeats, and compilation from nothing.")
@click.option("--training", is_flag=True, help="Only training; some 20 seconds.")
@out(".png", "Draw growth and peers into this file.", "--plot")
@out(".md", "Write the tables between the marks of this page.", "--page")
@click.option(
    "--against",
    metavar="FOLDER",
    help="Only compare with another checkout of this project: both measured in turns.",
)
@click.option("--n", type=whole(1, 10**6), default=4096, help="Ships, with --against.")
@click.option("--only", cls=Several, help="Of what --against measures, such as calm or memory.")
def command(as_json, quick, full, training, plot, page, against, n, only, task, **options) -> None:
    """Measure how fast physics, environments and training run, beside CartPole and peers."""
    from ship_gym_agents.cli.output import need, show

    if quick and full:
        raise click.UsageError("--quick and --full: give one of them")
    if training and (quick or page or plot or against):
        raise click.UsageError(
            "--training goes with none of --quick, --page, --plot and --against: leave it out"
        )
    if against is not None:
        compare(as_json, quick, against, n, options["ship"] or "kcs", only)
        return
    if only:
        raise click.UsageError("--only goes with --against")
    if plot is not None:
        need("matplotlib")
    from ship_gym.reports import speed
    from ship_gym.reports.speed_text import as_text

    if page is not None:
        speed.parts_of_page(page)  # refuses before the work
    data = measured("quick" if quick else "full" if full else "default", task, options, training)
    text = as_text(data)
    if page is not None:
        speed.write_into(page, text)
    if plot is not None:
        from ship_gym.plotting.speed import plot_speed

        plot_speed(data, plot)
    files = [str(path) for path in (plot, page) if path is not None]
    wrote = "".join(f"\nwrote {path}" for path in files)
    show(as_json, {**data, "files": files}, text + ("\n" if wrote else "") + wrote)


def measured(
    depth: str, task: str | None, options: dict[str, Any], training: bool = False
) -> dict[str, Any]:
    """Everything, or training alone, as ``reports.speed_text.as_text`` takes it."""
    from ship_gym.reports import speed, speed_against, speed_peers
    from ship_gym_agents.cli.output import progress
    from ship_gym_agents.cli.sailing import own_task, resolved, wanted

    how = _DEPTH[depth]
    name = own_task(task)
    env = wanted(options, name)
    resolved(env, name)
    if training:
        nothing = ("steps", "growth", "waves", "overhead", "memory", "peers", "start")
        found = _training(how["rollouts"], env)
        return {"machine": speed.machine(), **dict.fromkeys(nothing, ()), "training": found}
    jobs = list(speed.jobs(**how["tables"], **env))
    rows = [speed.measure(job, *how["best"]) for job in progress(jobs, "measuring")]
    by_table = {t: [r for r in rows if r["table"] == t] for t in ("steps", "growth", "waves")}
    scenarios = [env["scenario"]] if "scenario" in env else speed.COMPARED
    rest = {key: value for key, value in env.items() if key != "scenario"}
    return {
        "machine": speed.machine(),
        **by_table,
        "overhead": [
            speed.overhead(each, *how["overhead"], **rest)
            for each in progress(scenarios, "beside the physics")
        ],
        "memory": {} if task else speed_against.memory(how["memory"], **env),
        "peers": speed_peers.measure_peers(*how["best"]),
        "training": _training(how["rollouts"], env),
        "start": {} if depth == "quick" else speed_against.start_times(depth == "full"),
    }


def _training(rollouts: int, env: dict[str, Any]) -> dict[str, Any]:
    if not rollouts:
        return {}
    missing = [x for x in ("torch", "stable_baselines3") if find_spec(x) is None]
    if missing:
        return {"reason": f'{missing[0]} is not installed: pip install "ship-gym[rl]"'}
    from ship_gym_agents.cli.output import progress
    from ship_gym_agents.sb3.throughput import throughput

    return throughput(rollouts, progress=progress, **env)


def compare(
    as_json: bool, quick: bool, other: str, n: int, ship: str, only: tuple[str, ...]
) -> None:
    """Both checkouts in turns."""
    from ship_gym.reports import speed_against
    from ship_gym_agents.cli.output import progress, show

    folder = speed_against.check_checkout(Path(other))
    rounds, seconds = (6, 0.03) if quick else (14, 0.1)
    data = speed_against.against(
        folder, only, n=n, ship=ship, rounds=rounds, seconds=seconds, start=not quick,
        progress=progress,
    )  # fmt: skip
    show(as_json, data, speed_against.as_text(data))
