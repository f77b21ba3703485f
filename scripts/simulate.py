"""Sail a turning circle, a zig-zag or all trials of a ship: measures, trial, IMO, picture."""

from __future__ import annotations

from pathlib import Path

from _cli import parser, run, show

from ship_gym import load_ship
from ship_gym.plotting import plot_manoeuvre
from ship_gym.reports import manoeuvre as report

EXAMPLES = (
    "python scripts/simulate.py                                  # KCS model, 35 deg, its trial",
    "python scripts/simulate.py zigzag --ship kvlcc2_model --delta -20 --psi -20",
    "python scripts/simulate.py trials --ship kvlcc2_model       # measured beside computed",
    "python scripts/simulate.py turning --ship kcs --n 1.5 --sea current --csv runs/turn.csv",
)


def main() -> None:
    args = arguments()
    ship = load_ship(args.ship, surrogate=args.surrogate, variant=args.variant)
    if args.what == "trials":
        cases = report.sail_trials(ship)
    else:
        options = ("delta_deg", "psi_deg", "speed", "n", "sea")
        cases = [report.sail(ship, args.what, **{key: getattr(args, key) for key in options})]
    written = [write(case, args, k if len(cases) > 1 else 0) for k, case in enumerate(cases, 1)]
    found = [report.as_dict(c) | {"files": f} for c, f in zip(cases, written, strict=True)]
    texts = [report.as_text(c) + f"\nwrote {', '.join(f)}" for c, f in zip(cases, written)]
    texts.append(f"{report.estimates(ship)}\n{next_step(args, written[0])}")
    show(args.json, found[0] if args.what != "trials" else {"trials": found}, "\n\n".join(texts))
