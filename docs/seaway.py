"""Pictures and tables of docs/seaway.md: run ``python docs/seaway.py``. Nothing is tuned here.

The tables between the marks ``<!-- name -->`` and ``<!-- /name -->`` of the page are written anew;
the sentences are not.
"""

from __future__ import annotations

import functools
import math
from pathlib import Path

import numpy as np
from ship_gym_agents.pid import PID

from pages.marks import write_tables
from reproduce import white
from reproduce.headings import HeadingRun, bow_to_waves, plot_headings
from ship_gym import load_ship
from ship_gym.conventions import KNOT, G, N
from ship_gym.evaluation import rollout
from ship_gym.evaluation.controller import ConstantController, Controller
from ship_gym.plotting.seaway import plot_turning_in_waves
from ship_gym.recording import Trajectory
from ship_gym.reports.case import Case, sail_trial
from ship_gym.reports.manoeuvre import wave_share
from ship_gym.reports.measures import difference_text, rows
from ship_gym.sea.sea_states import sea_state
from ship_gym.sea.state import irregular_sea
from ship_gym.simulation import ShipSim, history_columns
from ship_gym.text import table
from ship_gym.writing import check_place

markdown = functools.partial(table, markdown=True)
DOCS = Path(__file__).parent
SEA_STATE, MINUTES = 5, 30.0
WAVES_FROM = (20.0, 60.0, 120.0, 160.0)  # deg
SPEEDS = (0.0, 1.0, 2.0, 4.0, 7.46)  # m/s


def circle_row(case: Case) -> list[str]:
    """Measures of a circle, calm -> waves, and the sizes of the wave forces."""
    t, calm, waves = case.result.trajectory, case.calm.measures(), case.result.measures()
    change = [
        f"{calm[k]:.2f} -> {waves[k]:.2f}" for k in ("advance", "transfer", "tactical_diameter")
    ]
    largest = {k: np.abs(t[f"{k}_wave"]).max() / np.abs(t[f"{k}_rudder"]).max() for k in "YN"}
    share, h = wave_share(case), case.ship.hull
    unit = case.ship.rho * G * case.water.regular.amplitude**2 * h.B**2 / h.L
    return [
        f"{case.ship.name}, {'starboard' if case.delta > 0.0 else 'port'}",
        *change,
        f"{waves['drift_distance']:.2f}",
        f"{math.degrees(waves['drift_direction']) % 360.0:.0f}",
        f"{-t['X_wave'][0] / unit:.2f}",
        f"{share['first']:.0%}",
        f"{share['to_90_deg']:.0%}",
        f"{largest['Y']:.0%}",
        f"{largest['N']:.0%}",
    ]


def trial_rows(names: tuple[str, ...]) -> list[list[str]]:
    """Every trial in waves of the ships: measured, here, in calm water, and by others."""
    cells = []
    for ship in map(load_ship, names):
        for case in (sail_trial(ship, trial) for trial in ship.trials if trial.waves):
            for row in (row for row in rows(case) if row.measured is not None):
                others = ", ".join(f"{row.shown(x)} ({who})" for who, x in row.others.items())
                numbers = [row.shown(x) for x in (row.measured, row.computed, row.calm)]
                label = f"{row.label.strip()} [{row.unit}]"
                cells.append([ship.name, label, *numbers, difference_text(row), others])
    return cells


def heading_runs(controller: Controller) -> list[Trajectory]:
    """KCS on one heading in irregular waves from each direction, without wind and current.

    The heading ordered is called north: ``psi`` of the recordings is the heading error.
    """
    state = sea_state(SEA_STATE)
    overrides = {
        "duration": 60.0 * MINUTES,
        "start.heading_error_deg": 0.0,
        "limits.heading_error_deg": 180.0,
        "sea.current_speed": 0.0,
        "sea.states": [],
        "sea.gusts": False,
        "sea.wave_height": state.height,
        "sea.wave_height_min": state.height,
        "sea.peak_period": state.peak_period,
    }
    runs = []
    for angle in WAVES_FROM:
        given = overrides | {"sea.wave_encounter_deg": 180.0 - angle}
        run = rollout(controller, seeds=[1], overrides=given).trajectory(0)
        runs.append(Trajectory(run.columns | {"psi": run["psi_error"]}, run.meta))
    return runs


def drifting_runs(speed: float, minutes: float) -> list[Trajectory]:
    """KCS with the rudder amidships and constant revolutions in the seas of `heading_runs`.

    Parameters
    ----------
    speed : float
        At first, to the north [m/s]; 0: stopped.
    minutes : float
        How long.
    """
    state, ship = sea_state(SEA_STATE), load_ship("kcs")
    seas = [
        irregular_sea(
            state.height,
            state.peak_period,
            spectrum="bretschneider",
            direction_from=math.radians(angle),
        )
        for angle in WAVES_FROM
    ]
    sim = ShipSim(ship, len(seas), seas)
    commands = np.zeros((sim.n, 2))
    commands[:, 1] = sim.reset(1, speed=speed)[:, N]
    rows = []
    for _ in range(round(60.0 * minutes)):
        before = [a.copy() for a in (sim.time, sim.state, sim.waves)]
        sim.step(commands, 1.0)
        after = [a.copy() for a in (sim.commands, sim.forces, sim.flow)]
        rows.append((*before[:2], *after, before[2]))
    return histories(rows)


def speed_table() -> list[list[str]]:
    """Bow to waves [deg] in the last ten minutes of an hour, by the speed at first."""
    rows = []
    for speed in SPEEDS:
        ends = [
            bow_to_waves(t["psi"], angle)[-600:].mean()
            for angle, t in zip(WAVES_FROM, drifting_runs(speed, 60.0), strict=True)
        ]
        rows.append([f"{speed / KNOT:.1f}", *(f"{end:.0f}" for end in ends)])
    return rows


def histories(rows: list[tuple[np.ndarray, ...]]) -> list[Trajectory]:
    """Recording of each ship from the kept steps: time, state, command, forces, flow, waves."""
    parts = [np.array(part) for part in zip(*rows, strict=True)]
    count = parts[0].shape[1]
    return [Trajectory(history_columns(*(p[:, i] for p in parts)), {}) for i in range(count)]


def heading_table(runs: list[HeadingRun]) -> list[list[str]]:
    """Where the ships end, and how the autopilot holds: over the last ten minutes."""
    rows, last = [], slice(-600, None)
    for run in runs:
        ends = [
            bow_to_waves(t["psi"], run.wave_from_deg)[last].mean() for t in (run.stopped, run.free)
        ]
        held, rudder = (np.degrees(run.steered[k][last]) for k in ("psi", "delta"))
        rows.append(
            [
                f"{run.wave_from_deg:.0f}",
                *(f"{end:.0f}" for end in ends),
                f"{np.abs(held).max():.1f}",
                f"{np.degrees(run.steered['wave_yaw'][last]).std():.2f}",
                f"{rudder.mean():.1f}",
                f"{rudder.std():.1f}",
            ]
        )
    return rows


CIRCLE_HEADER = [
    *("35 deg turn", "advance [L]", "transfer [L]", "tactical diameter [L]"),
    *("drift [L]", "to [deg]", "C_X at first", "wave share at first", "share to 90 deg"),
    *("Y wave / rudder", "N wave / rudder"),
]
TRIAL_HEADER = [
    *("ship", "measure", "measured", "here", "calm water", "difference"),
    "others",
]
HEADING_HEADER = [
    *("waves from [deg]", "stopped: bow to waves [deg]", "rudder amidships: bow to waves [deg]"),
    *("PID: largest heading error [deg]", "wave-frequency yaw, std [deg]"),
    *("PID: rudder, mean [deg]", "std [deg]"),
]

if __name__ == "__main__":
    check_place(DOCS, "docs", folder=True)
    cases = [white.circle(name, side) for name in white.CIRCLES for side in (1, -1)]
    for case in cases[::2]:
        plot_turning_in_waves(case, DOCS / f"seaway_{case.ship.name}.png")
    found = white.findings(cases[2], cases[0], white.kcs_in_calm_water())
    sailed = (drifting_runs(0.0, MINUTES), heading_runs(ConstantController()), heading_runs(PID()))
    runs = [HeadingRun(*parts) for parts in zip(WAVES_FROM, *sailed, strict=True)]
    state = sea_state(SEA_STATE)
    plot_headings(
        runs,
        DOCS / "seaway_heading.png",
        "kcs in an irregular sea: stopped, left to itself, and steered",
        f"sea state {SEA_STATE}: significant height {state.height:g} m, peak period "
        f"{state.peak_period:g} s, long-crested, no wind; moments are minute means; thin "
        "lines: with wave-frequency yaw",
    )
    speeds = ["speed at first [kn]", *(f"waves from {angle:.0f} deg" for angle in WAVES_FROM)]
    made = {
        "circles": markdown(CIRCLE_HEADER, [circle_row(case) for case in cases]),
        "trials": markdown(TRIAL_HEADER, trial_rows(("onrt_model", "kcs_model"))),
        "white": markdown(white.HEADER, white.rows(found)),
        "headings": markdown(HEADING_HEADER, heading_table(runs)),
        "speeds": markdown(speeds, speed_table()),
    }
    write_tables(DOCS / "seaway.md", made)
    print("\n\n".join(made.values()))
    largest = max(np.abs(np.degrees(run.steered["psi"])).max() for run in runs)
    print(f"\nlargest heading error with PID in {MINUTES:.0f} min: {largest:.2f} deg")
