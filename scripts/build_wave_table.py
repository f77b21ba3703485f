"""Compute a ship's wave table: drift forces and motions by boundary elements."""

from __future__ import annotations

import os
from pathlib import Path

from _cli import add_report, need, parser, progress, report_page, run, show

from ship_gym import available_ships, load_ship
from ship_gym.config import ConfigError, check_number
from ship_gym.reports.wave_table import largest_froude
from ship_gym.sea.wave_table import WaveTable
from ship_gym.seakeeping.database import QUICK, Grid, build
from ship_gym.seakeeping.hull_file import read_hull
from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.seakeeping.table_checks import compare_with_snnm

EXAMPLES = (
    "python scripts/build_wave_table.py --ship kcs_model --report",
    "python scripts/build_wave_table.py --ship my_ship.toml  # writes waves_my_ship.npz beside it",
    "python scripts/build_wave_table.py --ship my_ship.toml --mesh my_hull.stl --scale 0.001",
    "python scripts/build_wave_table.py --ship kcs_model --quick --out runs/coarse.npz",
    "python scripts/build_wave_table.py --from runs/waves_kcs_model.npz --report",
)
HULL_FILE = ("scale", "forward", "up", "midship", "waterline")


def arguments():
    p = parser(__doc__, EXAMPLES)
    p.add_argument("--ship", help="a name or .toml file with a section [form] (default kcs_model)")
    p.add_argument("--mesh", type=Path, help="hull file (STL, OBJ, GDF) instead of the drawn hull")
    p.add_argument("--scale", type=float, default=1.0, help="metres of the ship per unit of --mesh")
    p.add_argument("--forward", default="+x", help="axis of --mesh that points to the bow")
    p.add_argument("--up", default="+z", help="axis of --mesh that points upwards")
    p.add_argument("--midship", type=float, default=0.0, help="midship in --mesh [m], scaled")
    p.add_argument("--waterline", type=float, default=0.0, help="its waterline [m], scaled")
    p.add_argument(
        "--out",
        type=Path,
        help="table file (default waves_<ship>.npz, beside a ship file or in runs/)",
    )
    p.add_argument("--quick", action="store_true", help="coarse: 3 speeds, 7 headings, 12 waves")
    p.add_argument("--froude", type=float, help="largest speed (default: what the engine holds)")
    p.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes (default: cores)")
    p.add_argument("--from", dest="table", type=Path, help="no computing: report on this table")
    add_report(p)
    return p.parse_args()


def hull(args, ship):
    """Panels of the hull: of the user's file, or drawn from the ship's form."""
    if args.mesh is None:
        return parametric_mesh(ship)
    return read_hull(args.mesh, ship, **{name: getattr(args, name) for name in HULL_FILE})


def existing(args):
    """Table of --from with its ship, its panels if they can be had, and its file."""
    if args.out or args.quick or args.froude is not None:
        raise ConfigError("--from reads a table: --out, --quick and --froude belong to computing")
    table = WaveTable.load(args.table)
    if args.ship is None and table.card["ship"] not in available_ships():
        raise ConfigError(f"{args.table}: made for {table.card['ship']}; name its file with --ship")
    ship = load_ship(args.ship or table.card["ship"])
    if ship.name != table.card["ship"]:
        raise ConfigError(f"{args.table}: made for {table.card['ship']}, not for {ship.name}")
    if args.mesh is None and not table.card["mesh"][0].startswith("parametric hull"):
        return table, ship, None, args.table  # from a hull file that was not named again
    mesh = hull(args, ship)
    if list(mesh.report) != table.card["mesh"]:
        raise ConfigError(
            f"{args.table}: made with another mesh: {'; '.join(table.card['mesh'])}; "
            f"found {'; '.join(mesh.report)}"
        )
    return table, ship, mesh, args.table


def computed(args):
    """A new table with its ship, its panels and its file."""
    for library in ("capytaine", "joblib"):
        need(library)
    ship = load_ship(args.ship or "kcs_model")
    fastest = largest_froude(ship) if args.froude is None else args.froude
    check_number("froude", fastest, 0.0, 0.6)
    grid = (QUICK if args.quick else Grid()).up_to(fastest)
    mesh = hull(args, ship)
    # beside a ship file, where the ship finds it
    own = str(args.ship or "").endswith(".toml")
    out = args.out or (Path(args.ship).parent if own else Path("runs")) / f"waves_{ship.name}.npz"
    return build(ship, mesh, out, grid, args.jobs, progress), ship, mesh, out


def summary(table: WaveTable) -> list[str]:
    """What was computed and whether it holds, as lines."""
    card, checks = table.card, table.card["checks"]
    largest = ", ".join(f"|{name}| {value:.3g}" for name, value in checks["largest"].items())
    speeds = ", ".join(f"{x:g}" for x in table.froude)
    return [
        f"{card['ship']}: {card['panels']} panels, {card['minutes']} minutes, Fn {speeds}",
        f"  energy balance at rest within {100.0 * checks['energy']:.1f} %",
        f"  largest {largest}" + ("" if checks["within_bounds"] else ": beyond what is allowed"),
    ]


def main() -> None:
    args = arguments()
    if args.report is not None:
        need("matplotlib")
    table, ship, mesh, path = (existing if args.table else computed)(args)
    files = [] if args.table else [path]
    if args.report is not None:
        from ship_gym.plotting.waves import write_wave_report

        page = report_page(args.report, path)
        write_wave_report(page, table, ship, mesh, path)
        files.append(page)
    facts = {"file": str(path), **table.card, "snnm": compare_with_snnm(table)}
    facts["files"] = [str(file) for file in files]
    wrote = [f"wrote {file} ({file.stat().st_size / 1e6:.2f} MB)" for file in files]
    show(args.json, facts, "\n".join([*summary(table), *wrote]))


if __name__ == "__main__":
    run(main)
