"""Record one episode as a rerun file, read it back and compute its metrics from the file."""

from __future__ import annotations

from pathlib import Path

from _cli import need, parser, progress, run, show
from ship_gym_agents import make_controller, trained_for

from ship_gym.evaluation import metrics, metrics_of, rollout
from ship_gym.evaluation.rollout import EVALUATION_SEED
from ship_gym.recording import Trajectory
from ship_gym.text import table

EXAMPLES = (
    "python scripts/record.py --policy runs/quickstart",
    "python scripts/record.py --controller pid --ship kvlcc2 --seed 2000007 --out runs/pid.rrd",
)


def arguments():
    p = parser(__doc__, EXAMPLES)
    who = p.add_mutually_exclusive_group()
    who.add_argument("--policy", help="folder or file of a trained policy")
    who.add_argument("--controller", default="pid", help="pid (default), los_pid, ilos or constant")
    p.add_argument(
        "--scenario", help="name or TOML file (default: the policy's, else heading_keeping)"
    )
    p.add_argument("--ship", help="name or ship file (default: the policy's, else the scenario's)")
    p.add_argument("--control", help="rudder or rudder+rpm (default: the policy's, else rudder)")
    p.add_argument("--seed", type=int, default=EVALUATION_SEED, help=f"default {EVALUATION_SEED}")
    p.add_argument("--out", type=Path, default=Path("runs/rollout.rrd"), help="file to write")
    return p.parse_args()


def main() -> None:
    args = arguments()
    need("rerun")
    controller = make_controller(args.policy or args.controller)
    given = {k: getattr(args, k) for k in ("scenario", "ship", "control")}
    env = {**trained_for(controller), **{k: v for k, v in given.items() if v is not None}}
    sailed = rollout(controller, seeds=[args.seed], progress=progress, **env).trajectory(0)
    sailed.to_rrd(args.out)
    found = metrics(Trajectory.from_rrd(args.out))
    if found != metrics(sailed):
        raise OSError(f"{args.out}: the metrics of the file are not those of the episode")
    units = metrics_of(sailed.meta["task"])
    rows = [[name, units[name].unit, f"{value:.5g}"] for name, value in found.items()]
    shown = table(["metric", "unit", controller.name], rows, None)
    text = f"seed {args.seed}, metrics computed from {args.out}\n{shown}\n\n"
    text += f"wrote {args.out}\nnext: rerun {args.out}"
    data = {"controller": controller.name, "seed": args.seed, "metrics": found}
    show(args.json, {**data, "file": str(args.out)}, text)


if __name__ == "__main__":
    run(main)
