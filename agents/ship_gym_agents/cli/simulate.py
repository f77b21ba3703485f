"""``ship-gym simulate``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import force, out, ship, verb
from ship_gym_agents.cli.values import Name, Number

# what trials do not take: they are sailed as they were measured
_OPTIONS = (
    *("delta_deg", "psi_deg", "speed", "n"),
    *("sea", "wave_height", "wavelength", "wave_from_deg"),
)
# what a captive test does not take: the ship is towed in calm water, and does not sail a course
_SAILED = (
    *("delta_deg", "psi_deg", "order", "wave_height", "wavelength", "wave_from_deg"),
    *("loading", "csv", "rrd"),
)
_HISTORIES = ("csv", "rrd")  # files that are results, not pictures
_LOADING_COLOUR = {"turning_circle": "t", "zigzag": "delta"}


@verb(
    "                                  # KCS model beside its trial",
    "zigzag --ship kvlcc2_model --delta -20",
    "trials --ship kvlcc2_model        # every measured manoeuvre",
    "turning --ship kcs --n 1.5 --sea current --csv runs/turn.csv",
    "--ship kcs --sea ss5 --wave-from 45",
    "stopping --ship kvlcc2             # crash stop beside IMO's limit",
    "spiral --ship kvlcc2_model         # loop width, neutral rudder angle",
    "--ship dtc_model --speed 1.48 --n 15.7 \\\n"
    "      --wave-height 0.112 --wavelength 1.0          # regular waves, beside calm water",
    "captive --ship kvlcc2_model --test drift   # towed: forces of an imposed motion",
    "captive --ship kvlcc2_model --measured tank/pure_yaw.csv",
)
@click.argument(
    "what",
    default="turning",
    metavar="[turning|zigzag|trials|captive|stopping|coasting|acceleration|pull_out|spiral]",
)
@ship(default="kcs_model")
@click.option("--surrogate", help="Propeller and rudder, e.g. G2_SA or none (MMG rudder).")
@click.option("--variant", help="Other published hull set, e.g. hull_a.")
@click.option("--delta", "delta_deg", type=Number(unit="deg"), help="Rudder [deg]; turning 35.")
@click.option("--psi", "psi_deg", type=Number(unit="deg"), help="Zig-zag heading [deg].")
@click.option("--speed", type=Number(unit="m/s"), help="Approach [m/s]; default: the ship's.")
@click.option(
    "--n", type=Number(unit="rev/s"), help="[rev/s]; default: the trial's, else self-propulsion."
)
@click.option("--order", type=Number(unit="rev/s"), help="Astern, of a stop; default: the most.")
@click.option("--sea", type=Name("seas"), default="calm", help="calm, current, ss2 to ss8, ...")
@click.option("--wave-height", type=Number(unit="m"), help="Of a regular wave, 2 x amplitude [m].")
@click.option("--wavelength", type=Number(unit="L"), help="Of a regular wave [ship lengths].")
@click.option(
    "--wave-from",
    "wave_from_deg",
    type=Number(unit="deg"),
    help="Where waves come from [deg]; 0 is north.",
)
@click.option("--test", help="Captive: drift, rudder, yaw, yaw_drift; default: all of them.")
@click.option(
    "--measured", type=click.Path(), help="Captive: CSV file of measured runs, to repeat."
)
@out(".png", "Picture; default: runs/ and the manoeuvre's name.")
@out(".png", "Also draw the propeller loading t'-q'-n'.", "--loading")
@out(".csv", "Also write the time history.", "--csv")
@out(".rrd", "Also write a rerun recording.", "--rrd")
@force()
def command(
    as_json, what, ship, surrogate, variant, out, loading, csv, rrd, force, **options
) -> None:
    """Sail a standard manoeuvre or all trials of a ship.

    Turning circle, zig-zag, crash stop, coasting, acceleration, pull-out or direct spiral. Prints
    measures beside the trial and the IMO limits, and draws a picture; trials are all of the ship
    file, sailed as measured. captive tows the ship as a tank does and prints its forces beside
    those of a file. Angles are in degrees, positive to starboard.
    """
    from ship_gym.reports.handling import KINDS

    files = {"out": out, "loading": loading, "csv": csv, "rrd": rrd}
    if what in KINDS:
        return _handling(as_json, what, ship, (surrogate, variant), files, force, options)
    return _turns(as_json, what, ship, surrogate, variant, files, force, options)


def _check_ship(files: dict[str, Path | None], ship: str, force: bool) -> None:
    """Refuse, before any work, files that hold no manoeuvre of this ship."""
    from ship_gym_agents.cli.replace import check_replaced, manoeuvre

    for name in _HISTORIES:
        check_replaced(files[name], manoeuvre(ship), force, f"--{name}")


def _check_same(files: dict[str, Path | None], case: Any, force: bool) -> None:
    """Refuse, before anything is written, files that hold another manoeuvre than this one."""
    from ship_gym_agents.cli.replace import check_replaced, history

    for name in _HISTORIES:
        check_replaced(files[name], history(case.result.trajectory.meta), force, f"--{name}")


def _numbered(files: dict[str, Path | None], number: str) -> dict[str, Path | None]:
    return {name: path and path.with_stem(path.stem + number) for name, path in files.items()}


def _handling(as_json, what, ship, sets, files, force, options) -> None:
    """Sail, print and draw one of ``reports.handling.KINDS``."""
    from ship_gym.manoeuvres import recording
    from ship_gym.plotting.handling import plot_handling
    from ship_gym.reports import handling
    from ship_gym.ships.loader import load_ship
    from ship_gym_agents.cli.output import need, place, show

    need("matplotlib", *(["rerun"] if files["rrd"] else []))
    for name in ("psi_deg", "test", "measured"):
        _refuse_given(name, options.pop(name), f"it is not of {what}")
    _refuse_given("loading", files["loading"], f"it is not of {what}")
    picture = place(files["out"], Path("runs") / f"{what}.png")
    vessel = load_ship(ship, surrogate=sets[0], variant=sets[1])
    _check_ship(files, vessel.name, force)
    case = handling.sail_handling(vessel, what, **options)
    _check_same(files, case, force)
    history = case.result.trajectory
    jobs = (
        (picture, lambda path: plot_handling(case, path)),
        (files["csv"], history.to_csv),
        (files["rrd"], lambda path: recording(case.result).to_rrd(path)),
    )
    written = [(path, job) for path, job in jobs if path]
    for path, job in written:
        job(path)
    names = [str(path) for path, _ in written]
    text = handling.as_text(case, names, ship) + _next(names)
    show(as_json, handling.as_dict(case) | {"files": names}, text)


def _turns(as_json, what, ship, surrogate, variant, files, force, options) -> None:
    """Sail, print and draw turning circle, zig-zag or trials."""
    from ship_gym.reports import manoeuvre as report
    from ship_gym_agents.cli.output import check_different, need, place, progress, show

    need("matplotlib", *(["rerun"] if files["rrd"] else []))
    out = files["out"]
    check_different(out=out, loading=files["loading"])
    extras = {key: files[key] for key in ("loading", "csv", "rrd")}
    captive = {key: options.pop(key) for key in ("test", "measured")}
    if what == "captive":
        return _captive(as_json, ship, surrogate, variant, out, options | extras, captive)
    for name, value in captive.items():
        _refuse_given(name, value, "belongs to captive")
    vessel, jobs = _jobs(what, ship, surrogate, variant, options)
    numbers = [f"_{k}" for k in range(1, len(jobs) + 1)] if what == "trials" else [""]
    for number in numbers:
        _check_ship(_numbered(files, number), vessel.name, force)
    place(out, Path("runs") / f"{what}.png")  # the folder is the same for all
    cases = [job() for job in progress(jobs, "sailing")]
    sailed = list(zip(cases, numbers, strict=True))
    for case, number in sailed:
        _check_same(_numbered(files, number), case, force)
    written = [_write(case, files, number) for case, number in sailed]
    every = [file for each in written for file in each]
    found = [report.as_dict(c) | {"files": f} for c, f in zip(cases, written, strict=True)]
    data = {"trials": found} if what == "trials" else found[0]
    show(
        as_json,
        data,
        report.all_as_text(cases, written, ship) + _next(every),
    )


def _next(files: list[str]) -> str:
    """A further line on how to see the first recording, if there is one."""
    from ship_gym_agents.cli.review.files import next_review

    recordings = [file for file in files if file.endswith(".rrd")]
    return f"\n      {next_review('show', recordings[0])}" if recordings else ""


def _refuse_given(name: str, value: Any, why: str) -> None:
    """Refuse an option that was given where it means nothing."""
    from ship_gym.config import ConfigError

    if value is not None:
        raise ConfigError(f"{name.removesuffix('_deg')}: {why}; leave it out")


def _captive(as_json, ship, surrogate, variant, out, options: dict, own: dict) -> None:
    """Tow instead of sail."""
    from ship_gym.ships.loader import load_ship
    from ship_gym_agents.cli.captive import captive

    for name in _SAILED:
        _refuse_given(name, options[name], "a captive test is towed in calm water, along no track")
    _refuse_given("sea", None if options["sea"] == "calm" else options["sea"], "captive is calm")
    vessel = load_ship(ship, surrogate=surrogate, variant=variant)
    captive(as_json, vessel, speed=options["speed"], n=options["n"], out=out, **own)


def _jobs(
    what: str, ship: str, surrogate: str | None, variant: str | None, options: dict
) -> tuple[Any, list]:
    """The ship, and what is to be sailed, each as a function without arguments."""
    from ship_gym.config import ConfigError, check_known
    from ship_gym.reports.case import MANOEUVRES, sail, sail_trial, trials
    from ship_gym.reports.handling import KINDS
    from ship_gym.ships.loader import load_ship

    check_known("manoeuvre", what, [*MANOEUVRES, "trials", "captive", *KINDS])
    _refuse_given("order", options.pop("order"), "it is of a crash stop")
    vessel = load_ship(ship, surrogate=surrogate, variant=variant)
    if what != "trials":
        return vessel, [lambda: sail(vessel, what, **options)]
    given = [key for key in _OPTIONS if key != "sea" and options[key] is not None]
    given += ["sea"] if options["sea"] != "calm" else []
    if given:
        raise ConfigError(f"{given[0]}: trials are sailed as measured; leave it out")
    return vessel, [lambda t=t: sail_trial(vessel, t) for t in trials(vessel)]


def _write(case: Any, files: dict[str, Path | None], number: str) -> list[str]:
    """Write the picture and what else was asked for; return the paths, numbered if several."""
    from ship_gym.manoeuvres import recording
    from ship_gym.plotting import plot_manoeuvre
    from ship_gym.plotting.loading import plot_loading
    from ship_gym.plotting.seaway import plot_turning_in_waves
    from ship_gym.reports.manoeuvre import title

    what = {"title": title(case), "colour": _LOADING_COLOUR[case.manoeuvre]}
    history = case.result.trajectory
    in_waves = case.calm is not None and case.manoeuvre == "turning_circle"
    draw = plot_turning_in_waves if in_waves else plot_manoeuvre
    jobs = (
        (files["out"] or Path("runs") / f"{case.manoeuvre}.png", lambda path: draw(case, path)),
        (files["loading"], lambda path: plot_loading(history, case.ship, path, **what)),
        (files["csv"], history.to_csv),
        (files["rrd"], lambda path: recording(case.result).to_rrd(path)),
    )
    paths = [(path.with_stem(path.stem + number), job) for path, job in jobs if path]
    for path, job in paths:
        job(path)
    return [str(path) for path, _ in paths]
