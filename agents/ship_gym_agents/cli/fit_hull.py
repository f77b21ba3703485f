"""``ship-gym fit-hull``."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import Several, force, out, ship, verb
from ship_gym_agents.cli.values import Number

_COLUMNS = """
columns of --captive: speed [m/s], n [rev/s]; may be there: beta [deg], delta [deg]; of a model that
swings frequency [1/s] and yaw_rate [-] or, in pure sway, sway [-] (v / U). Coefficients by
1/2 rho L d U^2 (moments by that times L): X [-], Y [-], N [-], thrust T [-], or their harmonics,
Y_in [-], Y_out [-], Y_in2 [-], ... X ahead, Y and delta to starboard, N bow to starboard about
midship, beta where she drifts to port; inertia not taken off. A line '# length: 6.9' names the
model's own [m]. The files of HMRI's tests of KVLCC2 are read as they are.
columns of --records: t [s], x [m] (north), y [m] (east), psi [deg] (clockwise from north),
delta [deg] (to starboard), n [rpm]; a line '# length: 320' names the ship's own [m]. Calm water.
"""


@verb(
    "--ship kvlcc2_model --captive drift.csv yaw.csv",
    "--ship mine/ship.toml --captive *.csv --numbers Y_v N_v rudder.a_H --plot runs/fit.png",
    "--ship mine/ship.toml --records turn.csv zigzag.csv --numbers N_r Y_v --hold-out other.csv",
    notes=_COLUMNS,
)
@ship("kvlcc2_model")
@click.option(
    "--captive", cls=Several, type=click.Path(path_type=Path), help="Files of captive runs (csv)."
)
@click.option(
    "--numbers",
    cls=Several,
    help="Numbers to fit, as Y_v or rudder.a_H; default of --captive: the hull's 16 derivatives.",
)
@click.option(
    "--drift",
    type=Number(0.0, 30.0, "deg"),
    default=30.0,
    help="Largest drift angle of --captive runs to fit to [deg].",
)
@click.option(
    "--records",
    cls=Several,
    type=click.Path(path_type=Path),
    help="Instead of --captive: records of the free ship (csv), to calibrate --numbers to.",
)
@click.option(
    "--hold-out",
    cls=Several,
    type=click.Path(path_type=Path),
    help="Further records: sailed, but not fitted to.",
)
@click.option(
    "--trials", is_flag=True, help="Sail the trials of the ship file, before and after: unseen."
)
@out(".toml", "Ship file; default: runs/fit_hull/<ship>/ship.toml.")
@out(".md", "Also write the report as a page.", "--page")
@out(".png", "Also draw measured over computed and the residuals.", "--plot")
@force()
def command(
    as_json, ship, captive, numbers, drift, records, hold_out, trials, out, page, plot, force
) -> None:
    """Fit a ship's hull derivatives to captive tests; write the fitted ship.

    Linear least squares of the MMG derivatives with standard errors; propeller, rudder and masses
    stay the ship's. Or calibrate a few numbers to records of the free ship, by bounded least
    squares. The result is a ship file that says what was fitted to what.
    """
    from ship_gym.identification import calibration_report, report
    from ship_gym.ships.loader import load_ship
    from ship_gym_agents.cli import replace
    from ship_gym_agents.cli.output import need, show

    _check_together(captive, numbers, records, hold_out, plot)
    need(*(["matplotlib"] if plot else []))
    base = ship or "kvlcc2_model"
    before = load_ship(base)
    replace.check_replaced(out, replace.fitted_ship(before.name), force)
    replace.check_replaced(page, replace.page("fit-hull"), force, "--page")
    place = _place(out, before)
    told = calibration_report if records else report
    found = _fitted(before, captive, numbers, drift, records, hold_out)
    _write_ship(place, base, found, told)
    unseen = _unseen(before, found.fitted) if trials else None
    if page:
        _write_page(page, f"{told.as_text(found, True)}{_told(unseen, True)}")
    if plot:
        from ship_gym.plotting.fit_hull import plot_fit

        plot_fit(found, plot)
    files = [str(path) for path in (place, page, plot) if path]
    wrote = f"\nwrote {', '.join(files)}\n{_following(place)}"
    data = told.as_dict(found) | {"unseen": unseen and unseen.as_dict(), "files": files}
    show(as_json, data, f"{told.as_text(found)}{_told(unseen, False)}{wrote}")


def _check_together(captive: Any, numbers: Any, records: Any, hold_out: Any, plot: Any) -> None:
    """Refuse what does not belong together."""
    if bool(captive) == bool(records):
        raise click.UsageError("--captive or --records: needs one of them, with its files (csv)")
    if records and not numbers:
        raise click.UsageError("--records: needs the --numbers to calibrate, a few of them")
    if hold_out and not records:
        raise click.UsageError("--hold-out: belongs to --records")
    if plot and not captive:
        raise click.UsageError("--plot: belongs to --captive")


def _fitted(
    before: Any, captive: Any, numbers: Any, drift: float, records: Any, hold_out: Any
) -> Any:
    """What was fitted to captive runs, or calibrated to records."""
    from ship_gym.identification.calibration import calibrate
    from ship_gym.identification.captive_fit import USUAL, fit_captive
    from ship_gym_agents.cli.output import progress

    if records:
        return calibrate(before, records, numbers, hold_out, lambda x: progress(x, "calibrating"))
    each, largest = lambda x: progress(x, "fitting"), math.radians(drift)
    return fit_captive(before, captive, numbers or USUAL, each, largest)


def _place(out: Path | None, ship: Any) -> Path:
    from ship_gym_agents.cli.output import place

    return place(out, Path("runs") / "fit_hull" / ship.name / "ship.toml")


def _write_ship(path: Path, base: Any, found: Any, told: Any) -> None:
    """Write the ship file, unless a number is one that no ship has: then nothing is written."""
    from ship_gym.config import ConfigError
    from ship_gym.identification.ship_text import write_ship

    if strange := told.implausible(found):
        raise ConfigError("\n".join([*strange, told.advice(found)]))
    write_ship(path, base, found.fitted, told.sources_of(found), told.lines_of(found))


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
