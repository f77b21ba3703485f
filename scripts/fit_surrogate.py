"""Fit a propeller and rudder surrogate to CFD points and write it as a table file."""

from __future__ import annotations

import sys
from pathlib import Path

from _cli import add_report, need, parser, progress, report_page, run, show

from ship_gym import load_ship
from ship_gym.config import ConfigError, check_known
from ship_gym.reports import surrogate as report
from ship_gym.reports.page import plain_text
from ship_gym.reports.surrogate_sections import sections
from ship_gym.ships.loader import DATA, attach_surrogate
from ship_gym.simulation import SimulationDiverged
from ship_gym.surrogates.fit import FAMILIES, Options, fit
from ship_gym.surrogates.force_table import table_of
from ship_gym.surrogates.own import own_data_set
from ship_gym.surrogates.regression import FEATURES
from ship_gym.surrogates.sample_checks import check_samples
from ship_gym.surrogates.samples import DATA_SETS

RUNS = Path("runs")
EXAMPLES = (
    "python scripts/fit_surrogate.py                    # KCS, regression on grid G2",
    "python scripts/fit_surrogate.py --family gp --report",
    "python scripts/fit_surrogate.py --data onrt --grid G3 --plot runs/onrt.png",
    "python scripts/fit_surrogate.py --samples my.csv --ship my_ship.toml --report",
    "python scripts/fit_surrogate.py --install          # make the shipped tables again",
)
COLUMNS = """
columns of --samples: point [-], J [-], beta [deg], K_T [-] (or K_X [-]), C_Fx [-], C_Fy [-]; may be
there: 10K_Q [-], K_S [-], grid, turbulence, set (training or validation), side (leeward or
windward). The whole rules: ship_gym/surrogates/own.py; an example to copy:
ship_gym/surrogates/data/kcs_propeller_rudder_cfd.csv
"""


def arguments():
    p = parser(__doc__, EXAMPLES)
    p.epilog += COLUMNS
    p.add_argument("--data", help=f"project data set: {', '.join(DATA_SETS)} (default kcs)")
    p.add_argument("--samples", type=Path, metavar="CSV", help="your own samples instead")
    p.add_argument("--ship", help="their ship, a name or .toml file (default kcs_model)")
    p.add_argument("--delta", type=float, metavar="DEG", help="their rudder angle [deg]")
    p.add_argument("--validation", type=int, nargs="+", default=(), help="their points to hold out")
    p.add_argument("--family", default="regression", help=f"{', '.join(FAMILIES)}")
    p.add_argument("--order", help=f"of the regression: {', '.join(FEATURES)} (default second)")
    p.add_argument(
        "--noise", help="of gp: printed (default), computed, none (default of --samples)"
    )
    p.add_argument("--grid", help="CFD grid (default: the first, G2)")
    p.add_argument("--turbulence", help="turbulence model (default: the first, SA)")
    p.add_argument("--seed", type=int, default=0, help="of networks and proposals")
    p.add_argument("--out", type=Path, help="table file (default runs/surrogate_<data>_<fit>.npz)")
    p.add_argument("--plot", type=Path, help="draw the surrogate to this PNG file")
    add_report(p)
    p.add_argument(
        "--install",
        type=Path,
        nargs="?",
        const=DATA,
        metavar="FOLDER",
        help="write all shipped tables (default folder: the package's own ships)",
    )
    return p.parse_args()


def install(folder: Path) -> list[str]:
    """Fit and write every table that comes with the package."""
    tables = {}
    # all are fitted before the first is written, so that each card names the commit as it was
    for name, family, grid, turbulence in progress(report.SHIPPED, "fitting"):
        data = DATA_SETS[name]
        found = fit(data, Options(family), grid, turbulence)
        path = folder / data.ship / f"surrogate_{found.name}.npz"
        tables[path] = table_of(found, load_ship(data.ship, surrogate="none"))
    for path, table in tables.items():
        table.save(path)
    return [str(path) for path in tables]


def chosen(args):
    """Data set, its ship without surrogate, options, grid and turbulence model."""
    own = args.samples is not None
    if own and args.data:
        raise ConfigError("--data and --samples: allowed is one of them")
    if not own and (args.ship or args.delta is not None or args.validation):
        raise ConfigError("--ship, --delta and --validation belong to --samples")
    if args.order and args.family != "regression":
        raise ConfigError("--order is of the regression")
    if args.noise and args.family != "gp":
        raise ConfigError("--noise is of the Gaussian process: --family gp")
    noise = args.noise or ("none" if own else "printed")
    options = Options(args.family, args.order or "second", noise, args.seed)
    if own:
        ship = load_ship(args.ship or "kcs_model", surrogate="none")
        held = tuple(args.validation)
        data = own_data_set(args.samples, ship, delta_deg=args.delta, validation=held)
    else:
        data = DATA_SETS[check_known("data set", args.data or "kcs", DATA_SETS)]
        ship = load_ship(data.ship, surrogate="none")
    grid, turbulence = data.choices[0] if data.choices else ("", "")
    choice = args.grid or grid, args.turbulence or turbulence
    if own:
        for warning in check_samples(data, ship, options, *choice):
            print(f"warning: {warning}", file=sys.stderr)
    return data, ship, options, choice


def fit_one(args) -> tuple[dict, str]:
    """Fit, write and draw one table; return what to print as data and as text."""
    data, ship, options, choice = chosen(args)
    done: dict = {}

    def fit_it():
        done["fit"] = fit(data, options, *choice)

    def tabulate_it():
        done["table"] = table_of(done["fit"], ship)

    def judge_it():
        done["data"] = report.as_dict(done["fit"], done["table"])

    for step in progress((fit_it, tabulate_it, judge_it), "fitting"):
        step()
    found, table, facts = done["fit"], done["table"], done["data"]
    stem = report.file_stem(found)
    out = args.out or RUNS / f"{stem}.npz"
    page = report_page(args.report, out)
    if args.samples and out.resolve() == args.samples.resolve():
        raise ConfigError(f"--out {out}: that is the file of the samples")
    table.save(out)
    try:
        facts["turning_circle"] = report.turning_check(ship, table, found.name)
    except (ConfigError, SimulationDiverged) as error:
        print(f"warning: {data.path}: {error}; are the signs and units right?", file=sys.stderr)
    draw(found, attach_surrogate(ship, table, found.name), facts, args.plot, page)
    facts["files"] = [str(path) for path in (out, args.plot, page) if path]
    text = [
        plain_text(sections(facts, {})),
        f"\nwrote {', '.join(facts['files'])}",
        report.how_to_use(out, found, args.ship or data.ship),
    ]
    return facts, "\n".join(text)


def draw(found, ship, facts: dict, plot: Path | None, page: Path | None) -> None:
    """Picture and page, where they are asked for."""
    if plot:
        from ship_gym.plotting import plot_surrogate

        plot_surrogate(ship, plot, found)
    if page:
        from ship_gym.plotting.surrogate_report import write_surrogate_report

        write_surrogate_report(page, found, ship, facts)


def main() -> None:
    args = arguments()
    if args.plot or args.report is not None:
        need("matplotlib")
    if args.install:
        files = install(args.install)
        show(args.json, {"files": files}, "wrote\n  " + "\n  ".join(files))
    else:
        show(args.json, *fit_one(args))


if __name__ == "__main__":
    run(main)
