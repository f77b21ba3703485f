"""``ship-gym draw``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import out, ship, verb
from ship_gym_agents.cli.values import Name, Number

_NOTES = """
pictures:
  difference  of two surrogates of a ship over J and drift [% of the local value of --against]
  errors      of a ship's CFD samples by grid and turbulence model, and of their regression
  width       of the 95 % interval of a Gaussian process over J and drift
  path        of a manoeuvre in J and drift over the samples of the surrogate
  shares      of the force components over a turning circle
"""
_OF_A_RUN = ("manoeuvre", "delta_deg", "sea", "wave_height", "wavelength", "wave_from_deg")


@verb(
    "difference --against G3_SA",
    "errors --ship onrt_model",
    "width --noise none        # through the points",
    "path --manoeuvre zigzag --delta 20",
    "shares --ship dtc_model --wave-height 0.112 --wavelength 1.0",
    notes=_NOTES,
)
@click.argument("what", metavar="difference|errors|width|path|shares")
@ship(default="kcs_model")
@click.option("--surrogate", help="Propeller and rudder; default: the ship's.")
@click.option("--against", help="Of difference: the other surrogate, e.g. G3_SA.")
@click.option("--noise", help="Of width: printed (default), computed, none.")
@click.option("--manoeuvre", help="Of path: turning (default) or zigzag.")
@click.option("--delta", "delta_deg", type=Number(unit="deg"), help="Of a manoeuvre: rudder [deg].")
@click.option("--sea", type=Name("seas"), help="Of a manoeuvre: calm (default), ss2 to ss8, ...")
@click.option("--wave-height", type=Number(unit="m"), help="Of a manoeuvre: regular wave [m].")
@click.option("--wavelength", type=Number(unit="L"), help="Of a manoeuvre: its length [L].")
@click.option(
    "--wave-from", "wave_from_deg", type=Number(unit="deg"), help="Where waves come from [deg]."
)
@out(".png", "Picture; default: runs/<picture>.png.")
def command(as_json, what, ship, surrogate, out, **options) -> None:
    """Draw what papers draw of surrogates and of the forces in a turn.

    Prints the numbers behind the picture, too.
    """
    from ship_gym.config import check_known
    from ship_gym_agents.cli.output import need, place, show

    need("matplotlib")
    check_known("picture", what, PICTURES)
    _check_together(what, options)
    path = place(out, Path("runs") / f"{what}.png")
    data = PICTURES[what](ship, surrogate, path, options)
    show(as_json, {**data, "files": [str(path)]}, f"{_text(data)}\n\nwrote {path}")


def _check_together(what: str, options: dict[str, Any]) -> None:
    """Refuse options that are of another picture."""
    from ship_gym.config import ConfigError

    allowed = {"difference": ("against",), "width": ("noise",), "path": _OF_A_RUN}
    allowed["shares"] = tuple(k for k in _OF_A_RUN if k != "manoeuvre")
    wrong = [k for k, v in options.items() if v is not None and k not in allowed.get(what, ())]
    if wrong:
        option = wrong[0].removesuffix("_deg").replace("_", "-")
        raise ConfigError(f"--{option}: is not an option of the picture {what}")
    if what == "difference" and options["against"] is None:
        raise ConfigError("--against: a difference needs another surrogate, e.g. G3_SA")


def _difference(name: str, surrogate: str | None, path: Path, options: dict) -> dict[str, Any]:
    from ship_gym.plotting.surrogate_difference import plot_difference
    from ship_gym.ships.loader import load_ship

    first = load_ship(name, surrogate=surrogate)
    found = plot_difference(first, load_ship(name, surrogate=options["against"]), path)
    return {"unit": "% of the local value, in the trained box", "sides": found}


def _fit(name: str, family: str, noise: str = "printed"):
    """Fit to the project data set of a ship."""
    from ship_gym.config import ConfigError
    from ship_gym.surrogates.fit import Options, fit
    from ship_gym.surrogates.samples import DATA_SETS

    by_ship = {data.ship: data for data in DATA_SETS.values()}
    if name not in by_ship:
        raise ConfigError(f"--ship {name}: has no CFD samples here; known: {', '.join(by_ship)}")
    return fit(by_ship[name], Options(family, noise=noise))


def _errors(name: str, surrogate: str | None, path: Path, options: dict) -> dict[str, Any]:
    from ship_gym.plotting.surrogate_errors import plot_errors

    _no_surrogate(surrogate)
    return {"unit": "%, mean size", "sides": plot_errors(_fit(name, "regression"), path)}


def _width(name: str, surrogate: str | None, path: Path, options: dict) -> dict[str, Any]:
    from ship_gym.plotting.surrogate_errors import plot_width

    _no_surrogate(surrogate)
    found = plot_width(_fit(name, "gp", options["noise"] or "printed"), path)
    sides = {side: {k: {"mean": v} for k, v in maps.items()} for side, maps in found.items()}
    return {"unit": "% of the local value", "sides": sides}


def _no_surrogate(surrogate: str | None) -> None:
    from ship_gym.config import ConfigError

    if surrogate is not None:
        raise ConfigError("--surrogate: this picture fits its own to the ship's samples")


def _sailed(name: str, surrogate: str | None, options: dict):
    """The manoeuvre asked for."""
    from ship_gym.reports.case import sail
    from ship_gym.ships.loader import load_ship

    given = {k: v for k, v in options.items() if k in _OF_A_RUN and v is not None}
    return sail(load_ship(name, surrogate=surrogate), given.pop("manoeuvre", "turning"), **given)


def _path(name: str, surrogate: str | None, path: Path, options: dict) -> dict[str, Any]:
    from ship_gym.plotting.turn import plot_path
    from ship_gym.reports.manoeuvre import title

    case = _sailed(name, surrogate, options)
    found = plot_path(case.result.trajectory, case.ship, path, title(case))
    return {"unit": "share of the time in the trained box", "sides": {"": {"drift at": found}}}


def _shares(name: str, surrogate: str | None, path: Path, options: dict) -> dict[str, Any]:
    from ship_gym.plotting.turn import plot_shares
    from ship_gym.reports.manoeuvre import title

    case = _sailed(name, surrogate, options)
    found = plot_shares(case.result.trajectory, path, title(case))
    what = "share at the end: X of the resistance, Y of the hull's, N of the rudder's"
    return {"unit": what, "sides": {"": found}}


PICTURES = {
    "difference": _difference,
    "errors": _errors,
    "width": _width,
    "path": _path,
    "shares": _shares,
}


def _text(data: dict[str, Any]) -> str:
    """The numbers behind the picture as a table."""
    from ship_gym.text import table

    rows, columns = [], []
    for parts in data["sides"].values():
        for values in parts.values():
            columns += [k for k in values if k not in columns]
    for side, parts in data["sides"].items():
        label = "" if side in ("", "single") else f", {side}"
        for name, values in parts.items():
            numbers = (f"{values[k]:.3g}" if k in values else "" for k in columns)
            rows.append([name + label, *numbers])
    return f"[{data['unit']}]\n{table(['', *columns], rows)}"
