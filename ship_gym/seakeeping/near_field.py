"""Mean drift force and yaw moment from the pressure on the hull (near field).

Axes, time factor and units: see `radiation_diffraction` (z up, y to port, L = g = rho = 1, normals
into the water). Pinkster (1980) with a uniform stream: phi is the whole first-order potential, the
incident wave's and the body's, p = i omega_e phi + U phi_x its pressure, zeta = p at z = 0 the
elevation, alpha = xi + theta x r the displacement of the hull. The mean over a period of

    F = - 1/2 oint (zeta - alpha_z)^2 n dl + 1/2 Int |grad phi|^2 n dS
        - Int (alpha . grad p) n dS + theta x F_1,

and for the yaw moment the same with r x n for n, and xi x F_1 + theta x M_1; F_1 and M_1 are the
pressure's first-order force (horizontally that of p, else that of p - alpha_z). Products of motion
and hydrostatic pressure cancel in surge, sway and yaw.

At rest this holds for any motion and gives what the far field gives; the difference is that of the
panels (docs/drift_at_speed.md). At speed it needs no waves far away, so it has no spike at tau =
1/4; it neglects the steady wave and the steady flow around the hull beside the uniform stream, and
the steady flow of second order.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ship_gym.seakeeping.drift import encounter_frequency
from ship_gym.seakeeping.radiation_diffraction import Flow
from ship_gym.seakeeping.surface import Surface, Waterline

_SURGE_SWAY_YAW = [0, 1, 5]


class NearField(NamedTuple):
    """Parts of the mean surge, sway force and yaw moment about the origin, by rho g L (L^2).

    Each of shape (3,), for a wave of unit amplitude.
    """

    waterline: np.ndarray
    velocity: np.ndarray
    displacement: np.ndarray
    rotation: np.ndarray

    @property
    def total(self) -> np.ndarray:
        """Surge, sway, yaw."""
        return self.waterline + self.velocity + self.displacement + self.rotation


def near_field(
    surface: Surface, flow: Flow, xi: np.ndarray, k0: float, heading: float, speed: float = 0.0
) -> NearField:
    """Mean drift force on a hull in a wave of unit amplitude.

    Parameters
    ----------
    surface : Surface
    flow : Flow
        Flow of the body (diffracted and radiated, not the incident wave), arrays of shape (n,).
    xi : numpy.ndarray
        Motions of the origin that belong to it, as of ``motions``, shape (6,).
    k0 : float
        Wave number of the incident wave by 1/L.
    heading : float
        mu [rad].
    speed : float
        Froude number.

    Returns
    -------
    NearField
    """
    omega_e = encounter_frequency(k0, heading, speed)
    wave = np.array([1j * k0 * np.cos(heading), 1j * k0 * np.sin(heading), k0])
    incident = -1j / np.sqrt(k0) * np.exp(surface.centres @ wave)
    body, normal_velocity = surface.both_sides(flow)
    derivatives = surface.derivatives(body, normal_velocity)
    of_body = surface.gradient(derivatives, normal_velocity)
    velocity = of_body + incident[:, None] * wave
    second = surface.second_derivatives(of_body)
    pressure = 1j * omega_e * (body + incident) + speed * velocity[:, 0]
    slope = 1j * omega_e * velocity
    slope += speed * (second[:, :, 0] + incident[:, None] * wave * wave[0])
    shift, turn = xi[:3], xi[3:]
    moved = shift + np.cross(turn, surface.centres)
    modes = np.concatenate([surface.normals, np.cross(surface.centres, surface.normals)], axis=1)
    weighted = np.where(surface.slivers, 0.0, surface.areas)[:, None] * modes
    squared = 0.5 * np.sum(np.abs(velocity) ** 2, axis=1)
    carried = np.sum(_mean(moved, slope), axis=1)
    potential, stream = _at_waterline(surface, body, normal_velocity, derivatives, of_body, second)
    elevation = 1j * omega_e * potential + speed * stream
    return NearField(
        waterline=_waterline(surface, elevation, xi, wave),
        velocity=0.5 * squared @ weighted[:, _SURGE_SWAY_YAW],
        displacement=-carried @ weighted[:, _SURGE_SWAY_YAW],
        rotation=_rotation(weighted, pressure, pressure - moved[:, 2], shift, turn),
    )


def short_wave_drift(surface: Surface, k0: float, heading: float, speed: float) -> np.ndarray:
    """Mean surge, sway and yaw of a held wall-sided hull in waves much shorter than it, (3,).

    Faltinsen et al. (1980): the lit side of the waterline reflects the wave, F_n = 1/2 (k . n)
    [(k . n) - 2 omega_0 U n_x] for unit k, times 1 - e^{-2 k T} of the wave above the keel.
    """
    line = surface.waterline
    length = np.linalg.norm(line.normal, axis=1)
    towards = line.normal @ [np.cos(heading), np.sin(heading), 0.0] / length
    faster = 2.0 * np.sqrt(k0) * speed * line.normal[:, 0] / length
    reflected = np.where(towards < 0.0, 0.5 * towards * (towards - faster), 0.0)
    depth = -float(surface.half.panels[..., 2].min())
    return (1.0 - np.exp(-2.0 * k0 * depth)) * _along(line, -reflected[:, None] * line.normal)


def _along(line: Waterline, strip: np.ndarray) -> np.ndarray:
    """Surge, sway and yaw of forces on the edges of the waterline, shape (e, 3)."""
    lever = line.middle[:, 0] * strip[:, 1] - line.middle[:, 1] * strip[:, 0]
    return np.array([*strip[:, :2].sum(axis=0), lever.sum()])


def _mean(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Mean over a period of the product of two oscillations."""
    return 0.5 * (a * np.conj(b)).real


def _rotation(weighted, pressure, total, shift, turn) -> np.ndarray:
    """The first-order force, which turns and moves with the hull."""
    force, moment = -total @ weighted[:, :3], -total @ weighted[:, 3:]
    force[:2] = -pressure @ weighted[:, :2]
    turned = 0.5 * np.cross(turn, force.conj()).real
    moved = 0.5 * (np.cross(turn, moment.conj()) + np.cross(shift, force.conj())).real
    return np.array([turned[0], turned[1], moved[2]])


def _at_waterline(surface: Surface, body, normal_velocity, derivatives, gradient, second):
    """The body's potential and its derivative by x at the waterline, shape (e,) each."""
    line = surface.waterline
    at = line.panel
    step = line.middle - surface.centres[at]
    a, b = (np.sum(step * t[at], axis=1) for t in surface.tangents)
    across = np.sum(step * surface.normals[at], axis=1)
    factors = np.stack([a, b, 0.5 * a * a, a * b, 0.5 * b * b])
    potential = body[at] + np.sum(factors * derivatives[:, at], axis=0)
    stream = gradient[at, 0] + np.sum(second[at, 0] * step, axis=1)
    return potential + across * normal_velocity[at], stream


def _waterline(surface: Surface, elevation, xi, wave) -> np.ndarray:
    """The strip between the hull's own waterline and the water."""
    line = surface.waterline
    # of the incident wave i omega_0 phi, whatever the speed: e^{i k . x}
    relative = elevation + np.exp(line.middle @ wave)
    relative = relative - xi[2] - np.cross(xi[3:], line.middle)[:, 2]
    return _along(line, -0.5 * _mean(relative, relative)[:, None] * line.normal)
