"""Mean drift force and yaw moment from the waves that leave the ship (far field).

Axes, time factor and units: see `radiation_diffraction` (z up, y to port, L = g = rho = 1).

With the Kochin function of the body's flow phi_B (diffraction and motion)

    H(kx, ky) = Int (dphi_B/dn - phi_B d/dn) e^{kappa z - i (kx x + ky y)} dS,
    kappa = sqrt(kx^2 + ky^2),

the ship radiates, in the frame that moves with it at speed U, waves of intrinsic frequency
sigma = omega_e + U kx and wave number kappa = sigma^2, ky = +-m, m = sqrt(kappa^2 - kx^2), with the
wave action per unit time

    dA = 1/(8 pi) sgn(sigma) (kappa / m) [|H(kx, m)|^2 + |H(kx, -m)|^2] dkx,   kappa > |kx|.

Each unit of action was taken from the incident wave, of wave number vector k0, and carries off its
own: F = Int (k0 - k) dA. Damping that radiates no waves (roll, lift) takes action too, which came
with k0 and goes nowhere: F gains k0 times it. At zero speed this is exact (Maruo 1960; Newman 1967
for yaw, which holds with damping as it is). At speed it is an approximation (see ``calibration.py``
for its constants) and yaw lacks a term that `near_field` has.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from ship_gym.seakeeping import calibration
from ship_gym.seakeeping.radiation_diffraction import Flow, HalfHull

_HEAVE, _PITCH = 2, 4


@dataclasses.dataclass(frozen=True)
class Drift:
    """Mean second-order force of a unit-amplitude wave, by rho g L, moment by rho g L^2.

    Attributes
    ----------
    surge, sway, yaw : float
        Along x, along y (to port), about z (up) through the origin.
    action : float
        Radiated wave action per unit time.
    extinction : float
        The incident wave's loss (optical theorem): at rest what is radiated and absorbed.
    absorbed : float
        Action per unit time that damping beyond potential flow takes.
    """

    surge: float
    sway: float
    yaw: float
    action: float
    extinction: float
    absorbed: float = 0.0


def kochin(
    hull: HalfHull, flow: Flow, kx: np.ndarray, ky: np.ndarray, kappa: np.ndarray
) -> np.ndarray:
    """Kochin function, its even and odd part in ky, and their derivatives by direction.

    Parameters
    ----------
    hull : HalfHull
    flow : Flow
        Arrays of shape (n,).
    kx, ky, kappa : numpy.ndarray
        Wave numbers, shape (q,); kappa is the depth decay.

    Returns
    -------
    numpy.ndarray
        Complex, shape (4, q): H_even, H_odd, dH_even/dtheta, dH_odd/dtheta, where
        H(kx, +-ky) = H_even +- H_odd and the derivative turns (kx, ky) to port.
    """
    c_even, s_even, c_odd, s_odd = _sums(hull, flow, kx, ky, kappa)
    return _assemble(kx, ky, kappa, c_even, s_even, c_odd, s_odd)


def _sums(hull: HalfHull, flow: Flow, kx, ky, kappa) -> list[np.ndarray]:
    """Sums of the flow's moments with e^{kappa z - i kx x} times cos(ky y) and sin(ky y).

    In single precision, which is ten times faster: phases stay below 100 rad.
    """
    x, y, z = hull.points.reshape(-1, 3).T.astype(np.float32)
    kx, ky, kappa = (np.asarray(a, dtype=np.float32)[:, None] for a in (kx, ky, kappa))
    decay = np.exp(kappa * z)
    along, across = kx * x, ky * y
    real, imaginary = decay * np.cos(along), decay * -np.sin(along)
    cosine, sine = np.cos(across), np.sin(across)
    waves = np.concatenate([real * cosine, imaginary * cosine, real * sine, imaginary * sine])
    even = _moments(hull, flow.even, flow.even_velocity)
    odd = _moments(hull, flow.odd, flow.odd_velocity)
    both = np.concatenate([even.real, even.imag, odd.real, odd.imag], axis=1).astype(np.float32)
    sums = (waves @ both).astype(float).reshape(4, len(kx), 4, -1)
    # (real + i imaginary) of the wave times (real + i imaginary) of the moments
    return [
        sums[a, :, b] - sums[a + 1, :, b + 1] + 1j * (sums[a, :, b + 1] + sums[a + 1, :, b])
        for b in (0, 2)
        for a in (0, 2)
    ]


def _moments(hull: HalfHull, potential: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Columns phi_n, phi n_z, phi n_x, phi n_y, then the same by x and by y, shape (4 n, 12)."""
    n = hull.normals
    columns = np.stack([velocity, potential * n[:, 2], potential * n[:, 0], potential * n[:, 1]], 1)
    at_points = (columns[:, None, :] * hull.weights[:, :, None]).reshape(-1, 4)
    x, y = hull.points.reshape(-1, 3)[:, :2].T
    return np.concatenate([at_points, at_points * x[:, None], at_points * y[:, None]], axis=1)


def _assemble(kx, ky, kappa, c_even, s_even, c_odd, s_odd) -> np.ndarray:
    """Kochin function and derivatives from the sums with cos(ky y) and sin(ky y)."""

    def by_direction(c, s):
        """Derivatives of the cosine and the sine sums when (kx, ky) turns."""
        dc = 1j * ky[:, None] * c[:, 4:8] - kx[:, None] * s[:, 8:12]
        ds = 1j * ky[:, None] * s[:, 4:8] + kx[:, None] * c[:, 8:12]
        return dc, ds

    def normal(a):
        """phi_n - phi (kappa n_z - i kx n_x)."""
        return a[:, 0] - kappa * a[:, 1] + 1j * kx * a[:, 2]

    dc_even, ds_even = by_direction(c_even, s_even)
    dc_odd, ds_odd = by_direction(c_odd, s_odd)
    even = 2.0 * (normal(c_even) + ky * s_even[:, 3])
    odd = -2j * (normal(s_odd) - ky * c_odd[:, 3])
    d_even = normal(dc_even) - 1j * ky * c_even[:, 2] + kx * s_even[:, 3] + ky * ds_even[:, 3]
    d_odd = normal(ds_odd) - 1j * ky * s_odd[:, 2] - kx * c_odd[:, 3] - ky * dc_odd[:, 3]
    return np.stack([even, odd, 2.0 * d_even, -2j * d_odd])


def drift(
    hull: HalfHull,
    flow: Flow,
    k0: float,
    heading: float,
    speed: float = 0.0,
    draught: float | None = None,
    absorbed: np.ndarray | None = None,
) -> Drift:
    """Mean drift force on a hull in a wave of unit amplitude.

    Parameters
    ----------
    hull : HalfHull
    flow : Flow
        Flow of the body (diffracted and radiated, not the incident wave), arrays of shape (n,).
    k0 : float
        Wave number of the incident wave by 1/L.
    heading : float
        mu [rad].
    speed : float
        Froude number.
    draught : float, optional
        By L; deepest panel if omitted. Bounds the short waves at speed.
    absorbed : numpy.ndarray, optional
        Action per unit time that the damping of each mode takes, as of ``absorbed_action``, shape
        (6,); none if omitted.

    Returns
    -------
    Drift
    """
    found = _radiated(hull, flow, k0, heading, speed, draught)
    if absorbed is None:
        return found
    # surge was calibrated without the part of heave and pitch, see ``calibration.py``
    along = absorbed.sum() - absorbed[[_HEAVE, _PITCH]].sum()
    return dataclasses.replace(
        found,
        surge=found.surge + k0 * float(np.cos(heading) * along),
        sway=found.sway + k0 * float(np.sin(heading) * absorbed.sum()),
        absorbed=float(absorbed.sum()),
    )


def _radiated(hull, flow, k0, heading, speed, draught) -> Drift:
    """Drift of a hull whose damping is that of its waves."""
    omega_e = encounter_frequency(k0, heading, speed)
    if speed == 0.0:
        kx, weight = _circle(k0)
        return _integrate(hull, flow, k0, heading, kx, np.full_like(kx, omega_e), weight, np.inf)
    draught = float(-hull.panels[..., 2].min()) if draught is None else draught
    tau, band = abs(omega_e) * speed, calibration.TAU_BAND
    if abs(tau - 0.25) >= band:
        return _at_speed(hull, flow, k0, heading, speed, omega_e, draught)
    # the far field alone moves to both ends of the band, the flow on the hull stays
    share = (tau - 0.25 + band) / (2.0 * band)
    low, high = (
        _at_speed(hull, flow, k0, heading, speed, np.copysign(t / speed, omega_e), draught)
        for t in (0.25 - band, 0.25 + band)
    )
    pairs = zip(dataclasses.astuple(low), dataclasses.astuple(high), strict=True)
    return Drift(*((1.0 - share) * a + share * b for a, b in pairs))


def encounter_frequency(k0: float, heading: float, speed: float) -> float:
    """omega_e = omega_0 - k0 U cos(mu), negative where the ship overtakes the waves."""
    return float(np.sqrt(k0) - k0 * speed * np.cos(heading))


def _at_speed(hull, flow, k0, heading, speed, omega_e, draught) -> Drift:
    kx, weight = _longitudinal(omega_e, speed, calibration.CUT_OFF_BY_DRAUGHT / draught)
    shortest = max(calibration.SHORTEST_BY_DRAUGHT / draught, k0)
    return _integrate(hull, flow, k0, heading, kx, omega_e + speed * kx, weight, shortest)


def _integrate(hull, flow, k0, heading, kx, sigma, weight, shortest) -> Drift:
    """Sum over the radiated waves; `weight` is dkx kappa / m.

    Waves shorter than `shortest` keep its depth decay and transverse number.
    """
    kappa = sigma**2
    m = np.minimum(np.sqrt(np.maximum(kappa**2 - kx**2, 0.0)), shortest)
    kappa = np.minimum(kappa, shortest)
    even, odd, d_even, d_odd = kochin(hull, flow, kx, m, kappa)
    share = weight * np.sign(sigma) / (8.0 * np.pi)
    action = share * 2.0 * (np.abs(even) ** 2 + np.abs(odd) ** 2)
    across = share * m * 4.0 * (even.conj() * odd).real
    spin = share * 2.0 * (even.conj() * d_odd + odd.conj() * d_even).imag
    k0x, k0y = k0 * np.cos(heading), k0 * np.sin(heading)
    one = np.array([k0x]), np.array([abs(k0y)]), np.array([k0])
    even, odd, d_even, d_odd = kochin(hull, flow, *one)[:, 0]
    side = 1.0 if k0y >= 0.0 else -1.0
    incident = 1j / np.sqrt(k0)  # conjugate of the incident potential at the origin
    return Drift(
        surge=float(np.sum((k0x - kx) * action)),
        sway=float(k0y * action.sum() - across.sum()),
        yaw=float(0.5 * (incident * (side * d_even + d_odd)).real - spin.sum()),
        action=float(action.sum()),
        extinction=float(-0.5 * (incident * (even + side * odd)).imag),
    )


def _circle(k0: float) -> tuple[np.ndarray, np.ndarray]:
    """Points kx = k0 cos(theta) on the half circle, with weights k0 dtheta."""
    count = int(32 + 3.0 * k0)  # |H|^2 varies like e^{i k0 L}
    theta = (np.arange(count) + 0.5) * np.pi / count
    return k0 * np.cos(theta), np.full(count, k0 * np.pi / count)


def _longitudinal(omega_e: float, speed: float, cut_off: float) -> tuple[np.ndarray, np.ndarray]:
    """Points kx with kappa = (omega_e + U kx)^2 > |kx| and weights dkx kappa / m.

    Each interval between roots of kappa = |kx| is mapped by kx = middle - half cos(t), which takes
    the root singularity of 1/m at its ends.
    """
    points, weights = [], []
    for low, high in wave_intervals(omega_e, speed, cut_off):
        count = int(24 + 1.0 * (high - low))
        t = (np.arange(count) + 0.5) * np.pi / count
        kx = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(t)
        kappa = (omega_e + speed * kx) ** 2
        m = np.sqrt(np.maximum(kappa**2 - kx**2, 1e-300))
        points.append(kx)
        weights.append(0.5 * (high - low) * np.sin(t) * np.pi / count * kappa / m)
    return np.concatenate(points), np.concatenate(weights)


def wave_intervals(omega_e: float, speed: float, cut_off: float) -> list[tuple[float, float]]:
    """Intervals of kx within +-cut_off where free waves exist, split where kappa - |kx| is least.

    Parameters
    ----------
    omega_e : float
        Encounter frequency, signed.
    speed : float
        Froude number, > 0.
    cut_off : float
        Largest |kx|.
    """
    found = []
    for side in (-1.0, 1.0):
        tau = side * omega_e * speed
        root = max(1.0 - 4.0 * tau, 0.0) ** 0.5
        near, far = ((1.0 - 2.0 * tau + sign * root) / (2.0 * speed**2) for sign in (-1.0, 1.0))
        if tau >= 0.5:  # waves of every length, no narrow place
            near = far = 0.0
        for low, high in ((0.0, min(near, cut_off)), (far, cut_off)):
            if high > low:
                found.append((min(side * low, side * high), max(side * low, side * high)))
    return found
