"""``ship-gym record``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import click

from ship_gym_agents.cli.options import Several, environment, force, seed, verb
from ship_gym_agents.cli.record_out import OutRecordings, Places
from ship_gym_agents.cli.record_pick import OF, Pick
from ship_gym_agents.cli.record_tables import tables
from ship_gym_agents.cli.seeds import MOST, seeds_of
from ship_gym_agents.cli.values import Name, whole


@verb(
    "--policy runs/quickstart",
    "--controller pid adaptive --ship kvlcc2 --seeds 2000000..2000007 --out runs/heading",
    "--controller pid --worst 5 --by J_1 --of 128 --out runs/worst",
)
@click.option(
    "--policy",
    "--controller",
    "--controllers",
    "named",
    cls=Several,
    type=Name("controllers"),
    default=["pid"],
    help="Names, policies, gains or your own FILE.py:NAME; several: files for each.",
)
@environment("those of the first policy, else heading_keeping, kcs, rudder")
@seed("Of the episode; default: the first of an evaluation.", default=None, largest=2**63 - 1)
@click.option(
    "--seeds",
    cls=Several,
    callback=seeds_of,
    metavar="N|FIRST..LAST|SEED...",
    help="Several episodes: so many of an evaluation, a range with both ends, or a list.",
)
@click.option(
    "--worst", type=whole(1, MOST), help="Sail them all, keep so many of the worst; failed first."
)
@click.option("--best", type=whole(1, MOST), help="The same for the best.")
@click.option("--median", is_flag=True, help="The same for the one in the middle.")
@click.option("--by", metavar="METRIC", help="What decides; default: the headline of the task.")
@click.option(
    "--of",
    type=whole(1, 10**6),
    help=f"Evaluation episodes to choose from; default: {OF}, or those of --seeds.",
)
@click.option(
    "--out",
    type=OutRecordings(),
    help="One: the file; default: runs/rollout.rrd. Several: their folder, or a file to whose "
    "name -CONTROLLER-SEED is added; default: runs/recordings.",
)
@force()
def command(
    as_json, named, task, seed, seeds, worst, best, median, by, of, out, force, **options
) -> None:
    """Record episodes as rerun or CSV files, read them back and compute their metrics.

    Rows go to disk while a ship sails: of a recording that is killed FILE.rrd.partial stays, and
    holds all but its last seconds.
    """
    from ship_gym_agents.cli.output import need, show

    pick = Pick(worst or 0, best or 0, median, by)
    seeds = pick.seeds(seed, seeds, of)
    each = min(pick.most, len(seeds)) if pick.most else len(seeds)
    places = Places(out, len(named) * each > 1)
    if places.suffix == ".rrd":
        need("rerun")
    force = force or out is None
    found, why = _record(named, task, seeds, pick, places, options, force)
    show(as_json, *_told(found, why, places, task))


class _Plan(NamedTuple):
    """What is sailed, what of it is kept, and where."""

    seeds: Sequence[int]
    pick: Pick
    places: Places
    env: dict[str, Any]


def _record(
    named: Sequence[str],
    task: str | None,
    seeds: Sequence[int],
    pick: Pick,
    places: Places,
    options,
    force: bool,
) -> tuple[list, list[dict]]:
    """Recordings, and why each was kept; all is refused before the first ship sails.

    With `force` the files may hold anything.
    """
    from ship_gym.config import ConfigError
    from ship_gym.evaluation.recordings import check_told_apart
    from ship_gym.evaluation.rollout import begin
    from ship_gym_agents.cli.replace import check_recordings
    from ship_gym_agents.cli.sailing import known_to, own_task, ready, resolved, wanted
    from ship_gym_agents.entrants import controllers_of

    name = own_task(task)
    controllers = controllers_of(named)
    names = [controller.name for controller in controllers]
    check_told_apart(names)
    env = wanted(options, name, known_to(named)[1])
    scenario = resolved(env, name)
    any_seed = [None] if pick.most and not places.many else seeds  # which one is kept is not known
    check_recordings(places.of, names, any_seed, scenario.to_dict(), force)
    sailed_task = scenario.task
    ready(controllers, begin(seeds[:1], **env), seeds)
    plan = _Plan(seeds, pick, places, env)
    if not pick.most:
        found = [one for each in controllers for one in _all(each, plan)]
        return found, [{} for _ in found]
    by, metrics = pick.metric(sailed_task)
    kept = [one for each in controllers for one in _some(each, plan, by, metrics)]
    if not kept:
        raise ConfigError(f"--by {by}: none of the {len(seeds)} episodes has a value of it")
    return [one for one, _ in kept], [why for _, why in kept]


def _all(controller: Any, plan: _Plan) -> list:
    from ship_gym.evaluation.recordings import sail
    from ship_gym.recording.journal import journal_path

    files = [plan.places.of(controller.name, seed) for seed in plan.seeds]
    try:
        return sail(controller, plan.seeds, files, progress=_bar(controller), **plan.env)
    except KeyboardInterrupt:
        left = [str(path) for path in map(journal_path, files) if path.exists()]
        where = f": the rows so far are in {', '.join(left)}" if left else ""
        raise KeyboardInterrupt(f"interrupted{where}") from None


def _some(
    controller: Any, plan: _Plan, by: str, metrics: Mapping[str, Any]
) -> list[tuple[Any, dict]]:
    """Sail all in one batch, keep some: recordings, what each of them is and by which metric.

    Where no episode has a value of the headline, since all are too short, the return decides.
    """
    from ship_gym.evaluation import rollout
    from ship_gym.evaluation.choice import deciding
    from ship_gym.evaluation.comparison import per_episode
    from ship_gym.evaluation.recordings import keep
    from ship_gym_agents.cli.output import progress

    sailed = rollout(controller, seeds=plan.seeds, progress=_bar(controller), **plan.env)
    values = per_episode(sailed)
    by = by if plan.pick.by else deciding(by, values)
    chosen = plan.pick.chosen(values[by], metrics[by].better, sailed.failed.tolist())
    found = []
    for i, which in progress(chosen.items(), "writing"):
        file = plan.places.of(controller.name, plan.seeds[i])
        found.append((keep(sailed.trajectory(i), file), {"which": which, "by": by}))
    return found


def _bar(controller: Any) -> Any:
    from ship_gym_agents.cli.output import progress

    return lambda steps: progress(steps, controller.name)


def _told(found: Sequence, why: Sequence[dict], places: Places, task: str | None) -> tuple:
    """The result for JSON and for people."""
    from ship_gym_agents.cli.review.files import next_review

    recordings = [one.plain() | more for one, more in zip(found, why, strict=True)]
    data = recordings[0] if len(found) == 1 else {"recordings": recordings}
    where = str(found[0].file) if len(found) == 1 else f"{len(found)} files in {places.folder}"
    text = f"{tables(found, why)}\n\nwrote {where}"
    if places.suffix != ".rrd":
        return data, text
    if len(found) == 1:
        following = next_review("show", found[0].file)
    else:
        following = next_review("list", places.folder, *(["--task", task] if task else []))
    return data | {"next": following}, f"{text}\nnext: {following}"
