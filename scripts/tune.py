"""Tune the PID's gains for one ship or all; see --help."""

from __future__ import annotations

import dataclasses

from _cli import parser, progress, run, show
from ship_gym_agents.tune import gains_file, is_tuned, settings, tune, write_gains

from ship_gym import available_ships
from ship_gym.config import ConfigError

HELP = "Tune the PID by differential evolution on seeds kept for tuning; writes files of gains."
EXAMPLES = (
    "python scripts/tune.py --ship all --resume  # into the package's gains, about 4 min a ship",
    "python scripts/tune.py --ship kcs --episodes 64 --out runs/pid_kcs.toml",
)

SIZE = {"scenario": "heading_keeping", "episodes": 24, "generations": 16, "seed": 0}


def main() -> None:
    args = parser(HELP, EXAMPLES)
    args.add_argument("--ship", default="all", help="ship, ship file or all (default)")
    for name, default in SIZE.items():
        text = f"default {default}"
        args.add_argument(f"--{name}", type=type(default), default=default, help=text)
    args.add_argument("--resume", action="store_true", help="leave ships with such gains alone")
    args.add_argument("--out", help="file to write (default: gains/pid_<ship>.toml of the package)")
    args = args.parse_args()
    if args.out and args.ship == "all":
        raise ConfigError("--out is one file: name the ship too")
    size = {name: getattr(args, name) for name in SIZE}
    found, lines, how = {}, [], settings(**size)
    for ship in available_ships() if args.ship == "all" else [args.ship]:
        if args.resume and is_tuned(ship, how, args.out):
            lines += [f"{ship}: tuned already"]
            continue
        ranking = tune(ship, progress=lambda names, s=ship: progress(names, s), **size)
        found[ship] = dataclasses.asdict(made := gains_file(ship, ranking, how))
        lines += [f"{ship}: wrote {write_gains(made, args.out)}", *map(str, ranking)]
    lines += ["Compare with: python scripts/evaluate.py --controllers pid constant"]
    show(args.json, found, "\n".join(lines))


if __name__ == "__main__":
    run(main)
