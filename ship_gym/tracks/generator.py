"""Random tracks that a ship can sail, from a fixed number of uniform draws.

With turning radius R a change of course D begins R tan(|D| / 2) before the way-point and ends as
far behind it. The legs are drawn first; then each turn may use half of both its legs, and of the
first and the last leg all, less `margin`. The turn is drawn inside that limit, so nothing is
rejected and every draw is used once.

Distribution: leg lengths are independent and uniform in [leg_min, leg_max]. Given the lengths, the
changes of course are independent and uniform in [-limit, limit], the limit being `turn_max` or
less beside a short leg. So turns are symmetric to both sides and thin out towards `turn_max`. With
the defaults an inner turn has the full 90 deg with probability 4/9 (both legs at least 7 L) and
never a limit below 36.9 deg. A track may cross itself; nothing prevents that.
"""

from __future__ import annotations

import math

import numpy as np

from ship_gym.config import ConfigError, check_angle, check_number, shown
from ship_gym.tracks.track import SHARPEST_TURN

MARGIN = 1.0  # straight part that is left on every leg [L]


def n_draws(legs: int) -> int:
    """Number of uniform draws of a track of `legs` legs: a length each and the turns between."""
    if isinstance(legs, bool) or not isinstance(legs, int | np.integer) or legs < 1:
        raise ConfigError(f"legs = {shown(legs)}: must be a whole number, at least 1")
    return 2 * int(legs) - 1


def random_points(
    uniform: np.ndarray,
    turn_radius: float = 3.0,
    leg_min: float = 3.0,
    leg_max: float = 15.0,
    turn_max: float = math.radians(90.0),
    margin: float = MARGIN,
) -> np.ndarray:
    """Way-points of m random tracks, in ship lengths; every turn fits between its neighbours.

    For every leg: length >= R (tan(|D_before| / 2) + tan(|D_after| / 2)) + margin.

    Parameters
    ----------
    uniform : numpy.ndarray, shape (m, n_draws(legs))
        Uniform numbers in [0, 1): length, turn, length, turn, ... length.
    turn_radius : float
        Turning radius R [L].
    leg_min, leg_max : float
        Range of the leg lengths [L].
    turn_max : float
        Largest change of course [rad].
    margin : float
        Straight part that is left on every leg [L].

    Returns
    -------
    numpy.ndarray, shape (m, legs + 1, 2)
        North and east [L]; the first point is the origin, the first leg goes north. A row depends
        on its own draws only, to the last bit, whatever m is.

    Raises
    ------
    ConfigError
        A shape that fits no number of legs, numbers outside [0, 1), a leg not above the margin.
    """
    uniform = _checked_uniform(uniform)
    check_number("turn_radius", turn_radius, 1e-3, 1e3, "L")
    check_number("margin", margin, 0.0, 1e3, "L")
    check_number("leg_min", leg_min, 1e-3, 1e4, "L")
    check_number("leg_max", leg_max, leg_min, 1e4, "L")
    if not (leg_min > margin and 0.0 <= check_angle("turn_max", turn_max, SHARPEST_TURN)):
        raise ConfigError(
            f"leg_min = {leg_min} L must be above margin = {margin} L, and turn_max = {turn_max} "
            "rad not negative"
        )
    lengths = leg_min + (leg_max - leg_min) * uniform[:, 0::2]
    limits = _turn_limits(lengths - margin, turn_radius, turn_max)
    turns = (2.0 * uniform[:, 1::2] - 1.0) * limits
    return _points(lengths, turns)


def _checked_uniform(uniform: np.ndarray) -> np.ndarray:
    uniform = np.asarray(uniform, dtype=np.float64)
    if uniform.ndim != 2 or uniform.shape[1] % 2 == 0:
        raise ConfigError(
            f"uniform: has shape {uniform.shape}, but must have (m, n_draws(legs)), an odd number"
        )
    if not ((uniform >= 0.0) & (uniform < 1.0)).all():
        raise ConfigError("uniform: must be numbers in [0, 1)")
    return uniform


def _turn_limits(room: np.ndarray, turn_radius: float, turn_max: float) -> np.ndarray:
    """Largest change of course [rad] at the inner way-points, (m, legs - 1).

    `room` (m, legs) is what turns may use of each leg [L]; two turns share an inner leg by halves.
    """
    share = room.copy()
    share[:, 1:-1] *= 0.5
    tangent = np.minimum(share[:, :-1], share[:, 1:]) / turn_radius
    return np.minimum(turn_max, 2.0 * np.arctan(tangent))


def _points(lengths: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Way-points (m, legs + 1, 2) from legs (m, legs) and turns (m, legs - 1).

    Leg by leg, not by a sum along an axis: numpy chooses the order of a sum by the shape.
    """
    m, legs = lengths.shape
    points, bearing = np.zeros((m, legs + 1, 2)), np.zeros(m)
    for leg in range(legs):
        if leg > 0:
            bearing = bearing + turns[:, leg - 1]
        # math, not numpy: the last bit of numpy's cosine may depend on where in a vector it is
        cos, sin = (np.array([f(b) for b in bearing.tolist()]) for f in (math.cos, math.sin))
        points[:, leg + 1, 0] = points[:, leg, 0] + lengths[:, leg] * cos
        points[:, leg + 1, 1] = points[:, leg, 1] + lengths[:, leg] * sin
    return points
