"""``ship-gym fit-hull``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import Several, force, out, ship, verb

_COLUMNS = """
columns of --captive: speed [m/s], n [rev/s]; may be there: beta [deg], delta [deg], yaw_rate [-],
frequency [1/s] (a model that swings); coefficients by 1/2 rho L d U^2 (moments by that times L):
X [-], Y [-], N [-], thrust T [-], or their harmonics, Y_in [-], Y_out [-], Y_in2 [-], ... A line
'# length: 6.9' names the model's own [m]. The files of HMRI's tests of KVLCC2 are read as they are.
"""


@verb(
    "--ship kvlcc2_model --captive drift.csv yaw.csv",
    "--ship mine/ship.toml --captive *.csv --numbers Y_v N_v rudder.a_H --plot runs/fit.png",
    notes=_COLUMNS,
)
@ship("kvlcc2_model")
@click.option(
    "--captive", cls=Several, type=click.Path(path_type=Path), help="Files of captive runs (csv)."
)
@click.option(
    "--numbers",
    cls=Several,
    help="Numbers to fit, as Y_v or rudder.a_H; default: the hull's 16 derivatives.",
)
@click.option(
    "--trials", is_flag=True, help="Sail the trials of the ship file, before and after: unseen."
)
@out(".toml", "Ship file; default: runs/fit_hull/<ship>/ship.toml.")
@out(".md", "Also write the report as a page.", "--page")
@out(".png", "Also draw measured over computed and the residuals.", "--plot")
@force()
def command(as_json, ship, captive, numbers, trials, out, page, plot, force) -> None:
    """Fit a ship's hull derivatives to captive tests; write the fitted ship.

    Linear least squares of the MMG derivatives with standard errors; propeller, rudder and masses
    stay the ship's. The result is a ship file that says what was fitted to what.
    """
    from ship_gym.identification import report
    from ship_gym.identification.captive_fit import USUAL, fit_captive
    from ship_gym.ships.loader import load_ship
    from ship_gym_agents.cli import replace
    from ship_gym_agents.cli.output import need, progress, show

    if not captive:
        raise click.UsageError("--captive: needs one or more files of captive runs (csv)")
    need(*(["matplotlib"] if plot else []))
    base = ship or "kvlcc2_model"
    before = load_ship(base)
    written = replace.fitted_ship(before.name)
    replace.check_replaced(out, written, force)
    replace.check_replaced(page, replace.page("fit-hull"), force, "--page")
    place = _place(out, before)
    found = fit_captive(before, captive, numbers or USUAL, each=lambda x: progress(x, "fitting"))
    _write_ship(place, base, found)
    unseen = _unseen(before, found.fitted) if trials else None
    if page:
        _write_page(page, f"{report.as_text(found, True)}{_told(unseen, True)}")
    if plot:
        from ship_gym.plotting.fit_hull import plot_fit

        plot_fit(found, plot)
    files = [str(path) for path in (place, page, plot) if path]
    wrote = f"\nwrote {', '.join(files)}\n{_following(place)}"
    data = report.as_dict(found) | {"unseen": unseen and unseen.as_dict(), "files": files}
    show(as_json, data, f"{report.as_text(found)}{_told(unseen, False)}{wrote}")


def _place(out: Path | None, ship: Any) -> Path:
    from ship_gym_agents.cli.output import place

    return place(out, Path("runs") / "fit_hull" / ship.name / "ship.toml")


def _write_ship(path: Path, base: Any, found: Any) -> None:
    """Write the ship file, unless a number is one that no ship has: then nothing is written."""
    from ship_gym.config import ConfigError
    from ship_gym.identification import report
    from ship_gym.identification.ship_text import write_ship

    if strange := report.implausible(found):
        raise ConfigError(
            "\n".join(f"{line}; fit fewer --numbers, or give other runs" for line in strange)
        )
    write_ship(path, base, found.fitted, report.source_of(found), report.told_of(found))


def _unseen(before: Any, fitted: Any) -> Any:
    """The trials of the ship file, before and after."""
    from ship_gym.identification.unseen import sail_trials
    from ship_gym_agents.cli.output import progress

    return sail_trials(before, fitted, lambda x: progress(x, "sailing"))


def _told(unseen: Any, markdown: bool) -> str:
    """Table and sentence of the trials; empty without them."""
    if unseen is None:
        return ""
    return f"\n\n{unseen.table(markdown)}\n\n{unseen.sentence()}"


def _write_page(path: Path, body: str) -> None:
    from ship_gym.writing import atomic_path

    note = "<!-- Written by `ship-gym fit-hull`; run it again instead of editing. -->"
    with atomic_path(path) as temporary:
        text = f"{note}\n# Hull derivatives from captive tests\n\n{body}\n"
        temporary.write_text(text, encoding="utf-8")


def _following(place: Path) -> str:
    from ship_gym_agents.cli.output import next_command

    return f"next: {next_command('simulate', ship=place)}"
