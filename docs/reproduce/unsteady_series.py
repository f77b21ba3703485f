"""Synthetic training in unsteady motion after Knight & Maki (2020).

Their CFD series are drawn, not tabulated, so ours are SYNTHETIC: the motions are theirs, the
coefficients come from their printed open-water regression (Eq. 21). What was added, and why:

- **Behind the hull** the propeller works in the wake of hull set C of KCS, J_A = J (1 - w) with
  w = w_P0 exp(-C alpha^2): the thrust identity. Together with the printed |alpha| this is what no
  polynomial in J and signed alpha can follow. No term was added to make it so.
- **Noise**, normal and independent, on every value of an unsteady series, with the standard
  deviations `NOISE` of the scaled outputs: 1/2 * 3 * NOISE^2 is the least printed loss of a case,
  3.1e-5 of the network in training in open water, 3.43e-5 of both models on test 1 behind the
  hull. More noise than that their series cannot have, though the richest regression leaves 6.9e-5
  in training behind the hull: the rest of that is form, which our smooth series do not have.
- The side force is odd in alpha and starts from zero: the offset of the printed regression at zero
  angle (0.01 in K_S) is taken off.

Printed of the training sets: 70 snapshots in open water; behind the hull five steady points, 20
times each, at J 0.1 to 0.9 of the ship's own speed, and "similarly" many unsteady ones, for which
we take 70 again.
"""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np

from ship_gym.config import check_known
from ship_gym.csv_file import read_csv
from ship_gym.ships.loader import load_ship
from ship_gym.surrogates.regression import Regression

DATA = Path(__file__).parent / "data"
EQ_21 = DATA / "km20_open_water_regression.csv"
CASES = DATA / "km20_cases.csv"  # Tables 1 and 2

D = 0.105  # propeller diameter [m]
T_R = 0.0628  # shift of the motions in time [s]
SNAPSHOTS = 70
STEADY_J = (0.1, 0.3, 0.5, 0.7, 0.9)  # of the ship's speed, open water by the thrust identity
STEADY_REPEATS = 20
CONDITIONS = ("open water", "behind hull")
NOISE = {  # see above: 0.0045 and 0.0048
    "open water": math.sqrt(2.0 / 3.0 * 3.1e-5),
    "behind hull": math.sqrt(2.0 / 3.0 * 3.43e-5),
}


@dataclasses.dataclass(frozen=True)
class Series:
    """Snapshots of one case: X (n, 2), J [-] and alpha [rad], and scaled outputs Y (n, 3).

    In open water alpha is its magnitude and the outputs are K_T, 10 |K_S| + 0.3, 10 K_Q; behind
    the hull alpha is signed and they are K_T + 0.2, 5 K_S + 0.5, 10 K_Q. (The source prints
    5 |K_S| + 0.5; with a signed angle we keep the sign.)
    """

    X: np.ndarray
    Y: np.ndarray


def motion(condition: str, case: str, count: int = SNAPSHOTS) -> np.ndarray:
    """J and signed alpha of a case over one period of its slowest part, evenly in time.

    Parameters
    ----------
    condition : str
        ``"open water"`` or ``"behind hull"``.
    case : str
        ``"training"``, ``"validation"``, ``"test"``, ``"test 1"`` ...
    count : int
        Number of snapshots.

    Returns
    -------
    numpy.ndarray
        Shape (count, 2): J = U/(n D) [-], alpha = atan(V/U) [rad].
    """
    cases = read_csv(CASES)
    check_known("condition", condition, CONDITIONS)
    rows = cases.where(condition=condition)
    check_known(f"case in {condition}", case, rows.columns["case"].tolist())
    row = rows.where(case=case)
    c = {name: float(row.si(name)[0]) for name in row.units}
    slowest = min(c["omega"], c["omega_n"])
    t = np.arange(count) * (2.0 * math.pi / slowest / count) - T_R
    swing = np.cos(c["omega"] * t)
    U = c["U_mean"] * (1.0 + c["surge"] * swing)
    V = c["U_mean"] * c["sway"] * swing
    n = c["n_mean"] * (1.0 + c["rate"] * np.cos(c["omega_n"] * t))
    return np.stack([U / (n * D), np.arctan2(V, U)], axis=1)


def eq_21(X: np.ndarray) -> np.ndarray:
    """K_T, K_S* = 10 |K_S| + 0.3 and K_Q* = 10 K_Q of the printed regression at J, |alpha|; (n, 3).

    At the largest angles of the training case K_S* exceeds 1, which no sigmoid output can reach:
    the printed coefficients and the printed scaling do not belong together there.
    """
    printed = read_csv(EQ_21)
    X = np.abs(np.atleast_2d(X))
    columns = [printed.columns[k] for k in ("K_T", "K_S*", "K_Q*")]
    return np.stack([Regression("second", c).predict(X)[0] for c in columns], axis=1)


def behind_hull(X: np.ndarray, wake: tuple[float, float]) -> np.ndarray:
    """Scaled outputs behind the hull by thrust identity, without noise, shape (n, 3).

    Parameters
    ----------
    X : numpy.ndarray
        Shape (n, 2): J of the ship's speed, signed alpha [rad].
    wake : (float, float)
        w_P0 and C of w = w_P0 exp(-C alpha^2).
    """
    J, alpha = X.T
    J_A = J * (1.0 - wake[0] * np.exp(-wake[1] * alpha**2))
    K_T, K_S, K_Q = eq_21(np.stack([J_A, alpha], axis=1)).T
    upright = eq_21(np.stack([J_A, np.zeros_like(alpha)], axis=1))[:, 1]
    side = 0.1 * (K_S - upright) * np.sign(alpha)
    return np.stack([K_T + 0.2, 5.0 * side + 0.5, K_Q], axis=1)


def ship_wake() -> tuple[float, float]:
    """w_P0 and C of KCS with hull set C, whose wake has this form; set B's has another."""
    propeller = load_ship("kcs_model", variant="hull_c", surrogate="none").propeller
    return propeller.w_P0, propeller.wake_beta2


def series(condition: str, case: str, seed: int, noise: float | None = None) -> Series:
    """Synthetic snapshots of a case; the same seed gives the same noise.

    Behind the hull the training set is the sway case, and after it the five steady points 20 times
    each, without noise.

    Parameters
    ----------
    condition, case : str
        As in `motion`.
    seed : int
    noise : float, optional
        Standard deviation of the scaled outputs; `NOISE` if omitted.
    """
    X = motion(condition, case)
    noise = NOISE[condition] if noise is None else noise
    place = read_csv(CASES).columns["case"].tolist().index(case)
    random = np.random.default_rng([seed, CONDITIONS.index(condition), place])
    if condition == "open water":
        X = np.abs(X)
        return Series(X, _noisy(eq_21(X), noise, random))
    wake = ship_wake()
    Y = _noisy(behind_hull(X, wake), noise, random)
    if case != "training":
        return Series(X, Y)
    J = np.repeat(np.array(STEADY_J), STEADY_REPEATS)
    steady = np.stack([J, np.zeros_like(J)], axis=1)
    return Series(np.concatenate([X, steady]), np.concatenate([Y, behind_hull(steady, wake)]))


def _noisy(values: np.ndarray, noise: float, random: np.random.Generator) -> np.ndarray:
    return values + noise * random.standard_normal(values.shape)
