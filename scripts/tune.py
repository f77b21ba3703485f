"""Tune the PID's gains for one ship or all; see --help."""

from __future__ import annotations

import dataclasses

from _cli import parser, progress, run, show

from agents.tune import gains_file, tune, write_gains
from ship_gym import available_ships

HELP = "Tune the PID by differential evolution on seeds kept for tuning; writes files of gains."
EXAMPLES = (
    "python scripts/tune.py                      # all ships, into agents/gains",
    "python scripts/tune.py --ship kcs --episodes 64 --out runs/pid_kcs.toml",
)


def main() -> None:
    args = parser(HELP, EXAMPLES)
    args.add_argument("--ship", help="a ship or ship file (default: all ships of the package)")
    args.add_argument("--episodes", type=int, default=32, help="episodes to tune on (default 32)")
    args.add_argument("--generations", type=int, default=25, help="of the search (default 25)")
    args.add_argument("--seed", type=int, default=0, help="of the search (default 0)")
    args.add_argument("--out", help="file to write (default: agents/gains/pid_<ship>.toml)")
    args = args.parse_args()
    size = {"episodes": args.episodes, "generations": args.generations, "seed": args.seed}
    how = f"scipy differential evolution, {args.generations} generations, seed {args.seed}"
    found, lines = {}, []
    for ship in [args.ship] if args.ship else available_ships():
        ranking = tune(ship, progress=lambda names, s=ship: progress(names, s), **size)
        found[ship] = dataclasses.asdict(made := gains_file(ship, ranking, args.episodes, how))
        lines += [f"{ship}: wrote {write_gains(made, args.out)}"]
        lines += [f"  J {t.J_validation:8.3f} deg2  {t.structure}: {t.gains}" for t in ranking]
    lines += ["Compare with: python scripts/evaluate.py --controllers pid constant"]
    show(args.json, found, "\n".join(lines))


if __name__ == "__main__":
    run(main)
