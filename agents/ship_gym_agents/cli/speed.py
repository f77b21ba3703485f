"""``ship-gym speed``."""

from __future__ import annotations

import click

from ship_gym_agents.cli.options import verb


@verb(
    "            # about a minute, compiles once from nothing",
    "--quick     # seconds; less steady, no compilation",
    "--json > runs/speed.json",
)
@click.option("--quick", is_flag=True, help="Short repeats, no compilation time.")
def command(as_json, quick) -> None:
    """Measure how fast physics and environments step, beside Gymnasium's CartPole."""
    from ship_gym.reports import speed
    from ship_gym_agents.cli.output import progress, show

    repeats, seconds = (2, 0.03) if quick else (7, 0.4)
    jobs = list(speed.jobs())
    steps = [speed.measure(job, repeats, seconds) for job in progress(jobs, "measuring")]
    n, repeats = (64, 3) if quick else (4096, 30)
    overhead = [speed.overhead(name, n, repeats) for name in speed.COMPARED]
    start = speed.start_times(cold=not quick)
    data = {"machine": speed.machine(), "steps": steps, "overhead": overhead, "start": start}
    show(as_json, data, speed.as_text(data))
