"""``ship-gym build-wave-table``."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import force, jobs, out, report, ship, verb
from ship_gym_agents.cli.values import Number, OwnNumber

_HULL_FILE = {  # options of --mesh and what they are without a word
    "scale": 1.0, "forward": "+x", "up": "+z", "midship": 0.0, "waterline": 0.0,
    "flip_normals": False, "fix_normals": False, "weld": None, "panels": 704,
}  # fmt: skip


@verb(
    "--ship kcs_model --report",
    "--ship my_ship.toml  # writes waves_my_ship.npz beside it",
    "--ship my_ship.toml --mesh my_hull.stl --scale 0.001",
    "--ship my_ship.toml --mesh my_hull.gdf --flip-normals --panels own",
    "--ship kcs_model --quick --out runs/coarse.npz",
    "--from runs/waves_kcs_model.npz --report",
)
@ship("kcs_model; a file needs a section [form], or --mesh")
@click.option(
    "--mesh",
    type=click.Path(path_type=Path),
    help="Hull file (GDF, STL, STEP, ...: docs/hulls.md) instead of the drawn hull.",
)
@click.option("--scale", type=Number(1e-9, 1e9), default=1.0, help="Metres per unit of --mesh.")
@click.option("--forward", default="+x", help="Axis of --mesh that points to the bow.")
@click.option("--up", default="+z", help="Axis of --mesh that points upwards.")
@click.option("--midship", type=Number(unit="m"), default=0.0, help="Midship in it [m], scaled.")
@click.option("--waterline", type=Number(unit="m"), default=0.0, help="Its waterline [m], scaled.")
@click.option("--flip-normals", is_flag=True, help="Its normals point into the hull.")
@click.option("--fix-normals", is_flag=True, help="Its normals differ: turn them outward.")
@click.option("--weld", type=Number(0.0, unit="m"), help="Gaps closed in it; default: 1e-4 L.")
@click.option(
    "--panels",
    type=OwnNumber(40, 20000),
    default=_HULL_FILE["panels"],
    show_default=True,
    help="Panels for both sides; own: as they are in --mesh.",
)
@out(".npz", "Table file; default: waves_<ship>.npz, beside a ship file or in runs.")
@click.option("--quick", is_flag=True, help="Coarse: 3 speeds, 7 headings, 12 waves.")
@click.option(
    "--froude", type=Number(0.0, 0.6), help="Largest speed; default: what the engine holds."
)
@jobs()
@click.option(
    "--from", "table", type=click.Path(path_type=Path), help="No computing: report on this table."
)
@report()
@force()
def command(as_json, **options) -> None:
    """Compute a ship's wave table by boundary elements.

    Drift forces and motions in waves of all headings; a table serves the ship at any scale.
    """
    from ship_gym.seakeeping.table_checks import compare_with_snnm
    from ship_gym_agents.cli.output import need, place, report_page, show

    asked = Asked(**options)
    if asked.report is not None:
        need("matplotlib")
        if asked.table and (page := report_page(asked.report, asked.table)):
            place(None, page, "--report")
    made = _existing(asked, asked.table) if asked.table else _computed(asked)
    files = [] if asked.table else [made.path]
    if asked.report is not None:
        from ship_gym.plotting.waves import write_wave_report

        page = report_page(asked.report, made.path)
        assert page is not None  # as one is asked for
        write_wave_report(page, made.table, made.ship, made.mesh, made.path)
        files.append(page)
    facts = {"file": str(made.path), **made.table.card, "snnm": compare_with_snnm(made.table)}
    facts["files"] = [str(file) for file in files]
    wrote = [f"wrote {file} ({file.stat().st_size / 1e6:.2f} MB)" for file in files]
    show(as_json, facts, "\n".join([*_summary(made.table), *wrote]))


@dataclasses.dataclass(frozen=True)
class Asked:
    """The options, as the help explains them."""

    ship: str | None
    mesh: Path | None
    scale: float
    forward: str
    up: str
    midship: float
    waterline: float
    flip_normals: bool
    fix_normals: bool
    weld: float | None
    panels: int | str
    out: Path | None
    quick: bool
    froude: float | None
    jobs: int
    table: Path | None
    report: Path | None
    force: bool


@dataclasses.dataclass(frozen=True)
class Made:
    """A table with its ship, its panels (None if they cannot be had) and its file."""

    table: Any
    ship: Any
    mesh: Any
    path: Path


def _hull(asked: Asked, ship: Any):
    """Panels of the hull: of the user's file, or drawn from the ship's form."""
    from ship_gym.seakeeping import hull_file, hull_form

    if asked.mesh is None:
        _check_alone(asked)
        assert isinstance(asked.panels, int)  # else refused
        return hull_form.parametric_mesh(ship, *_drawn(asked.panels))
    where = {name: getattr(asked, name) for name in _HULL_FILE}
    where["panels"] = None if asked.panels == "own" else asked.panels
    return hull_file.read_hull(asked.mesh, ship, **where)


def _drawn(panels: int) -> tuple[int, int]:
    """Panels along and around the half of a drawn hull, for so many on both sides or more."""
    from ship_gym.seakeeping.hull_form import GIRTH, STATIONS

    ratio = math.sqrt(panels / (2.0 * STATIONS * GIRTH))
    return math.ceil(ratio * STATIONS), max(3, math.ceil(ratio * GIRTH))


def _check_alone(asked: Asked) -> None:
    """Refuse an option of a hull file where there is none."""
    from ship_gym.config import ConfigError

    alone = [name for name, without in _HULL_FILE.items() if getattr(asked, name) != without]
    if alone and (alone != ["panels"] or asked.panels == "own"):
        option = "--" + alone[0].replace("_", "-")
        raise ConfigError(f"{option}: belongs to a hull file: name it with --mesh")


def _existing(asked: Asked, file: Path) -> Made:
    """The table of ``--from``."""
    from ship_gym.config import ConfigError
    from ship_gym.reports.wave_table import check_card
    from ship_gym.sea.wave_table import WaveTable
    from ship_gym.ships.files import available_ships
    from ship_gym.ships.loader import load_ship

    if asked.out or asked.quick or asked.froude is not None:
        raise ConfigError("--from reads a table: --out, --quick and --froude belong to computing")
    table = WaveTable.load(file)
    check_card(table, file)
    if asked.ship is None and table.card["ship"] not in available_ships():
        raise ConfigError(f"{file}: made for {table.card['ship']}; name its file with --ship")
    ship = load_ship(asked.ship or table.card["ship"])
    if ship.name != table.card["ship"]:
        raise ConfigError(f"{file}: made for {table.card['ship']}, not for {ship.name}")
    if asked.mesh is None and not table.card["mesh"][0].startswith("parametric hull"):
        return Made(table, ship, None, file)  # from a hull file that was not named again
    mesh = _hull(asked, ship)
    if list(mesh.report) != table.card["mesh"]:
        raise ConfigError(
            f"{file}: made with another mesh: {'; '.join(table.card['mesh'])}; "
            f"found {'; '.join(mesh.report)}"
        )
    return Made(table, ship, mesh, file)


def _computed(asked: Asked) -> Made:
    """A new table."""
    from ship_gym.config import check_number
    from ship_gym.reports.wave_table import largest_froude
    from ship_gym.seakeeping import database
    from ship_gym.ships.loader import load_ship
    from ship_gym_agents.cli.output import need, place, progress
    from ship_gym_agents.cli.replace import check_replaced, wave_table

    need("capytaine", "joblib")
    ship = load_ship(asked.ship or "kcs_model")
    fastest = largest_froude(ship) if asked.froude is None else asked.froude
    check_number("froude", fastest, 0.0, 0.6)
    grid = (database.QUICK if asked.quick else database.Grid()).up_to(fastest)
    mesh = _hull(asked, ship)
    # beside a ship file, where the ship finds it
    own = Path(asked.ship or "")
    folder = own.parent if own.name.endswith(".toml") else Path("runs")
    check_replaced(asked.out, wave_table(ship.name, dataclasses.asdict(grid)), asked.force)
    out = place(asked.out, folder / f"waves_{ship.name}.npz")
    return Made(database.build(ship, mesh, out, grid, asked.jobs, progress), ship, mesh, out)


def _summary(table: Any) -> list[str]:
    """What was computed and whether it holds, as lines."""
    card, checks = table.card, table.card["checks"]
    largest = ", ".join(f"|{name}| {value:.3g}" for name, value in checks["largest"].items())
    speeds = ", ".join(f"{x:g}" for x in table.froude)
    return [
        f"{card['ship']}: {card['panels']} panels, {card['minutes']} minutes, Fn {speeds}",
        f"  energy balance at rest within {100.0 * checks['energy']:.1f} %",
        f"  largest {largest}" + ("" if checks["within_bounds"] else ": beyond what is allowed"),
    ]
