"""``ship-gym dataset``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import click

from ship_gym_agents.cli.options import Several, environment, force, seed, verb
from ship_gym_agents.cli.values import Name, Number, OutFolder, whole


@verb(
    "",
    "--controllers pid lqg heading_kcs random --noise 0 0.1 --episodes 50",
    "--task track_following --controllers drift_los --ship kvlcc2 --noise 0.05 --noise-time 30",
    "--policy runs/heading --out ~/.minari/datasets --name me/heading-v0",
    notes="The card (README.md, card.json) and the conventions: docs/datasets.md.",
)
@click.option(
    "--controller",
    "--controllers",
    "--policy",
    "controllers",
    cls=Several,
    type=Name("controllers"),
    help="Who sails: names, policies, gains, your own FILE.py:NAME, or random; several; default: "
    "the usual autopilot of the task.",
)
@click.option(
    "--noise",
    cls=Several,
    type=Number(0.0, 2.0),
    help="Standard deviations of noise on the actions, which are in [-1, 1]; several; each "
    "controller sails with each; default: 0.",
)
@click.option(
    "--noise-time",
    type=Number(0.0, 3600.0, "s"),
    default=10.0,
    help="Correlation time of the noise [full-scale s]; 0: white.",
)
@environment("those of the first policy, else heading_keeping, kcs, rudder")
@click.option(
    "--episodes",
    type=whole(1, 100_000),
    default=100,
    help="Episodes of each controller with each noise.",
)
@seed("Seed of the first episode; the others follow.")
@click.option(
    "--expert",
    type=Name("controllers"),
    help="Whose mean return is the normalised score 1; default: the usual autopilot of the task.",
)
@click.option("--no-infos", is_flag=True, help="Keep no infos: smaller.")
@click.option("--name", help="Id of the data set, such as me/heading-v0; default: says what is in.")
@click.option(
    "--out",
    type=OutFolder(),
    help="Folder of all data sets; default: MINARI_DATASETS_PATH, or runs/datasets.",
)
@click.option("--author", default="Ship Gym", help="Who made it.")
@click.option("--email", help="Of the author.")
@click.option("--license", default="Apache-2.0", help="Of the data.")
@force()
def command(
    as_json, controllers, task, name, out, no_infos, author, email, license, force, **given
):
    """Write a Minari data set of controllers for offline learning, with a card.

    Episodes sail in batches; the set appears when it is whole, and none is replaced unasked.
    """
    from ship_gym_agents.cli.output import need, progress, show

    need("minari")
    from ship_gym_agents.cli.sailing import own_task, resolved
    from ship_gym_agents.datasets import Plan, write_set

    if "" in controllers:
        raise click.UsageError("--controllers: nothing to sail; name at least one")
    own = {key: given.pop(key) for key in ("noise_time", "episodes", "seed", "expert")}
    noise = tuple(given.pop("noise")) or (0.0,)
    task = own_task(task)
    env = _env(given, task, controllers)
    resolved(env, task)
    plan = Plan(tuple(controllers), noise, env=env, infos=not no_infos, **own)
    about = {"author": author, "email": email, "license": license}
    made = write_set(plan, out, name, **about, force=force, progress=progress)
    following = f'python -c "{_python(made)}"'
    data = {"name": made.name, "folder": str(made.path), "card": made.card, "next": following}
    show(as_json, data, f"{_text(made.card)}\n\nwrote {made.path}\nnext: {following}")


def _env(options: Mapping[str, Any], task: str | None, controllers: tuple[str, ...]) -> dict:
    """Arguments of an environment: those of the first policy unless options say otherwise."""
    from ship_gym_agents.cli.sailing import known_to, wanted
    from ship_gym_agents.datasets import RANDOM

    return wanted(options, task, known_to([one for one in controllers if one != RANDOM])[1])


def _python(made: Any) -> str:
    return (
        "from ship_gym_agents.datasets import load_set; "
        f"print(load_set({made.name!r}, {str(made.folder)!r})[0])"
    )


def _text(card: Mapping[str, Any]) -> str:
    from ship_gym.text import table
    from ship_gym_agents.datasets.card import HEADER, cells, scores_in_words

    return (
        f"{card['dataset_id']}: {card['steps']} steps, {card['episodes']} episodes, ship "
        f"{card['ship']}\n{table(HEADER, [cells(row) for row in card['entries']])}\n"
        f"{scores_in_words(card)}"
    )
