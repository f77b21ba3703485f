"""What Knight (2021) states in words or prints in tables, each met or measured as a gap.

Where the thesis contradicts itself, the case says so and holds the size of the contradiction.
"""

import dataclasses
import functools
import math
from collections.abc import Callable

import numpy as np
import pytest

from reproduce import families
from reproduce.measured_cells import implied_normal_force
from reproduce.measured_motion import CALM
from ship_gym.surrogates.base import mean_size
from ship_gym.surrogates.error_budget import grid_errors, turbulence_errors
from ship_gym.surrogates.fit import Options, fit
from ship_gym.surrogates.samples import DATA_SETS, KCS, LEEWARD, ONRT, SINGLE, WINDWARD

SIDES = {"port": LEEWARD, "starboard": WINDWARD}  # of the thesis' turn to port


@dataclasses.dataclass(frozen=True)
class Finding:
    """A statement of the thesis: where, what, our number and the range that meets it."""

    place: str
    what: str
    compute: Callable[[], float]
    low: float
    high: float = math.inf


def regression_error(grid, quantity, data=KCS, side=SINGLE):
    return mean_size(np.array(fit(data, None, grid, "SA").errors(side)[quantity]))


@functools.cache
def process(noise, name):
    """All quantities of both sides: one fit for all findings."""
    return fit(DATA_SETS[name], Options("gp", noise=noise))


def process_error(noise, quantity, data=KCS, side=SINGLE):
    return mean_size(np.array(process(noise, data.name).errors(side)[quantity]))


def of_grid(grid, quantity, data=KCS, side=SINGLE, last=12):
    return mean_size(grid_errors(data, quantity, side, grid, range(1, last + 1)))


def of_turbulence(quantity, grid="G2", data=KCS, side=SINGLE):
    points = data.validation if data is KCS else data.training
    return mean_size(turbulence_errors(data, quantity, side, grid, points))


def efficiency_gain(point):
    """How much less efficient SA is than SST at a point, mean of the grids [%], Eq. 3.5."""
    mean = {}
    for model in ("SA", "SST"):
        picked = [KCS.read(grid, model).pick((point,)) for grid in ("G1", "G2", "G3")]
        mean[model] = np.mean([s.values["K_T"][0] / s.values["10K_Q"][0] for s in picked])
    return 100.0 * (1.0 - mean["SA"] / mean["SST"])


def mean_force(grid, quantity, side):
    return float(ONRT.read(grid, "SA", SIDES[side]).values[quantity].mean())


def surface_gap(grid, quantity):
    """Mean difference of a regression to that on G3 over the box, Eq. 3.8 [%]."""
    J, beta = np.meshgrid(np.linspace(0.2, 0.9, 15), np.radians(np.linspace(0.0, 45.0, 15)))
    X = np.stack([J.ravel(), beta.ravel()], axis=1)
    fine, coarse = (
        fit(KCS, None, g, "SA").models[SINGLE][quantity].predict(X)[0] for g in ("G3", grid)
    )
    return 100.0 * float(np.abs((fine - coarse) / fine).mean())


def less(*values):
    """Smallest step of a rising sequence."""
    return float(np.diff(values).min())


REGRESSIONS = [
    Finding(
        "3.2.4",
        f"mean error of {quantity} below {limit} % on every grid",
        lambda q=quantity: max(regression_error(g, q) for g in ("G1", "G2", "G3")),
        0.0,
        limit,
    )
    for quantity, limit in (("K_T", 4.0), ("10K_Q", 3.0), ("C_Fx", 5.0), ("C_Fy", 7.0))
]
REGRESSIONS += [
    Finding(
        "3.2.4",
        f"{quantity}: 8 points on {best} are the best model",
        lambda q=quantity, b=best: (
            min(regression_error(g, q) for g in ("G1", "G2", "G3") if g != b)
            - regression_error(b, q)
        ),
        0.0,
    )
    for quantity, best in (("K_T", "G2"), ("10K_Q", "G2"), ("C_Fy", "G3"))
]
ERRORS = [
    *(
        Finding(
            "3.2.2",
            f"{quantity}, {grid}: the turbulence model matters more than the grid",
            lambda q=quantity, g=grid: of_turbulence(q, g) - of_grid(g, q, last=4),
            0.0,
        )
        for quantity in ("K_T", "10K_Q")
        for grid in ("G1", "G2")
    ),
    Finding(
        "3.2.4",
        "C_Fy on G1: the grid dominates",
        lambda: of_grid("G1", "C_Fy", last=4) - of_turbulence("C_Fy", "G1"),
        0.0,
    ),
    Finding(
        "3.2.2", "SA is 3.76 % less efficient at point 3", lambda: efficiency_gain(3), 3.6, 3.9
    ),
    Finding(
        "3.2.5",
        "K_T over the box: G1 is further from G3 than G2 is",
        lambda: surface_gap("G1", "K_T") - surface_gap("G2", "K_T"),
        0.0,
    ),
    Finding(
        "B.2",
        "C_Fx to starboard: G1 is nearer to G3 than G2 is",
        lambda: less(*(of_grid(g, "C_Fx", ONRT, WINDWARD) for g in ("G1", "G2"))),
        0.0,
    ),
    Finding(
        "5.2.2",
        "K_X: the turbulence models part more to port",
        lambda: less(*(of_turbulence("K_X", data=ONRT, side=s) for s in (WINDWARD, LEEWARD))),
        0.0,
    ),
]
MEANS = [
    Finding(
        "5.2.1",
        f"mean K_S to {side} on {grid} is {printed}",
        lambda s=side, g=grid: mean_force(g, "K_S", s),
        printed - 0.001,
        printed + 0.001,
    )
    for side, values in (("port", (0.041, 0.043, 0.041)), ("starboard", (0.067, 0.069, 0.070)))
    for grid, printed in zip(("G1", "G2", "G3"), values, strict=True)
]
PROCESS = [
    # of C_Fx and C_Fy the thesis means the movable part; ours are of the whole rudder
    *(
        Finding(
            "3.2.5",
            f"{quantity}: regression better than the process, that better without noise",
            lambda q=quantity: less(
                regression_error("G2", q), process_error("none", q), process_error("printed", q)
            ),
            0.0,
        )
        for quantity in KCS.quantities
    ),
    *(
        Finding(
            "5.3.4",
            f"C_Fx to {side}: regression better than the process without noise",
            lambda s=side: less(
                regression_error("G2", "C_Fx", ONRT, SIDES[s]),
                process_error("none", "C_Fx", ONRT, SIDES[s]),
            ),
            0.0,
        )
        for side in SIDES
    ),
    Finding(
        "5.3.4",
        "C_Fy to starboard: regression better than the process",
        lambda: less(
            regression_error("G2", "C_Fy", ONRT, WINDWARD),
            process_error("none", "C_Fy", ONRT, WINDWARD),
        ),
        0.0,
    ),
    Finding(
        "5.3.4",
        "C_Fy to port: process better than the regression",
        lambda: less(
            process_error("none", "C_Fy", ONRT, LEEWARD),
            regression_error("G2", "C_Fy", ONRT, LEEWARD),
        ),
        0.0,
    ),
]
CONTRADICTIONS = [
    Finding(
        "5.2.1",
        "K_X is said to be larger to port; its tables, and 5.2.2, have it larger to starboard",
        lambda: mean_force("G3", "K_X", "starboard") / mean_force("G3", "K_X", "port"),
        1.18,
        1.21,
    ),
    Finding(
        "B.2",
        "K_S to port, G1: 18.0 % in the text, 8.8 from the forces, 7.4 by Table B.2",
        lambda: of_grid("G1", "K_S", ONRT, LEEWARD),
        8.7,
        8.9,
    ),
    Finding(
        "3.15",
        "its errors go with a measured F_N of 2.926 N, Table 3.12 has 2.923",
        lambda: implied_normal_force(CALM),
        2.9255,
        2.9270,
    ),
]
FINDINGS = [*REGRESSIONS, *ERRORS, *MEANS, *PROCESS, *CONTRADICTIONS]


@pytest.mark.parametrize("finding", FINDINGS, ids=lambda f: f"{f.place}: {f.what}")
def test_finding(finding):
    assert finding.low <= finding.compute() <= finding.high


@pytest.fixture(scope="module")
def turns():
    return {row["case"]: row for row in families.table_4_3()}


@pytest.mark.slow
@pytest.mark.parametrize("case", [row[0] for row in families.TABLE_4_3])
def test_turns_are_within_4_percent_of_the_cfd_of_table_4_3(turns, case):
    """A gap: transfer and diameter on G3 are 4.2 % wider.

    His CFD has no thrust shifted to the tank and no t_R (docs/turning_circle_speed.md).
    """
    gaps = {("G3", "max_transfer"): 0.042, ("G3", "steady_diameter"): 0.042}
    for measure, printed in turns[case]["printed"].items():
        off = turns[case]["ours"][measure] / printed - 1.0
        if (case, measure) in gaps:
            assert off == pytest.approx(gaps[case, measure], abs=0.003)
        else:
            assert abs(off) < 0.04, measure


@pytest.mark.slow
def test_more_revolutions_turn_tighter_and_faster(turns):
    """Section 4.2.3; G3 turns tightest and slowest, k-omega SST widest and fastest."""
    by_n = [turns[case] for case in ("G2", "G2, n = 10.6", "G2, n = 10.8")]
    assert less(*(row["speed_ratio"] for row in by_n)) > 0.0
    assert less(*(-row["ours"]["max_advance"] for row in by_n)) > 0.0
    order = [turns[case] for case in ("G3", "G2", "G2 k-omega SST")]
    for measure in ("max_advance", "max_transfer", "steady_diameter"):
        assert less(*(row["ours"][measure] for row in order)) > 0.0
    assert less(*(row["speed_ratio"] for row in order)) > 0.0
