"""From fitted models to the force table that a ship reads, with its card."""

from __future__ import annotations

import dataclasses
import math
import warnings
from collections.abc import Callable

import numpy as np

from ship_gym.provenance import provenance, sha256
from ship_gym.ships.files import Named
from ship_gym.ships.loader import bare
from ship_gym.ships.open_water import EPSILON, first_quadrant, starred
from ship_gym.ships.particulars import Ship
from ship_gym.ships.records import CHANNELS, STD_CHANNELS, surrogate_names
from ship_gym.surrogates.base import SurrogateModel
from ship_gym.surrogates.effective_inflow import (
    RudderSamples,
    fit_effective_inflow,
    rudder_frame,
)
from ship_gym.surrogates.fit import PRINTED_FORCES, Fit
from ship_gym.surrogates.samples import DATA_SETS
from ship_gym.tables import Axis, Table, smoothstep, tabulate

# The surrogate fades into open water and the effective-inflow law over these margins of its box.
J_MARGIN = (0.1, 0.2)  # below and above
BETA_MARGIN = math.radians(10.0)
# It is trusted fully a little beyond the box, so that interpolation keeps it whole inside.
J_FULL, BETA_FULL = 0.02, math.radians(1.5)
GRID = (61, 53)  # points over advance angle and drift: 0.5 % of each range, checked by `tabulate`
_BY_THRUST_IDENTITY = "open-water torque at the same thrust: the source prints none"


def trust(J, beta, box: dict[str, float]):
    """1 inside the trained box, falling smoothly to 0 over its margins."""
    low = (box["J_min"] - J - J_FULL) / (J_MARGIN[0] - J_FULL)
    high = (J - box["J_max"] - J_FULL) / (J_MARGIN[1] - J_FULL)
    left = (box["beta_min"] - beta - BETA_FULL) / (BETA_MARGIN - BETA_FULL)
    right = (beta - box["beta_max"] - BETA_FULL) / (BETA_MARGIN - BETA_FULL)
    inside = 1.0 - smoothstep(np.maximum(low, high))
    return inside * (1.0 - smoothstep(np.maximum(left, right)))


def table_axes(box: dict[str, float]) -> tuple[Axis, Axis]:
    """Axes that end exactly where trust has fallen to zero, so that no kink lies inside."""
    low, high = (
        math.atan(J / (0.7 * math.pi))
        for J in (box["J_min"] - J_MARGIN[0], box["J_max"] + J_MARGIN[1])
    )
    left, right = box["beta_min"] - BETA_MARGIN, box["beta_max"] + BETA_MARGIN
    return (
        Axis("advance angle", low, (high - low) / (GRID[0] - 1), GRID[0]),
        Axis("drift angle", left, (right - left) / (GRID[1] - 1), GRID[1]),
    )


def torque_at_thrust(ship: Ship) -> Callable[[np.ndarray], np.ndarray]:
    """K_Q as a function of K_T in open water (thrust identity), both of any shape."""
    J = 0.7 * math.pi * np.tan(EPSILON.points[1:-1])
    K_T, K_Q = first_quadrant(ship.open_water, J)
    falling = K_T.argsort()
    return lambda thrust: np.interp(thrust, K_T[falling], K_Q[falling])


def _warn_of_samples(fit: Fit, ship: Ship) -> None:
    """Say what looks like a slip in samples of a user; those of the project are known."""
    from ship_gym.surrogates.sample_checks import check_samples  # late: it imports us by `fit`

    if DATA_SETS.get(fit.data.name) is fit.data:
        return
    for text in check_samples(fit.data, ship, fit.options, fit.grid, fit.turbulence):
        warnings.warn(text, UserWarning, stacklevel=3)


def table_of(fit: Fit, ship: Named | Ship) -> Table:
    """Tabulate fitted models over their box and its margins; the table ends where trust is zero.

    Parameters
    ----------
    fit : Fit
    ship : Ship, or its name or file
        Without surrogate: wake, rudder constants of the law, open water.

    Returns
    -------
    Table
        ``records.surrogate_names`` over advance angle and drift, in the frame of a turn to
        starboard; its card says where it comes from, how good it is and where it is valid.

    Warns
    -----
    UserWarning
        Samples of a user look like a slip, see `sample_checks.check_samples`.

    Raises
    ------
    ConfigError
        A quantity varies too fast for the grid.
    """
    data, ship = fit.data, bare(ship)
    _warn_of_samples(fit, ship)
    box = dict(zip(("J_min", "J_max", "beta_min", "beta_max"), data.box, strict=True))
    box = {"delta": data.delta, "S_R": ship.rudder.A_R, **box}
    torque = torque_at_thrust(ship)
    sides = list(fit.models)

    def model(epsilon, beta):
        J = 0.7 * math.pi * np.tan(epsilon)
        parts = [_channels(fit, side, J, beta, torque) for side in sides]
        weight = trust(J, beta, box)
        return np.concatenate([_ordered(part, weight) for part in parts], axis=-1)

    names = surrogate_names(len(sides))
    # The weight of the fade is our own choice, so its interpolation error is no error of physics;
    # a process' spread has kinks at its points.
    free = tuple(n for n in names if n.split()[0] == "trust" or n.split()[0] in STD_CHANNELS)
    table = tabulate(model, table_axes(box), names, card_of(fit, ship), unchecked=free)
    return Table(table.axes, table.names, table.values, {**table.card, "domain": box})


def _channels(fit: Fit, side: str, J, beta, torque) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Mean and standard deviation of each coefficient of one propeller and rudder."""
    data, models = fit.data, fit.models[side]
    X = np.stack([J.ravel(), beta.ravel()], axis=1)

    def value(name: str, factor: float = 1.0):
        mean, std = _of(models[name], X)
        return factor * mean.reshape(J.shape), abs(factor) * std.reshape(J.shape)

    K_T, K_T_std = value(data.thrust)
    if "10K_Q" in data.quantities:
        K_Q, K_Q_std = value("10K_Q", 0.1)
    else:
        K_Q, K_Q_std = torque(K_T), torque(K_T + K_T_std) - torque(K_T)
    zero = (np.zeros_like(J), np.zeros_like(J))
    K_S, K_S_std = value("K_S", data.sign) if "K_S" in models else zero
    F_x, F_x_std = value("C_Fx")
    F_y, F_y_std = value("C_Fy", data.sign)
    C_N, C_A = rudder_frame(F_x, F_y, data.delta)
    # The rudder's force is nearly normal to it, so an error of it moves C_Fx and C_Fy together:
    # their errors are taken as fully (anti-)correlated, as those of one normal force are.
    s, c = math.sin(data.delta), math.cos(data.delta)
    return {
        "C_T": (starred(K_T, J), starred(K_T_std, J)),
        "C_Q": (starred(K_Q, J), starred(K_Q_std, J)),
        "C_S": (starred(K_S, J), starred(K_S_std, J)),
        "C_N": (C_N, c * F_y_std + s * F_x_std),
        "C_A": (C_A, np.abs(c * F_x_std - s * F_y_std)),
    }


def _of(model: SurrogateModel, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard deviation; 0 where a model does not know its own (printed ones)."""
    mean, std = model.predict(X)
    return mean, np.nan_to_num(std)


def _ordered(part: dict[str, tuple[np.ndarray, np.ndarray]], weight: np.ndarray) -> np.ndarray:
    """Channels in the order of ``records.CHANNELS``."""
    found = {name: mean for name, (mean, _) in part.items()}
    found.update({f"{name}_std": std for name, (_, std) in part.items()}, trust=weight)
    return np.stack([found[name] for name in CHANNELS], axis=-1)


def law_samples(fit: Fit, side: str, S_R: float) -> RudderSamples:
    """What the effective-inflow law is fitted to: the samples, or the printed model at them."""
    data, training = fit.data, fit.training[side]
    names = (data.thrust, "C_Fx", "C_Fy")
    if fit.trained_on == PRINTED_FORCES:
        K_T, C_Fx, C_Fy = (training.values[k] for k in names)
    else:
        K_T, C_Fx, C_Fy = (fit.models[side][k].predict(training.X)[0] for k in names)
    J, beta = training.X.T[:2]
    delta = training.delta(data.delta)
    if np.ndim(delta):  # of a scattered set those with a force of which a relative error is told
        over = delta >= 0.5 * np.max(delta)
        delta = np.asarray(delta)[over]
        J, beta, K_T, C_Fx, C_Fy = (x[over] for x in (J, beta, K_T, C_Fx, C_Fy))
    return RudderSamples(J, beta, K_T, C_Fx, data.sign * C_Fy, delta, S_R)


def card_of(fit: Fit, ship: Ship) -> dict:
    """Provenance, options, models and scores of a fit, as plain data."""
    data, first = fit.data, next(iter(fit.training.values()))
    files = [data.path, *([data.coefficients] if data.coefficients else [])]
    law = fit_effective_inflow(
        {side: law_samples(fit, side, ship.rudder.A_R) for side in fit.models}, ship
    )
    return {
        "title": f"{data.name}: propeller and rudder behind the hull, rudder "
        f"{math.degrees(data.delta):.0f} deg, surrogate {fit.name}",
        "source": first.source,
        "inputs": {path.name: sha256(path) for path in files},
        "data": data.name,
        "grid": fit.grid,
        "turbulence": fit.turbulence,
        "options": dataclasses.asdict(fit.options),
        "trained_on": fit.trained_on,
        "training_points": [int(p) for p in first.points],
        "held_out_points": [int(p) for p in next(iter(fit.validation.values())).points],
        "models": {
            side: {name: model.describe() for name, model in models.items()}
            for side, models in fit.models.items()
        },
        "held_out_scores": {side: fit.scores(side) for side in fit.models},
        "held_out_errors_percent": {
            side: {k: [round(e, 3) for e in errors] for k, errors in fit.errors(side).items()}
            for side in fit.models
        },
        "torque": "samples" if "10K_Q" in data.quantities else _BY_THRUST_IDENTITY,
        "effective_inflow": law,
        "made_for": {
            "ship": ship.name,
            "L": ship.hull.L,
            "D": ship.propeller.D,
            **{k: getattr(ship.rudder, k) for k in ("A_R", "f_alpha", "eta")},
        },
        **provenance(),
    }
