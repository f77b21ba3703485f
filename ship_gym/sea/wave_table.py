"""The wave table of a ship: drift coefficients and motions over speed, heading and frequency.

The axes are the ship's (``ship_gym.conventions``: y to starboard, z down), and the table is
non-dimensional, so it serves every scale of the ship. A = wave amplitude, k = wave number.

- ``CX = F_x / (rho g A^2 B^2 / L)``, ``CY = F_y / (1/2 rho g A^2 L)``, ``CN = N / (1/2 rho g A^2
  L^2)`` about the centre of gravity. Waves from starboard (0 < mu < pi) push to port: CY < 0.
- Motions of the origin (midship, waterline): surge, sway, heave by A; roll, pitch, yaw [rad] by
  k A. Complex, for the factor e^{i theta}, theta = omega t - k (x cos d + y sin d) + phase at the
  ship's position, d the direction the wave runs to: the elevation (up) is Re(A e^{i theta}), a
  motion Re(A X e^{i theta}).
- Port and starboard by one rule, mirror image: at -mu surge, heave, pitch and CX are the same;
  sway, roll, yaw, CY and CN change sign. Only 0 <= mu <= pi is stored.

Interpolate linearly in Froude number, heading and true frequency omega sqrt(L/g), never in the
encounter frequency. ``database`` computes it.
"""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_known, shown, told_of
from ship_gym.conventions import wrap_angle
from ship_gym.reading import check_array, json_head, read_npz
from ship_gym.sea.wave_hull import check_facts
from ship_gym.writing import atomic_path

MODES = ("surge", "sway", "heave", "roll", "pitch", "yaw")
SURGE_MODELS = ("bem", "snnm", "blend")
# What a cell of `uncertainty` means; the yaw moment at speed is within a factor 2 at best.
UNCERTAINTY = {
    0: "at rest: exact within linear theory, verified against analytic results",
    1: "150 to 180 deg at speed: surge within 0.2 of SNNM's peak (rms; S-175 up to 0.22)",
    2: "90 to 150 deg at speed: surge mostly within 0.35 of SNNM's peak (rms)",
    3: "below 90 deg at speed: factor 2, sway near 75 deg worse in places",
    4: "waves shorter than 0.4 L at speed: SNNM's head-sea surge 0.7 to 6 times this (S-175 23)",
    5: "interpolated across tau = 1/4, or |omega_e| sqrt(L/g) < 0.3 where motions are faded",
}
# Where the surge coefficient of the choice "blend" is SNNM's: at Fn >= SNNM_FULL_FROUDE in waves
# shorter than SNNM_SHORT (none beyond SNNM_SHORT_END) by L, in which potential theory lies mostly
# below it, up to 6 times (S-175 23) in the shortest, and at headings below SNNM_FOLLOWING_DEG (none
# beyond 90 deg).
SNNM_FULL_FROUDE = 0.10
SNNM_SHORT = 0.4
SNNM_SHORT_END = 0.5
SNNM_FOLLOWING_DEG = 60.0
BOUNDS = {"CX": 12.0, "CY": 1.5, "CN": 0.2}
_FROUDE, _OMEGA = (0.0, 2.0), (1e-2, 1e2)  # of the axes
_LARGEST = 100.0  # of a coefficient or a motion; those of the package stay below 13


_KINDS = {"f": "float", "c": "complex", "u": "unsigned integer"}


def _check_axis(name: str, points: np.ndarray, low: float, high: float) -> np.ndarray:
    """Refuse an axis that does not rise or leaves its range; all but speeds have equal steps."""
    check_array(f"wave table: {name}", points, (None,), low, high)
    steps = np.diff(points)
    if not np.all(steps > 0.0):
        raise ConfigError(f"wave table: {name} must rise from point to point")
    if name != "froude" and (len(steps) < 1 or np.ptp(steps) > 1e-6 * steps[0]):
        raise ConfigError(f"wave table: {name} needs two points or more, with equal steps")
    if name == "heading" and not np.allclose(points[[0, -1]], [0.0, np.pi], rtol=0.0, atol=1e-6):
        raise ConfigError(f"wave table: heading reaches {points[0]:g} to {points[-1]:g}: it must "
            "reach from 0 to pi")  # fmt: skip
    return points


def _check_card(card: Any) -> None:
    """Refuse a card whose particulars of the ship, if it has them, are no lengths."""
    if not isinstance(card, dict):
        raise ConfigError(f"wave table: card = {shown(card)}: allowed is a mapping")
    made = card.get("made_for")
    if made is None:  # a table that is made by hand may not say
        return
    check_facts(made)


@dataclasses.dataclass(frozen=True)
class WaveTable:
    """Wave loads and motions of one ship; see the module for axes and factors.

    Attributes
    ----------
    froude, heading, omega : numpy.ndarray
        Axes: Froude number (f,), mu [rad] from 0 to pi (h,), omega sqrt(L/g) (w,); the last two
        have equal steps.
    CX_bem, CX_snnm, CY, CN : numpy.ndarray
        float32, shape (f, h, w).
    motions : numpy.ndarray
        complex64, shape (f, h, w, 6), in the order of `MODES`.
    uncertainty : numpy.ndarray
        uint8, shape (f, h, w): key of `UNCERTAINTY`.
    card : dict
        Ship, panels, versions, calibrated constants, checks, time.
    """

    froude: np.ndarray
    heading: np.ndarray
    omega: np.ndarray
    CX_bem: np.ndarray
    CX_snnm: np.ndarray
    CY: np.ndarray
    CN: np.ndarray
    motions: np.ndarray
    uncertainty: np.ndarray
    card: dict[str, Any]

    def __post_init__(self) -> None:
        shape = tuple(
            len(_check_axis(name, getattr(self, name), *limits))
            for name, limits in (
                ("froude", _FROUDE),
                ("heading", (0.0, np.pi + 1e-6)),
                ("omega", _OMEGA),
            )
        )
        for name in ("CX_bem", "CX_snnm", "CY", "CN"):
            self._check(name, shape, "f", -_LARGEST, _LARGEST)
        self._check("motions", (*shape, len(MODES)), "c", 0.0, _LARGEST)
        self._check("uncertainty", shape, "u", 0, max(UNCERTAINTY))
        _check_card(self.card)

    def _check(self, name: str, shape: tuple[int, ...], kind: str, low: float, high: float) -> None:
        values = getattr(self, name)
        if not isinstance(values, np.ndarray) or values.dtype.kind != kind:
            of = getattr(values, "dtype", type(values).__name__)
            raise ConfigError(f"wave table: {name} is of type {of}: allowed is {_KINDS[kind]}")
        check_array(f"wave table: {name}", values, shape, low, high)

    def surge(self, model: str = "blend") -> np.ndarray:
        """CX by a surge model: "bem", "snnm" or the "blend" of `snnm_weight`, shape (f, h, w)."""
        check_known("surge model", model, SURGE_MODELS)
        weight: Any = {"bem": 0.0, "snnm": 1.0}.get(model)
        if weight is None:
            weight = snnm_weight(self.froude, self.heading, self.omega)
        return ((1.0 - weight) * self.CX_bem + weight * self.CX_snnm).astype(np.float32)

    def drift(self, froude, heading, omega, model: str = "blend") -> np.ndarray:
        """CX, CY, CN by linear interpolation, clamped to the table.

        Parameters
        ----------
        froude, heading, omega : array_like
            Froude number, mu [rad] of any size and sign, omega sqrt(L/g); broadcast.
        model : str
            As in `surge`.

        Returns
        -------
        numpy.ndarray
            Shape (*broadcast shape, 3).
        """
        values = np.stack([self.surge(model), self.CY, self.CN], axis=-1)
        return self._at(values, froude, heading, omega, odd=(1, 2))

    def rao(self, froude, heading, omega) -> np.ndarray:
        """Complex motions in the order of `MODES`, as `drift`; shape (*broadcast shape, 6)."""
        return self._at(self.motions, froude, heading, omega, odd=(1, 3, 5))

    def _at(self, values, froude, heading, omega, odd: tuple[int, ...]) -> np.ndarray:
        from scipy.interpolate import RegularGridInterpolator

        mu = wrap_angle(np.asarray(heading, dtype=float))
        axes = (self.froude, self.heading, self.omega)
        given = np.broadcast_arrays(froude, np.abs(mu), omega)
        points = [np.clip(x, axis[0], axis[-1]) for x, axis in zip(given, axes, strict=True)]
        found = RegularGridInterpolator(axes, values)(np.stack(points, axis=-1))
        found = found.reshape(*given[0].shape, -1)  # of one point it has an axis too many
        side = np.where(np.broadcast_to(mu, given[0].shape) >= 0.0, 1.0, -1.0)
        found[..., list(odd)] *= side[..., None]
        return found

    def save(self, path: str | Path) -> None:
        """Write one .npz file, atomically; same table, same bytes."""
        arrays = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        text = json.dumps(arrays.pop("card"), sort_keys=True, indent=1).encode()
        with atomic_path(path) as temporary, temporary.open("wb") as file:
            np.savez_compressed(file, **arrays, card=np.frombuffer(text, dtype=np.uint8))

    @classmethod
    def load(cls, path: str | Path) -> WaveTable:
        """Read a table written by `save`; a missing or damaged file is a ConfigError."""
        if not Path(path).exists():
            raise ConfigError(f"{path}: no such wave table")
        names = [f.name for f in dataclasses.fields(cls)]
        found = read_npz(path, *names, what="a wave table")
        arrays: dict[str, Any] = {name: found[name] for name in names}
        with told_of(path):
            return cls(**arrays | {"card": json_head(arrays["card"], path)})


def snnm_weight(froude: np.ndarray, heading: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Share of SNNM in the surge coefficient of the model "blend", shape (f, h, w).

    1 at speed in waves shorter than 0.4 L and in following and stern-quartering seas; 0 at rest and
    in head to beam seas longer than 0.5 L (constants above).
    """
    speed = np.clip(np.asarray(froude) / SNNM_FULL_FROUDE, 0.0, 1.0)[:, None, None]
    angle = np.degrees(heading)[:, None]
    following = np.clip((90.0 - angle) / (90.0 - SNNM_FOLLOWING_DEG), 0.0, 1.0)
    ratio = 2.0 * np.pi / np.asarray(omega) ** 2
    short = np.clip((SNNM_SHORT_END - ratio) / (SNNM_SHORT_END - SNNM_SHORT), 0.0, 1.0)
    return speed * np.maximum(following, short)
