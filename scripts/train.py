"""Train a policy: validated on separate seas, best one kept, can be resumed."""

from __future__ import annotations

import sys

from _cli import parser, progress, run, show
from ship_gym_agents.sb3.budget import default_budget
from ship_gym_agents.sb3.config import config_for
from ship_gym_agents.sb3.summary import plan, summary

EXAMPLES = (
    "python scripts/train.py --ship kvlcc2 --steps 5000000 --seed 1 --out runs/kvlcc2",
    "python scripts/train.py --resume --minutes 10            # 10 minutes in all",
)


def main() -> None:
    args = parser(__doc__, EXAMPLES)
    args.add_argument("--scenario", help="name or TOML file (default heading_keeping)")
    args.add_argument("--ship", help="name or ship file (default: the scenario's, kcs)")
    args.add_argument("--control", help="rudder (default) or rudder+rpm")
    args.add_argument("--privileged", action="store_true", default=None, help="see sea and forces")
    args.add_argument("--algorithm", help="ppo (default), sac or td3")
    args.add_argument("--hyperparameters", help="TOML file (default: the package's own)")
    args.add_argument("--envs", type=int, help="environments (default: the hyperparameters')")
    args.add_argument("--seed", type=int, help="of network, exploration, episodes (default 0)")
    args.add_argument("--minutes", type=float, help="wall-clock time of the run (default 2)")
    args.add_argument("--steps", type=int, help="samples, instead of or beside --minutes")
    args.add_argument("--out", default="runs/heading", help="run folder (default runs/heading)")
    args.add_argument("--resume", action="store_true", help="continue the run in --out")
    args = vars(args.parse_args())
    from ship_gym_agents.sb3.train import train  # late: without the extra, one line of error

    as_json, out, resume = (args.pop(name) for name in ("json", "out", "resume"))
    budget = default_budget(args.pop("minutes"), args.pop("steps"))
    config = config_for(out, resume, {k: v for k, v in args.items() if v is not None})
    print(plan(config, out, **budget), file=sys.stderr)
    bar = progress(None, "training", total=1000)
    card = train(config, out, **budget, resume=resume, bar=bar)
    show(as_json, card, summary(card, out))


if __name__ == "__main__":
    run(main)
