"""The console command ``ship-gym``: one module for each verb, loaded when it is called.

No module here imports more than click at its top: ``ship_gym``, NumPy and the rest come in where
a verb begins to work, so that ``--help`` and completion answer at once.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path

import click

from ship_gym_agents.cli.groups import Verbs
from ship_gym_agents.cli.output import run

# verb -> one line of help; the verb fit-surrogate is `command` of the module fit_surrogate
VERBS = {
    "train": "Train a policy: validated on separate seas, best one kept, can be resumed.",
    "evaluate": "Sail controllers on the same evaluation episodes; print their metrics.",
    "benchmark": "Sail suites of scenarios with several ships and controllers; score them.",
    "report": "Write the page of a benchmark from its results, a file or the folder of a run.",
    "bound": "Estimate the best that control can reach: optimised plans with full knowledge.",
    "record": "Record episodes as rerun or CSV files, read them back and compute their metrics.",
    "dataset": "Write a Minari data set of controllers for offline learning, with a card.",
    "review": "Find, show, draw, compare, export and measure recordings.",
    "route": "Show a route of an ECDIS or a plotter: legs, turns, limits; write it anew.",
    "export": "Write a policy as ONNX for other programs, or as safetensors from older files.",
    "fmu": "Write a ship in a sea as FMU (FMI 2.0 or 3.0) for co-simulation.",
    "simulate": "Sail a standard manoeuvre or all trials of a ship.",
    "serve": "Sail a ship on NMEA 0183 over TCP and UDP, steered by another autopilot.",
    "trials": "Sail every trial of every ship and compare, with the scatter of the facilities.",
    "linearise": "Linearise a ship on a straight course: derivatives, Nomoto's K and T, stability.",
    "tune": "Tune controllers for ships on seeds kept for tuning; say what it gained.",
    "tune-agent": "Search for hyperparameters of training with Optuna; write best.toml for train.",
    "fit-surrogate": "Fit a propeller and rudder surrogate to CFD points.",
    "fit-hull": "Fit a ship's hull derivatives to captive tests; write the fitted ship.",
    "draw": "Draw what papers draw of surrogates and of the forces in a turn.",
    "build-wave-table": "Compute a ship's wave table by boundary elements.",
    "speed": "Measure how fast physics, environments and training run, beside CartPole and peers.",
    "warm-up": "Compile beforehand what ships and tasks need, so that nobody waits later.",
    "new-ship": "Write the file of a ship of your own from her particulars.",
    "list": "List what can be named: ships, scenarios, tasks, controllers, recipes, surrogates.",
    "completion": "Print the script that completes ship-gym in a shell.",
}
PROGRAM = "ship-gym"


def load_verb(verb: str) -> click.Command:
    """The click command of a verb."""
    name = "listing" if verb == "list" else verb.replace("-", "_")  # list is a word of Python
    return importlib.import_module(f"ship_gym_agents.cli.{name}").command


def _version(ctx: click.Context, param: click.Parameter, wanted: bool) -> None:
    if wanted and not ctx.resilient_parsing:
        click.echo(f"{PROGRAM} {metadata.version(PROGRAM)}")
        ctx.exit()


@click.group(
    cls=Verbs,
    verbs=VERBS,
    load=load_verb,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="Each verb has --help with examples, and --json.",
)
@click.option("--version", is_flag=True, is_eager=True, expose_value=False, callback=_version)
@click.pass_context
def ship_gym(ctx: click.Context) -> None:
    """Train, judge, record and simulate ship autopilots."""
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())


def main(arguments: Sequence[str] | None = None) -> None:
    """Run ``ship-gym``; an error that a user can mend is one line on stderr and exit code 2."""
    run(lambda: ship_gym.main(arguments, PROGRAM, standalone_mode=False))


def run_script(verb: str) -> None:
    """Run one verb as the script that was started, as ``scripts/train.py`` does."""
    name = f"python scripts/{Path(sys.argv[0]).name}"
    run(lambda: load_verb(verb).main(prog_name=name, standalone_mode=False))
