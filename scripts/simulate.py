"""Sail a turning circle, a zig-zag or all trials of a ship: measures, trial, IMO, picture."""

from __future__ import annotations

from pathlib import Path

from _cli import need, parser, progress, run, show

from ship_gym import load_ship
from ship_gym.config import ConfigError, check_known
from ship_gym.reports import manoeuvre as report
from ship_gym.reports.case import MANOEUVRES, Case, sail, sail_trial, trials

OPTIONS = (
    *("delta_deg", "psi_deg", "speed", "n"),
    *("sea", "wave_height", "wavelength", "wave_from_deg"),
)
LOADING_COLOUR = {"turning_circle": "t", "zigzag": "delta"}
EXAMPLES = (
    "python scripts/simulate.py                                  # KCS model beside its trial",
    "python scripts/simulate.py zigzag --ship kvlcc2_model --delta -20",
    "python scripts/simulate.py trials --ship kvlcc2_model       # every measured manoeuvre",
    "python scripts/simulate.py turning --ship kcs --n 1.5 --sea current --csv runs/turn.csv",
    "python scripts/simulate.py --ship kcs --sea ss5 --wave-from 45",
    "python scripts/simulate.py --ship dtc_model --speed 1.48 --n 15.7 \\\n"
    "      --wave-height 0.112 --wavelength 1.0          # regular waves, beside calm water",
)


def arguments():
    p = parser(f"{__doc__} Angles are in degrees, positive to starboard.", EXAMPLES)
    p.add_argument(
        "what",
        nargs="?",
        default="turning",
        help="turning (default), zigzag, or trials: all of the ship file, as measured",
    )
    p.add_argument("--ship", default="kcs_model", help="name or ship file (default kcs_model)")
    p.add_argument("--surrogate", help="propeller and rudder, e.g. G2_SA or none (MMG rudder)")
    p.add_argument("--variant", help="other published hull set, e.g. hull_a")
    p.add_argument("--delta", dest="delta_deg", type=float, help="rudder [deg]; 35, zig-zag 10")
    p.add_argument("--psi", dest="psi_deg", type=float, help="zig-zag heading [deg]; as --delta")
    p.add_argument("--speed", type=float, help="approach [m/s] (default: the ship's nominal)")
    p.add_argument("--n", type=float, help="[rev/s] (default: the trial's, else self-propulsion)")
    p.add_argument("--sea", default="calm", help="calm (default), current, ss2 to ss8, ...")
    p.add_argument("--wave-height", type=float, help="of a regular wave, crest to trough [m]")
    p.add_argument("--wavelength", type=float, help="of a regular wave [ship lengths]")
    p.add_argument(
        "--wave-from", dest="wave_from_deg", type=float, help="where waves come from [deg]; 0 north"
    )
    p.add_argument("--out", type=Path, help="picture (default runs/turning_circle.png etc.)")
    p.add_argument("--loading", type=Path, help="also draw the propeller loading t'-q'-n' (PNG)")
    p.add_argument("--csv", type=Path, help="also write the time history")
    p.add_argument("--rrd", type=Path, help="also write a rerun recording")
    return p.parse_args()


def write(case: Case, args, number: str) -> list[str]:
    """Write the picture and what else was asked for; return the paths, numbered if several."""
    from ship_gym.plotting import plot_manoeuvre
    from ship_gym.plotting.loading import plot_loading
    from ship_gym.plotting.seaway import plot_turning_in_waves

    out = args.out or Path("runs") / f"{case.manoeuvre}.png"
    what = {"title": report.title(case), "colour": LOADING_COLOUR[case.manoeuvre]}
    history = case.result.trajectory
    in_waves = case.calm is not None and case.manoeuvre == "turning_circle"
    draw = plot_turning_in_waves if in_waves else plot_manoeuvre
    jobs = {out: lambda path: draw(case, path)}
    jobs |= {args.loading: lambda path: plot_loading(history, case.ship, path, **what)}
    jobs |= {args.csv: history.to_csv, args.rrd: history.to_rrd}
    paths = {path.with_stem(path.stem + number): job for path, job in jobs.items() if path}
    for path, job in paths.items():
        job(path)
    return [str(path) for path in paths]


def refuse_options(args) -> None:
    """Trials are sailed as they were measured."""
    given = [k for k in OPTIONS if k != "sea" and getattr(args, k) is not None]
    given += ["sea"] if args.sea != "calm" else []
    if given:
        raise ConfigError(f"{given[0]}: trials are sailed as measured; leave it out")


def main() -> None:
    args = arguments()
    need("matplotlib")
    if args.rrd:
        need("rerun")
    check_known("manoeuvre", args.what, [*MANOEUVRES, "trials"])
    ship = load_ship(args.ship, surrogate=args.surrogate, variant=args.variant)
    options = {k: getattr(args, k) for k in OPTIONS}
    if args.what == "trials":
        refuse_options(args)
        jobs = [lambda t=t: sail_trial(ship, t) for t in trials(ship)]
    else:
        jobs = [lambda: sail(ship, args.what, **options)]
    cases, files = [], []
    for k, job in enumerate(progress(jobs, "sailing"), start=1):
        cases.append(job())
        files.append(write(cases[-1], args, f"_{k}" if args.what == "trials" else ""))
    found = [report.as_dict(c) | {"files": f} for c, f in zip(cases, files, strict=True)]
    data = {"trials": found} if args.what == "trials" else found[0]
    show(args.json, data, report.all_as_text(cases, files))


if __name__ == "__main__":
    run(main)
