"""docs/policies.md: what the shipped policies do, from the judgement of their claims."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ship_gym_agents import make_controller

from pages.judgement import FAILURES, Sailor
from ship_gym.evaluation import metrics_of, rollout
from ship_gym.plotting.benchmark import styles
from ship_gym.plotting.benchmark_episode import plot_episode
from ship_gym.scenarios.scenario import load_scenario
from ship_gym.text import signed_interval, table
from ship_gym.writing import atomic_path

_HEAD = """<!-- Written by scripts/judge_policies.py --page; run it again instead of editing. -->

# Shipped policies, and what they are worth

Each policy is the median of its training seeds by the validation score; its card, which names the
command that made it, is in its file: `ship-gym evaluate --policy NAME`. They were judged on
{n} episodes of the split `{split}` (seeds from {first}), which nothing else uses, with claims that
were written down before: `scripts/policy_claims.toml`. The opponent is the classical controller
that was best on other seeds. Differences are paired, seed by seed: interquartile means of them,
which a few lost episodes do not decide, and beside them the differences of the means. p-values are
those of the sign-flip test, corrected by Holm over the {tests} tests of this page. A policy that
fails in more than {failures} episode more than its opponent does not hold its claim either. A claim
that does not hold stands here like one that does."""
_SHOWN = ("success", "rudder_travel", "rudder_reversals")


def write_page(judged: Sequence[Mapping[str, Any]], sailor: Sailor, split: str, path: Path):
    """Write the page and its pictures; the files written."""
    tests = sum(len(claim["tests"]) for claim in judged)
    head = _HEAD.format(
        n=len(sailor.seeds), split=split, first=sailor.seeds.start, tests=tests, failures=FAILURES
    )
    parts, files = [head, _summary(judged)], []
    folder = path.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    for claim in judged:
        pictures = _pictures(claim, folder)
        files += pictures
        parts.append(_section(claim, [p.relative_to(path.parent).as_posix() for p in pictures]))
    with atomic_path(path) as temporary:
        temporary.write_text("\n\n".join(parts) + "\n", encoding="utf-8")
    return [path, *files]


def _summary(judged: Sequence[Mapping[str, Any]]) -> str:
    rows = []
    for claim in judged:
        held = sum(test["holds"] for test in claim["tests"])
        rows.append(
            [
                f"[{claim['name']}](#{claim['name'].replace('_', '-')})",
                f"`{claim['policy']}`",
                f"`{claim['scenario']}`",
                claim["ship"],
                f"{held} of {len(claim['tests'])}" if claim["tests"] else "by points of the score",
                "holds" if claim["holds"] else "**does not hold**",
            ]
        )
    header = ["claim", "policy", "scenario", "ship", "tests that hold", "claim"]
    return table(header, rows, markdown=True)


def _section(claim: Mapping[str, Any], pictures: Sequence[str]) -> str:
    units = metrics_of(load_scenario(claim["scenario"]).task)
    names = dict.fromkeys((claim["measure"], *(t["measure"] for t in claim["tests"]), *_SHOWN))
    parts = [
        f"## {claim['name'].replace('_', '-')}",
        f"`{claim['policy']}` in `{claim['scenario']}` with {claim['ship']}; interquartile means "
        "with 95 % intervals:",
        _levels(claim["levels"], names, units, claim["score"]),
        "Failed episodes: "
        + ", ".join(f"`{name}` {n}" for name, n in claim["failures"].items())
        + ".",
    ]
    if claim["tests"]:
        parts += ["Paired differences, policy minus opponent:", _tests(claim["tests"], units)]
    if claim["points"]:
        parts.append(
            f"Claimed: a score not more than {claim['points']:g} points below the best of them, "
            f"which {'holds' if claim['holds'] else '**does not hold**'}."
        )
    if claim["seed_spread"]:
        spread = {f"seed {k}": one for k, one in enumerate(claim["seed_spread"])}
        parts += ["The training seeds, of which the median is shipped:"]
        parts += [_levels(spread, names, units)]
    for scenario, levels in claim["shown_levels"].items():
        parts += [f"As it is, in `{scenario}`:", _levels(levels, names, units)]
    extremes = claim["extremes"].items()
    header = [f"{which} of its episodes, seed {seed}" for which, seed in extremes]
    cells = [f"![{which}]({picture})" for picture, which in zip(pictures, header, strict=True)]
    parts.append(table(header, [cells], markdown=True))
    if claim["seen"]:
        parts.append(claim["seen"])
    if claim["skip"]:
        parts.append(
            f"On the next seeds of the split: an earlier policy of this name was judged on the "
            f"first {claim['skip']}."
        )
    return "\n\n".join(parts)


def _levels(levels, names, units, scores=None) -> str:
    header = ["controller", *(f"{name} [{units[name].unit}]" for name in names)]
    rows = [
        [f"`{who}`", *(_cell(found.get(name)) for name in names)] for who, found in levels.items()
    ]
    if scores:
        header.append("score")
        for row, who in zip(rows, levels, strict=True):
            row.append("-" if scores[who] is None else f"{scores[who]:.0f}")
    return table(header, rows, markdown=True)


def _tests(tests: Sequence[Mapping[str, Any]], units) -> str:
    asked = {"lower": "lower", "not higher": "mean not higher", "within": "within"}
    rows = [
        [
            f"{test['measure']} [{units[test['measure']].unit}]",
            f"`{test['opponent']}`",
            asked[test["kind"]] + (f" {test['limit']:.3g}" if test["kind"] == "within" else ""),
            _difference(test),
            _difference(test["mean"]),
            f"{100.0 * test['value'] / test['theirs']:+.1f} %" if test["theirs"] else "-",
            f"{test['p_holm']:.3f}",
            "holds" if test["holds"] else "**does not hold**",
        ]
        for test in tests
    ]
    header = [
        "measure",
        "against",
        "asked",
        "difference",
        "of the means",
        "relative",
        "p (Holm)",
        "verdict",
    ]
    return table(header, rows, markdown=True)


def _difference(found: Mapping[str, float]) -> str:
    return signed_interval(found["value"], found["low"], found["high"])


def _cell(found: Mapping[str, float | None] | None) -> str:
    if found is None:
        return "-"
    if found["low"] is None or found["low"] == found["high"]:
        return f"{found['value']:.4g}"
    return f"{found['value']:.4g} [{found['low']:.3g}, {found['high']:.3g}]"


def _pictures(claim: Mapping[str, Any], folder: Path) -> list[Path]:
    """Best, median and worst episode beside the opponent on the same seed."""
    opponents = [test["opponent"] for test in claim["tests"]] or claim["against"]
    names = dict.fromkeys((claim["policy"], *opponents))
    names = list(names)[:2]
    env = {"ship": claim["ship"], "control": claim["control"]}
    files = []
    for which, seed in claim["extremes"].items():
        sailed = {
            name: rollout(make_controller(name), claim["scenario"], seeds=[seed], **env).trajectory(
                0
            )
            for name in names
        }
        files.append(folder / f"{claim['name']}_{which}.png")
        plot_episode(sailed, styles(names), files[-1], f"{claim['name']}: {which}, seed {seed}")
    return files
