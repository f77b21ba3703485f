"""``ship-gym fit-surrogate``."""

from __future__ import annotations

import dataclasses
import sys
from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import MayStandAlone, Several, force, out, report, seed, ship, verb
from ship_gym_agents.cli.values import Number, OutFolder, whole

_COLUMNS = """
columns of --samples: point [-], J [-], beta [deg], K_T [-] (or K_X [-]), C_Fx [-], C_Fy [-]; may be
there: 10K_Q [-], K_S [-], delta [deg] (several rudder angles), K_T std [-] and so on (noise of each
value), grid, turbulence, set (training or validation), side (leeward or windward). The whole
rules: ship_gym/surrogates/own.py; an example to copy:
ship_gym/surrogates/data/kcs_propeller_rudder_cfd.csv
"""


@verb(
    "                   # KCS, regression on grid G2",
    "--family gp --report",
    "--data onrt --grid G3 --plot runs/onrt.png",
    "--samples my.csv --ship my_ship.toml --report",
    "--samples my.csv --family gp --noise given --cheap coarse",
    "--install          # make the shipped tables again",
    notes=_COLUMNS,
)
@click.option("--data", help="Project data set: kcs (default), onrt or onrt_16.")
@click.option("--samples", type=click.Path(path_type=Path), help="Your own samples instead (csv).")
@ship("kcs_model, of --samples")
@click.option(
    "--delta",
    type=Number(unit="deg"),
    help="Rudder angle of --samples [deg]; of several the one to fit.",
)
@click.option("--validation", cls=Several, type=whole(0, 10**9), help="Its points to hold out.")
@click.option("--family", default="regression", help="regression, gp or nn.")
@click.option("--order", help="Of the regression: first, second (default), third, ...")
@click.option(
    "--noise", help="Of gp: printed (default), computed, given, none (default of --samples)."
)
@click.option("--cheap", help="Of gp: cheap grid below the dear one, e.g. G1_SA.")
@click.option("--grid", help="CFD grid; default: the first, G2.")
@click.option("--turbulence", help="Turbulence model; default: the first, SA.")
@seed("Of networks and proposals.")
@out(".npz", "Table file; default: runs/surrogate_<data>_<fit>.npz.")
@out(".png", "Draw the surrogate.", "--plot")
@report()
@force()
@click.option(
    "--install",
    cls=MayStandAlone,
    type=OutFolder(),
    help="Write all shipped tables here; alone: into the package's own ships.",
)
def command(as_json, install, **options) -> None:
    """Fit a propeller and rudder surrogate to CFD points.

    The result is a table file that attaches to a ship.
    """
    from ship_gym.locks import held
    from ship_gym.ships.files import DATA
    from ship_gym.writing import check_place
    from ship_gym_agents.cli.output import need, show

    asked = Asked(**options)
    if asked.plot or asked.report is not None:
        need("matplotlib")
    if install is not None:
        place = DATA if install == Path() else install
        with held(check_place(place, "--install", folder=True) / "tables", "fits tables"):
            files = _install(place)
        show(as_json, {"files": files}, "wrote\n  " + "\n  ".join(files))
    else:
        show(as_json, *_fit_one(asked))


@dataclasses.dataclass(frozen=True)
class Asked:
    """The options of one fit, as the help explains them."""

    data: str | None
    samples: Path | None
    ship: str | None
    delta: float | None
    validation: tuple[int, ...]
    family: str
    order: str | None
    noise: str | None
    cheap: str | None
    grid: str | None
    turbulence: str | None
    seed: int
    out: Path | None
    plot: Path | None
    report: Path | None
    force: bool


def _install(folder: Path) -> list[str]:
    """Fit and write every table that comes with the package."""
    from ship_gym.reports.surrogate import SHIPPED
    from ship_gym.ships.loader import load_ship
    from ship_gym.surrogates.fit import Options, fit
    from ship_gym.surrogates.force_table import table_of
    from ship_gym.surrogates.samples import DATA_SETS
    from ship_gym_agents.cli.output import progress

    tables = {}
    # all are fitted before the first is written, so that each card names the commit as it was
    for name, family, grid, turbulence in progress(SHIPPED, "fitting"):
        data = DATA_SETS[name]
        found = fit(data, Options(family), grid, turbulence)
        path = folder / data.ship / f"surrogate_{found.name}.npz"
        tables[path] = table_of(found, load_ship(data.ship, surrogate="none"))
    for path, table in tables.items():
        table.save(path)
    return [str(path) for path in tables]


def _check_together(asked: Asked) -> None:
    """Refuse options that do not belong together."""
    from ship_gym.config import ConfigError

    own = asked.samples is not None
    if own and asked.data:
        raise ConfigError("--data and --samples: allowed is one of them")
    if not own and (asked.ship or asked.delta is not None or asked.validation):
        raise ConfigError("--ship, --delta and --validation belong to --samples")
    if asked.order and asked.family != "regression":
        raise ConfigError("--order is of the regression")
    if asked.noise and asked.family != "gp":
        raise ConfigError("--noise is of the Gaussian process: --family gp")
    if asked.cheap and asked.family != "gp":
        raise ConfigError("--cheap is of the Gaussian process: --family gp")


def _chosen(asked: Asked) -> tuple[Any, Any, Any, tuple[str, str]]:
    """Data set, its ship without surrogate, options, grid and turbulence model."""
    from ship_gym.config import check_known
    from ship_gym.ships.loader import load_ship
    from ship_gym.surrogates.fit import FAMILIES, Options
    from ship_gym.surrogates.own import own_data_set
    from ship_gym.surrogates.samples import DATA_SETS

    _check_together(asked)
    own = asked.samples is not None
    check_known("family", asked.family, FAMILIES)
    noise = asked.noise or ("none" if own else "printed")
    options = Options(asked.family, asked.order or "second", noise, asked.seed, asked.cheap or "")
    if asked.samples is not None:
        ship = load_ship(asked.ship or "kcs_model", surrogate="none")
        data = own_data_set(asked.samples, ship, delta_deg=asked.delta, validation=asked.validation)
    else:
        data = DATA_SETS[check_known("data set", asked.data or "kcs", DATA_SETS)]
        ship = load_ship(data.ship, surrogate="none")
    grid, turbulence = data.choices[0] if data.choices else ("", "")
    choice = asked.grid or grid, asked.turbulence or turbulence
    if own:
        _warn_of_samples(data, ship, options, choice)
    return data, ship, options, choice


def _quiet(make: Any, *arguments: Any) -> Any:
    """What `make` gives, without its warnings: those of samples are printed before the fit."""
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return make(*arguments)


def _warn_of_samples(data: Any, ship: Any, options: Any, choice: tuple[str, str]) -> None:
    from ship_gym.surrogates.rudder_angles import sets_of
    from ship_gym.surrogates.sample_checks import check_samples

    for part in sets_of(data) if len(data.angles) > 1 else (data,):
        for warning in check_samples(part, ship, options, *choice):
            print(f"warning: {warning}", file=sys.stderr)


def _fit_one(asked: Asked) -> tuple[dict, str]:
    """Fit, write and draw one table; return what to print as data and as text."""
    from ship_gym.locks import held
    from ship_gym.reports import surrogate as report
    from ship_gym.reports.page import plain_text
    from ship_gym.reports.surrogate_sections import sections
    from ship_gym.ships.loader import attach_surrogate
    from ship_gym_agents.cli.output import place, report_page
    from ship_gym_agents.cli.replace import check_replaced, surrogate

    place(asked.out, "runs/surrogate.npz")  # the fit names it, in this folder
    data, ship, options, choice = _chosen(asked)
    check_replaced(asked.out, surrogate(data.name, ship.name), asked.force)
    usual = "-".join(filter(None, ("surrogate", data.name, options.family, *choice)))
    with held(asked.out or Path("runs") / f"{usual}.npz", "fits this table"):
        found, table, facts = _fitted(data, ship, options, choice)
        out = asked.out or Path("runs") / f"{report.file_stem(found)}.npz"
        table.save(out)
    page = report_page(asked.report, out)
    _turn(facts, ship, table, found)
    _draw(found, attach_surrogate(ship, table, found.name), facts, asked.plot, page)
    facts["files"] = [str(path) for path in (out, asked.plot, page) if path]
    text = [
        plain_text(sections(facts, {})),
        f"\nwrote {', '.join(facts['files'])}",
        report.how_to_use(out, found, asked.ship or data.ship),
    ]
    return facts, "\n".join(text)


def _fitted(data: Any, ship: Any, options: Any, choice: tuple[str, str]) -> tuple[Any, Any, dict]:
    """The fit, its table and what there is to say of it."""
    from ship_gym.reports.surrogate import as_dict
    from ship_gym.surrogates.fit import fit
    from ship_gym.surrogates.force_table import table_of
    from ship_gym.surrogates.rudder_angles import fit_rudder_angles, table_of_angles
    from ship_gym_agents.cli.output import progress

    several = len(data.angles) > 1
    done: dict[str, Any] = {}
    fitting, tabulating = (fit_rudder_angles, table_of_angles) if several else (fit, table_of)
    steps = {
        "fit": lambda: fitting(data, options, *choice),
        "table": lambda: _quiet(tabulating, done["fit"], ship),
        "facts": lambda: as_dict(_largest(done["fit"]), done["table"]),
    }
    for name in progress(list(steps), "fitting"):
        done[name] = steps[name]()
    return _largest(done["fit"]), done["table"], done["facts"]


def _largest(found: Any) -> Any:
    """The fit, of several rudder angles that of the largest, which stands for them in a report."""
    return found[-1] if isinstance(found, tuple) else found


def _turn(facts: dict, ship: Any, table: Any, found: Any) -> None:
    """Sail the ship's turning circle with the table; one that fails is a warning."""
    from ship_gym.config import ConfigError
    from ship_gym.reports import surrogate as report
    from ship_gym.simulation import SimulationDiverged

    try:
        facts["turning_circle"] = report.turning_check(ship, table, found.name)
    except (ConfigError, SimulationDiverged) as error:
        path = found.data.path
        print(f"warning: {path}: {error}; are the signs and units right?", file=sys.stderr)


def _draw(found: Any, ship: Any, facts: dict, plot: Path | None, page: Path | None) -> None:
    """Picture and page, where they are asked for."""
    if plot:
        from ship_gym.plotting import plot_surrogate

        plot_surrogate(ship, plot, found)
    if page:
        from ship_gym.plotting.surrogate_report import write_surrogate_report

        write_surrogate_report(page, found, ship, facts)
