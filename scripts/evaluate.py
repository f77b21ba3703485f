"""Sail controllers on the same evaluation episodes; print their metrics side by side."""

from __future__ import annotations

import json
from pathlib import Path

from _cli import parser, progress, run, show
from ship_gym_agents import make_controller, trained_for

from ship_gym.evaluation import compare, evaluation_seeds, rollout, table
from ship_gym.evaluation.rollout import begin
from ship_gym.provenance import atomic_path

EXAMPLES = (
    "python scripts/evaluate.py --policy runs/quickstart",
    "python scripts/evaluate.py --ship kvlcc2 --episodes 128 --markdown",
)


def arguments():
    p = parser(f"{__doc__} Intervals: 95 % bootstrap over the episodes.", EXAMPLES)
    p.add_argument("--policy", help="folder or file of a trained policy")
    p.add_argument(
        "--controllers", nargs="*", help="sail these too (default: pid constant, or ilos los_pid)"
    )
    p.add_argument(
        "--scenario", help="name or TOML file (default: the policy's, else heading_keeping)"
    )
    p.add_argument("--ship", help="name or ship file (default: the policy's, else the scenario's)")
    p.add_argument("--control", help="rudder or rudder+rpm (default: the policy's, else rudder)")
    p.add_argument("--episodes", type=int, default=32, help="number of seeds (default 32)")
    p.add_argument(
        "--out", type=Path, help="JSON (default: evaluation.json, in runs or the policy)"
    )
    p.add_argument("--markdown", action="store_true", help="print the tables for a README")
    return p.parse_args()


def sail(policy: str | None, others: list[str] | None, seeds: list[int], **env) -> list:
    """One rollout for each controller, all of them refused before the first one sails."""
    controllers = [make_controller(policy)] if policy else []
    known = trained_for(controllers[0]) if policy else {}
    env = {**known, **{k: v for k, v in env.items() if v is not None}}
    start = begin(seeds[:1], **env)
    if others is None:
        others = start.task.controllers
    controllers += [make_controller(name) for name in others]
    for controller in controllers:
        controller.reset(1, start.ship, start.scenario)
    return [
        rollout(c, seeds=seeds, progress=lambda steps, c=c: progress(steps, c.name), **env)
        for c in controllers
    ]


def main() -> None:
    args = arguments()
    seeds = evaluation_seeds(args.episodes)
    env = {"scenario": args.scenario, "ship": args.ship, "control": args.control}
    rollouts = sail(args.policy, args.controllers, seeds, **env)
    sailed = [r.controller for r in rollouts]
    found = compare(rollouts, next((name for name in ("pid", "ilos") if name in sailed), None))
    folder = Path(args.policy) if args.policy and Path(args.policy).is_dir() else Path("runs")
    out = args.out or folder / "evaluation.json"
    with atomic_path(out) as temporary:
        temporary.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    following = f"--policy {args.policy}" if args.policy else f"--controller {sailed[0]}"
    for option in ("scenario", "ship", "control"):
        value = getattr(args, option)
        following += f" --{option} {value}" if value else ""
    text = (
        f"{found['ship']}, {len(seeds)} episodes (seeds {seeds[0]} to {seeds[-1]}), interquartile "
        f"mean [95 % interval]; success: mean\n{table(found, args.markdown)}\n\n"
        f"wrote {out}\nnext: python scripts/record.py {following}"
    )
    show(args.json, {**found, "file": str(out)}, text)


if __name__ == "__main__":
    run(main)
