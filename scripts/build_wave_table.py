"""Compute a ship's wave table: drift forces and motions by boundary elements."""

from __future__ import annotations

import os
from pathlib import Path

from _cli import need, parser, progress, run, show

from ship_gym import load_ship
from ship_gym.seakeeping.database import QUICK, Grid, build
from ship_gym.seakeeping.hull_file import read_hull
from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.seakeeping.table_checks import compare_with_snnm

EXAMPLES = (
    "python scripts/build_wave_table.py --ship kcs_model",
    "python scripts/build_wave_table.py --ship my_ship.toml --mesh my_hull.stl --scale 0.001",
    "python scripts/build_wave_table.py --ship kcs_model --quick --out runs/coarse.npz",
)


def arguments():
    p = parser(__doc__, EXAMPLES)
    p.add_argument("--ship", default="kcs_model", help="a name or .toml file with a section [form]")
    p.add_argument("--mesh", type=Path, help="hull file (STL, OBJ, GDF) instead of the drawn hull")
    p.add_argument("--scale", type=float, default=1.0, help="metres of the ship per unit of --mesh")
    p.add_argument("--forward", default="+x", help="axis of --mesh that points to the bow")
    p.add_argument("--up", default="+z", help="axis of --mesh that points upwards")
    p.add_argument("--midship", type=float, default=0.0, help="midship in --mesh [m], scaled")
    p.add_argument("--waterline", type=float, default=0.0, help="its waterline [m], scaled")
    p.add_argument("--out", type=Path, help="table file (default runs/waves_<ship>.npz)")
    p.add_argument("--quick", action="store_true", help="coarse: 3 speeds, 7 headings, 12 waves")
    p.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes (default: cores)")
    return p.parse_args()


def hull(args, ship):
    """Panels of the hull: of the user's file, or drawn from the ship's form."""
    if args.mesh is None:
        return parametric_mesh(ship)
    axes = {"forward": args.forward, "up": args.up}
    place = {"midship": args.midship, "waterline": args.waterline}
    return read_hull(args.mesh, ship, scale=args.scale, **axes, **place)


def main() -> None:
    args = arguments()
    for library in ("capytaine", "joblib"):
        need(library)
    ship = load_ship(args.ship)
    mesh = hull(args, ship)
    out = args.out or Path("runs") / f"waves_{ship.name}.npz"
    table = build(ship, mesh, out, QUICK if args.quick else Grid(), args.jobs, progress)
    facts = {"file": str(out), **table.card, "snnm": compare_with_snnm(table)}
    checks = table.card["checks"]
    largest = ", ".join(f"|{name}| {value:.3g}" for name, value in checks["largest"].items())
    text = [
        f"{ship.name}: {table.card['panels']} panels, {table.card['minutes']} minutes",
        f"  energy balance at rest within {100.0 * checks['energy']:.1f} %",
        f"  largest {largest}" + ("" if checks["within_bounds"] else ": beyond what is allowed"),
        f"wrote {out} ({out.stat().st_size / 1e6:.2f} MB)",
    ]
    show(args.json, facts, "\n".join(text))


if __name__ == "__main__":
    run(main)
