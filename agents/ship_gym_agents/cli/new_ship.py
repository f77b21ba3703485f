"""``ship-gym new-ship``."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli import options
from ship_gym_agents.cli.values import Name

# particular -> its help; their ranges, and what is needed, are in ``ships.new_ship``
_PARTICULARS = {
    "L": "Length between perpendiculars [m]; needed.",
    "B": "Beam at the waterline [m]; needed.",
    "d": "Draught [m]; needed.",
    "C_b": "Block coefficient; needed, or --volume.",
    "volume": "Displacement volume [m3].",
    "speed": "Service speed [m/s], or as in 15kn; needed.",
    "x_G": "Centre of gravity forward of midship [m].",
    "D_P": "Diameter of the propeller [m].",
    "z": "Its blades; with z, P/D or area it is one of the Wageningen B-series.",
    "pitch_ratio": "Its P/D.",
    "area_ratio": "Its AE/A0.",
    "propellers": "1 or 2; with two also two rudders.",
    "A_R": "Area of a rudder [m2].",
    "n_max": "Largest propeller speed [rev/s], or as in 90rpm.",
}


def _particulars(function):
    for key, text in reversed(_PARTICULARS.items()):
        # a text here: all that is wrong with the particulars is told at once, by `new_ship`
        option = click.option(f"--{key}", key, metavar="NUMBER", help=text)
        function = option(function)
    return function


@options.verb(
    "tanker --like kvlcc2 --L 246 --B 46 --d 14.5 --C_b 0.82 --speed 7.7",
    "ferry --like kcs --propellers 2 --L 160 --B 25 --d 6.2 --C_b 0.58 --speed 10 --D_P 4.6 --z 4",
    "tanker --like kvlcc2 --L 246 --B 46 --d 14.5 --volume 134500 --speed 15kn "
    "--set form.KG=12.5 hull.k_zz=60",
)
@click.argument("name", type=click.Path(path_type=Path))
@click.option("--like", type=Name("ships"), default="kvlcc2", help="Ship or file that it is like.")
@_particulars
@click.option(
    "--set",
    "fixed",
    cls=options.Several,
    metavar="KEY=NUMBER",
    help="Any other number of the ship file, in SI or with its unit, as in form.KG=12.5 "
    "gear.delta_max=45deg; several.",
)
@click.option(
    "--no-strict",
    "loose",
    is_flag=True,
    help="A ship like no published one: what is out of range is a warning, and her circle may be "
    "of any width (strict = false).",
)
@options.force()
def command(as_json, name, like, fixed, loose, force, **given) -> None:
    """Write the file of a ship of your own from her particulars.

    What is not given is estimated, and says so in NAME/ship.toml: by dimension from the ship that
    it is like, or by published regressions where the two differ by more than 10 % in L/B, B/d or
    C_b.
    """
    import dataclasses

    from ship_gym.ships.doubts import doubts
    from ship_gym.ships.loader import load_ship
    from ship_gym.ships.new_ship import new_ship, number_of, unit_of
    from ship_gym.ships.write_ship import ship_text
    from ship_gym.writing import atomic_path
    from ship_gym_agents.cli.output import show

    path = _place(name, force)
    given = {k: number_of(text, unit_of(k)) for k, text in given.items() if text is not None}
    ship = new_ship(like, path.parent.resolve().name, given, _pairs(fixed))
    ship, no_form = _sailing(dataclasses.replace(ship, strict=not loose))
    doubtful = doubts(ship, load_ship(like, surrogate="none"))
    text = ship_text(ship, "given to ship-gym new-ship", doubtful)
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_path(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    build = _build(path, bool(no_form))
    facts = {"file": str(path), "estimated": ship.estimated, "no_form": no_form}
    facts |= {"implausible": ship.implausible, "doubtful": doubtful, "next": build}
    show(as_json, facts, _text(ship, path, no_form, build, doubtful))


def _place(folder: Path, force: bool) -> Path:
    """The ship file to write."""
    from ship_gym.config import ConfigError
    from ship_gym.writing import check_place

    path = folder / "ship.toml"
    if path.exists() and not force:
        raise ConfigError(f"{path}: is there already; see --force")
    return check_place(path, "NAME")


def _pairs(given: Sequence[str]) -> dict[str, Any]:
    """Pairs KEY=NUMBER."""
    from ship_gym.ships.new_ship import number_of, unit_of

    split = [pair.partition("=") for pair in given]
    return {key.strip(): number_of(text, unit_of(key.strip())) for key, _, text in split}


def _sailing(ship: Any) -> tuple[Any, str]:
    """The ship, refused with a line for everything that is wrong with her; why she has no form."""
    from ship_gym.seakeeping.estimated_form import with_estimated_form
    from ship_gym.ships.plausible import checked
    from ship_gym.simulation import ShipSim

    with _way_out(ship.strict):
        ship, no_form = with_estimated_form(checked(ship))
        ship = checked(ship)
        ShipSim(ship, n=1)  # which lets her sail a few runs
    return ship, no_form


@contextlib.contextmanager
def _way_out(strict: bool) -> Iterator[None]:
    """Name the option where an error names the line of a ship file."""
    from ship_gym.config import ConfigError

    try:
        yield
    except ConfigError as error:
        text = str(error)
        raise ConfigError(
            text.replace("strict = false", "--no-strict") if strict else text
        ) from None


def _build(path: Path, mesh: bool) -> str:
    """The command for the wave table."""
    from ship_gym_agents.cli.output import next_command

    build = next_command("build-wave-table", ship=path)
    return f"{build}{' --mesh HULL_FILE' if mesh else ''} --quick"


def _text(ship: Any, path: Path, no_form: str, build: str, doubtful: Sequence[str]) -> str:
    from ship_gym_agents.cli.output import next_command

    h = ship.hull
    lines = [
        f"wrote {path}: L {h.L:.5g} m, B {h.B:.5g} m, d {h.d:.5g} m, {h.volume:.5g} m3",
        f"{len(ship.estimated)} numbers are estimated (load_ship({str(path)!r}).describe()); "
        "replace those that you know",
    ]
    lines += [f"doubtful: {line}" for line in doubtful]
    lines += [f"of no ship: {line}" for line in ship.implausible]
    if no_form:
        lines.append(f"no [form] to draw a hull from ({no_form}): waves need a hull file")
    lines += [
        f"next: {build}",
        f"then: gym.make('ShipGym/HeadingKeeping-v0', ship={str(path)!r})",
        f"and:  {next_command('tune', ship=path)}",
    ]
    return "\n".join(lines)
