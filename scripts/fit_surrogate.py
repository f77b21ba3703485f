"""Fit the KCS propeller and rudder surrogate to CFD points and write it as a table file."""

from __future__ import annotations

from pathlib import Path

from _cli import need, parser, progress, run, show

from ship_gym import load_ship
from ship_gym.config import read_csv
from ship_gym.reports import surrogate as report
from ship_gym.ships.loader import DATA, attach_surrogate
from ship_gym.surrogates.fit import KCS_SAMPLES, TRAINING, VALIDATION, fit_kcs, sample_set

PRINTED_ERRORS = Path(__file__).parents[1] / "tests" / "data" / "kcs_regression_error.csv"
SHIPPED_FOLDER = DATA / "kcs_model"
EXAMPLES = (
    "python scripts/fit_surrogate.py                  # G2_SA, the default of kcs_model",
    "python scripts/fit_surrogate.py --grid G3 --plot runs/G3.png",
    "python scripts/fit_surrogate.py --samples my.csv # columns as in the default file",
    "python scripts/fit_surrogate.py --install        # make the shipped tables again",
)


def arguments():
    p = parser(__doc__, EXAMPLES)
    p.add_argument("--grid", default="G2", help="CFD grid: G1, G2 (default), G3")
    p.add_argument("--turbulence", default="SA", help="turbulence model: SA (default), SST (G2)")
    p.add_argument("--order", default="second", help="regression: first, second (default)")
    p.add_argument("--samples", type=Path, help=f"CFD points (default {KCS_SAMPLES.name})")
    p.add_argument("--out", type=Path, help="table file (default runs/surrogate_G2_SA.npz)")
    p.add_argument("--plot", type=Path, help="also draw the surrogate to this PNG file")
    p.add_argument(
        "--install",
        type=Path,
        nargs="?",
        const=SHIPPED_FOLDER,
        metavar="FOLDER",
        help="write all four shipped tables (default folder: the ship's own)",
    )
    return p.parse_args()


def install(folder: Path) -> list[str]:
    """Fit and write every table that comes with the package."""
    ship = load_ship("kcs_model", surrogate="none")
    # all are fitted before the first is written, so that each card names the commit as it was
    tables = {
        folder / f"surrogate_{grid}_{turbulence}.npz": fit_kcs(
            ship, grid=grid, turbulence=turbulence
        )
        for grid, turbulence in progress(report.SHIPPED, "fitting")
    }
    for path, table in tables.items():
        table.save(path)
    return [str(path) for path in tables]


def fit(args) -> tuple[dict, str]:
    """Fit, write and draw one table; return what to print as data and as text."""
    name = f"{args.grid}_{args.turbulence}" + ("" if args.order == "second" else f"_{args.order}")
    samples, out = args.samples or KCS_SAMPLES, args.out or Path("runs") / f"surrogate_{name}.npz"
    ship = load_ship("kcs_model", surrogate="none")
    choice = {"grid": args.grid, "turbulence": args.turbulence}
    table = fit_kcs(ship, **choice, order=args.order, samples_path=samples)
    table.save(out)
    if args.plot:
        from ship_gym.plotting import plot_surrogate

        rows = read_csv(samples)
        validation = sample_set(rows, *choice.values(), VALIDATION)
        own = table.card["trained_on"] == "printed forces"
        training = sample_set(rows, *choice.values(), TRAINING) if own else None
        plot_surrogate(attach_surrogate(ship, table, name), args.plot, training, validation)
    data = report.as_dict(table, name, PRINTED_ERRORS, own=args.samples is not None)
    data["turning_circle"] = report.turning_check(ship, table, name)
    data["files"] = [str(path) for path in (out, args.plot) if path]
    text = [report.as_text(data), f"wrote {', '.join(data['files'])}", report.how_to_use(out, name)]
    return data, "\n".join(text)


def main() -> None:
    args = arguments()
    if args.plot:
        need("matplotlib")
    if args.install:
        files = install(args.install)
        show(args.json, {"files": files}, "wrote\n  " + "\n  ".join(files))
    else:
        show(args.json, *fit(args))


if __name__ == "__main__":
    run(main)
