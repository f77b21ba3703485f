"""Whether the forces of samples have the size of their ship's, and every angle its unit.

Two ratios, each the median over all points of all rudders, so that one odd point moves neither. The
eight sets of samples of the package (KCS and ONRT, four CFD models each) give:

- normal force by that of the effective-inflow law (YY15) with the ship's own rudder at the same
  inflow: 0.75 to 1.00 (KCS, one screw) and 0.45 to 0.53 (ONRT, two). Usual is called 0.35 to 1.27:
  those eight with a quarter to spare on either side. A factor of 3 or 1/3 takes each of them out of
  it (to 1.33 and more, to 0.33 and less).
- thrust by that of open water in the wake at the same J: 0.85 to 1.14. Usual is called 0.6 to 1.8;
  a factor of 3 makes it 2.5 and more, 1/3 makes it 0.38 and less.

Outside them there is a warning, no error: a flap or a stalled rudder may be there rightly.

One angle in radians among degrees is found by the forces. With each angle above 8 deg of those
samples changed in turn 92 % are found; the rest lie off the surface anyway. A right angle below
1.6 deg is suspected now and then, at 0.2 deg by every second one: again only a warning.
"""

from __future__ import annotations

import math

import numpy as np

from ship_gym.physics.propeller import wake
from ship_gym.ships.open_water import coefficients
from ship_gym.ships.particulars import Ship
from ship_gym.ships.records import fleet
from ship_gym.surrogates.effective_inflow import RudderSamples, law_coefficients, rudder_frame
from ship_gym.surrogates.row_checks import lines
from ship_gym.surrogates.samples import DataSet, Samples

RUDDER_BAND = (0.35, 1.27)  # see above
THRUST_BAND = (0.6, 1.8)
_RADIANS = math.radians(0.5 * math.pi)  # what 90 deg in rad is if it is read as degrees
_BEYOND = 1.2  # times the largest angle of the others
_FEWEST = 4  # other points, through which the plane goes


def force_ratios(data: DataSet, ship: Ship, sides: list[Samples]) -> tuple[float, float]:
    """Medians of normal force by the rudder law's, and of thrust by that of open water.

    Parameters
    ----------
    data : DataSet
    ship : Ship
        Without surrogate.
    sides : list of Samples
        Of each propeller and its rudder.
    """
    record = fleet([ship]).records[0]
    rudder, thrust = [], []
    for samples in sides:
        J, beta = samples.X.T[:2]
        delta = samples.delta(data.delta)
        K_T, C_Fx = samples.values[data.thrust], samples.values["C_Fx"]
        given = RudderSamples(
            J, beta, np.maximum(K_T, 0.0), C_Fx, data.sign * samples.values["C_Fy"], delta,
            ship.rudder.A_R,
        )  # fmt: skip
        C_N, _ = rudder_frame(given.C_Fx, given.C_Fy, delta)
        rudder.append(_ratio(C_N, law_coefficients(given, record)))
        ratio = np.array([wake((1.0, angle), 0.0, record.propeller) for angle in beta])
        thrust.append(_ratio(K_T, coefficients(ship.open_water, ratio * J)[0]))
    return float(np.median(np.concatenate(rudder))), float(np.median(np.concatenate(thrust)))


def _ratio(given: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Given by expected, where a force is expected; without any, 1."""
    there = expected > 1e-2
    return given[there] / expected[there] if there.any() else np.ones(1)


def unusual_sizes(data: DataSet, ship: Ship, sides: list[Samples]) -> list[str]:
    """Warnings of forces in another normalisation than `own` describes."""
    rudder, thrust = force_ratios(data, ship, sides)
    found = []
    if not RUDDER_BAND[0] <= rudder <= RUDDER_BAND[1]:
        found.append(
            f"{data.path}: C_Fx, C_Fy: normal force {rudder:.2f} times that of the rudder law with "
            f"the ship's A_R = {ship.rudder.A_R:.4g} m2, usual is {RUDDER_BAND[0]:g} to "
            f"{RUDDER_BAND[1]:g}: are they over 1/2 rho u_R^2 A_R, of one rudder?"
        )
    if not THRUST_BAND[0] <= thrust <= THRUST_BAND[1]:
        found.append(
            f"{data.path}: {data.thrust}: {thrust:.2f} times the open-water thrust in the wake, "
            f"usual is {THRUST_BAND[0]:g} to {THRUST_BAND[1]:g}: is it over rho n^2 D^4, and J of "
            "the ship's speed?"
        )
    return found


def stray_radians(samples: Samples, data: DataSet) -> list[str]:
    """Single angles that look like radians among degrees.

    One of up to 1.57 deg does if thrust and side force lie nearer to the plane over J and beta
    through the other points at the angle that it has when it is read as radians, and if that is an
    angle among theirs.
    """
    J, beta = samples.X.T[:2]
    small = (np.abs(beta) <= _RADIANS) & (beta != 0.0)
    if len(data.angles) > 1 or not small.any() or np.count_nonzero(~small) < _FEWEST:
        return []
    values = np.stack([samples.values[data.thrust], samples.values["C_Fy"]], axis=1)
    plane, *_ = np.linalg.lstsq(_plane(*samples.X[~small].T), values[~small], rcond=None)
    scale = np.ptp(values[~small], axis=0) + 1e-9

    def misfit(angles: np.ndarray) -> np.ndarray:
        gap = _plane(J[small], angles) @ plane - values[small]
        return np.linalg.norm(gap / scale, axis=1)

    meant = np.degrees(beta[small])  # the number in the file, in rad
    among = np.abs(meant) <= _BEYOND * np.abs(beta[~small]).max()
    wrong = among & (misfit(meant) < misfit(beta[small]))
    if not wrong.any():
        return []
    angles = ", ".join(f"{math.degrees(angle):.1f}" for angle in meant[wrong])
    return [
        f"{samples.path}: {lines(samples.rows[small][wrong])}: drift looks like radians: the "
        f"forces go better with {angles} deg"
    ]


def _plane(J: np.ndarray, beta: np.ndarray) -> np.ndarray:
    return np.stack([np.ones_like(J), J, beta], axis=1)
