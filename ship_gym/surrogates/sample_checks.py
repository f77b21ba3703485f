"""Whether samples can carry the model asked for, and whether anything in them looks like a slip."""

from __future__ import annotations

import math

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.ships.files import Named
from ship_gym.ships.loader import bare
from ship_gym.ships.open_water import coefficients
from ship_gym.ships.particulars import Ship
from ship_gym.surrogates.fit import Options
from ship_gym.surrogates.force_checks import stray_radians, unusual_sizes
from ship_gym.surrogates.regression import FEATURES
from ship_gym.surrogates.row_checks import lines, side_signs
from ship_gym.surrogates.samples import DataSet, Samples

_PLANE = ((0, 0), (1, 0), (0, 1))  # powers of J and beta; less than a plane cannot be fitted
# What a model fits: twice as many points should be there. A process has a constant, a standard
# deviation and two length scales; a network is counted by its inputs.
_FITTED = {"gp": 4, "nn": len(FEATURES["network"])}
_MOST_CONDITION = 30.0  # of the scaled features; 6.0 for the eight points of the thesis
_OBLIQUE = math.radians(15.0)
_USUAL_DRIFT = math.radians(60.0)
_LOOKS_LIKE_RADIANS = math.radians(1.6)
_MOST_EFFICIENCY = 1.5  # J K_T / (2 pi K_Q) with the ship's speed; above it K_Q is not 10 K_Q


def check_samples(
    data: DataSet,
    ship: Named | Ship,
    options: Options | None = None,
    grid: str | None = None,
    turbulence: str = "",
) -> list[str]:
    """Check that samples can carry the model asked for.

    Parameters
    ----------
    data : DataSet
    ship : Ship, or its name or file
        Without surrogate.
    options, grid, turbulence
        As in `fit.fit`.

    Returns
    -------
    list of str
        Warnings with file and lines; empty if there is nothing to say.

    Raises
    ------
    ConfigError
        Too few training points for the model, or points on one line or at the same places.
    """
    options, ship = options or Options(), bare(ship)
    if grid is None:
        grid, turbulence = data.choices[0] if data.choices else ("", "")
    found: list[str] = []
    rudders = [data.read(grid, turbulence, side) for side in data.sides]
    for samples in rudders:
        training = samples.pick(data.training)
        found += _spread(training, options)
        found += _unusual(samples, ship, data)
        found += stray_radians(samples, data)
        found += _twice(samples)
    found += unusual_sizes(data, ship, rudders)
    found += _sides(data, grid, turbulence)
    return list(dict.fromkeys(found))


def _sides(data: DataSet, grid: str, turbulence: str) -> list[str]:
    """Two propellers that look exchanged: drift unloads the rudder to windward."""
    if len(data.sides) < 2:
        return []
    leeward, windward = (data.read(grid, turbulence, side) for side in data.sides)
    outer, inner = (np.median(np.abs(s.values["C_Fy"])) for s in (windward, leeward))
    if outer <= inner or np.abs(leeward.X[:, 1]).max() < math.radians(10.0):
        return []
    return [f"{data.path}: the rudder to windward carries more than the other: sides exchanged?"]


def _spread(training: Samples, options: Options) -> list[str]:
    """Refuse too few or collinear points; warn of few and clustered ones."""
    where = f"{training.path}: {lines(training.rows)}"
    regression, n = options.family == "regression", len(training.points)
    powers = FEATURES[options.order] if regression else _PLANE
    needed = len(powers)
    name = f"{options.order} order regression" if regression else options.family
    if n < needed:
        raise ConfigError(f"{where}: {n} training points, but the {name} needs {needed}")
    place = training.X[:, :2]  # J and beta, whatever the rudder
    matrix = _scaled_features(place, powers)
    if np.linalg.matrix_rank(_scaled_features(place, _PLANE), tol=1e-6) < len(_PLANE):
        raise ConfigError(f"{where}: collinear: all points lie on one line in the J-beta plane")
    if np.linalg.matrix_rank(matrix, tol=1e-6) < needed:
        raise ConfigError(
            f"{where}: {n} points at {len(np.unique(place, axis=0))} places do not span the "
            f"{needed} features of the {name}: they lie on too few lines of J and beta"
        )
    found = []
    condition = float(np.linalg.cond(matrix))
    if condition > _MOST_CONDITION:
        found.append(
            f"{where}: points clustered or nearly collinear in the J-beta plane: condition number "
            f"{condition:.0f} of the scaled features, usual is below {_MOST_CONDITION:.0f}"
        )
    fitted = needed if regression else _FITTED[options.family] + training.X.shape[1] - 2
    if n < 2 * fitted:
        found.append(
            f"{where}: {n} training points for the {fitted} numbers of the {name}; "
            f"{2 * fitted} would average out their noise"
        )
    return found


def _scaled_features(X: np.ndarray, powers: tuple[tuple[int, int], ...]) -> np.ndarray:
    """Features of J and beta scaled to [-1, 1], each column of length 1."""
    low, span = X.min(axis=0), np.ptp(X, axis=0)
    x, y = (2.0 * (X - low) / np.where(span > 0.0, span, 1.0) - 1.0).T
    matrix = np.stack([x**i * y**j for i, j in powers], axis=1)
    length = np.linalg.norm(matrix, axis=0)
    return matrix / np.where(length > 0.0, length, 1.0)


def _unusual(samples: Samples, ship: Ship, data: DataSet) -> list[str]:
    """Samples that are possible, but look like a slip."""
    J, beta = samples.X.T[:2]
    thrustless = _thrustless(ship)
    checks = [
        (np.abs(beta) > _USUAL_DRIFT, f"drift beyond {math.degrees(_USUAL_DRIFT):.0f} deg"),
        (J > thrustless, f"J above {thrustless:.2f}, where the propeller has no thrust"),
        (samples.values[data.thrust] <= 0.0, f"{data.thrust} is not positive"),
        (samples.values["C_Fx"] >= 0.0, "C_Fx >= 0: the rudder pushes the ship ahead"),
    ]
    if len(data.angles) < 2:  # with the rudder a little over, drift may turn the force round
        other = side_signs(samples.values["C_Fy"], data.sign) < 0
        checks.append((other, "C_Fy to the other side than most"))
    if np.abs(beta).max() < _LOOKS_LIKE_RADIANS:
        checks.append(
            (np.ones(len(beta), dtype=bool), "drift below 1.6 deg everywhere looks like radians")
        )
    if "K_S" in samples.values:
        # the flow across the propeller pushes it with it: to starboard in a turn to starboard
        with_it = data.sign * samples.values["K_S"] * np.sign(beta) <= 0.0
        against = ~with_it & (np.abs(beta) > _OBLIQUE)
        checks.append((against, "K_S pushes against the cross flow: is its sign right?"))
    if "10K_Q" in samples.values:
        ratio = J * samples.values[data.thrust] * 10.0
        high = ratio > _MOST_EFFICIENCY * 2.0 * math.pi * np.abs(samples.values["10K_Q"])
        checks.append((high, "more thrust power than shaft power: is 10K_Q ten times K_Q?"))
    return [
        f"{samples.path}: {lines(samples.rows[wrong])}: {text}"
        for wrong, text in checks
        if any(wrong)
    ]


def _thrustless(ship: Ship) -> float:
    """J of the ship's speed at which its open-water thrust behind the wake vanishes."""
    J = np.linspace(0.0, 3.0, 601)
    K_T, _ = coefficients(ship.open_water, J)
    ahead = J[K_T > 0.0]
    return float(ahead.max() / (1.0 - ship.propeller.w_P0)) if len(ahead) else math.inf


def _twice(samples: Samples) -> list[str]:
    """Points with the same place; `row_checks` has made sure that they have the same values."""
    _, first, count = np.unique(samples.X, axis=0, return_inverse=True, return_counts=True)
    return [
        f"{samples.path}: {lines(samples.rows[first == k])}: the same point, which counts "
        f"{count[k]} times in the fit"
        for k in np.flatnonzero(count > 1)
    ]
