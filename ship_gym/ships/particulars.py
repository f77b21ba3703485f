"""Particulars of a ship as frozen dataclasses: a unit and a meaning on every field, SI inside.

Hull derivatives are non-dimensional by 1/2 rho L d U^2 (forces) and 1/2 rho L^2 d U^2 (moments),
added masses by 1/2 rho L^2 d and 1/2 rho L^4 d, with v' = v/U and r' = r L/U (Yasukawa & Yoshimura
2015). The unit decides how a value changes with scale, see ``scaling.py``.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from ship_gym.conventions import G
from ship_gym.ships.trials import Trial
from ship_gym.tables import Table


def quantity(unit: str, meaning: str, default: float | None = None) -> Any:
    """Field of a dataclass: its SI unit, what it means and an optional default."""
    metadata = {"unit": unit, "meaning": meaning}
    if default is None:
        return dataclasses.field(metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata)


@dataclasses.dataclass(frozen=True)
class Hull:
    """Geometry, mass, resistance and manoeuvring derivatives of the bare hull."""

    L: float = quantity("m", "length between perpendiculars")
    B: float = quantity("m", "beam at the waterline")
    d: float = quantity("m", "draught")
    volume: float = quantity("m3", "displacement volume")
    x_G: float = quantity("m", "centre of gravity, forward of midship positive")
    k_zz: float = quantity("m", "radius of gyration in yaw about the centre of gravity")
    S: float = quantity("m2", "wetted surface of the bare hull")
    form_factor: float = quantity("-", "1 + k on the ITTC-57 friction line")
    C_A: float = quantity("-", "correlation allowance, on S; applies at full scale only")
    C_D: float = quantity("-", "cross-flow drag coefficient at 90 deg of drift")
    R_0: float = quantity("-", "resistance coefficient R0'")
    X_vv: float = quantity("-", "surge by v'^2")
    X_vr: float = quantity("-", "surge by v' r'")
    X_rr: float = quantity("-", "surge by r'^2")
    X_vvvv: float = quantity("-", "surge by v'^4")
    Y_v: float = quantity("-", "sway by v'")
    Y_r: float = quantity("-", "sway by r'")
    Y_vvv: float = quantity("-", "sway by v'^3")
    Y_vvr: float = quantity("-", "sway by v'^2 r'")
    Y_vrr: float = quantity("-", "sway by v' r'^2")
    Y_rrr: float = quantity("-", "sway by r'^3")
    N_v: float = quantity("-", "yaw by v'")
    N_r: float = quantity("-", "yaw by r'")
    N_vvv: float = quantity("-", "yaw by v'^3")
    N_vvr: float = quantity("-", "yaw by v'^2 r'")
    N_vrr: float = quantity("-", "yaw by v' r'^2")
    N_rrr: float = quantity("-", "yaw by r'^3")
    m_x: float = quantity("-", "added mass in surge")
    m_y: float = quantity("-", "added mass in sway")
    J_z: float = quantity("-", "added moment of inertia in yaw")


@dataclasses.dataclass(frozen=True)
class Propeller:
    """One propeller on the centreline, or two alike; forces and torque are of each."""

    D: float = quantity("m", "diameter")
    x_P: float = quantity("m", "position, forward of midship positive")
    t_P: float = quantity("-", "thrust deduction")
    w_P0: float = quantity("-", "effective wake fraction straight ahead")
    wake_C1: float = quantity("-", "wake in manoeuvres, C1 of YY15; 0: not used", 0.0)
    wake_C2_p: float = quantity("-", "their C2 for beta_P > 0", 1.0)
    wake_C2_n: float = quantity("-", "their C2 for beta_P < 0", 1.0)
    wake_tau: float = quantity("-", "else w_P = w_P0 - wake_tau (v_P / U)^2; 0: not used", 0.0)
    wake_beta2: float = quantity("-", "else w_P = w_P0 exp(-wake_beta2 beta_P^2)", 0.0)
    wake_l_P: float = quantity("m", "lever of r in w_P0 [1 - (1-cos^2)(1-|beta_P|)]; 0: no", 0.0)
    y_P: float = quantity("m", "distance of each of two from the centreline; 0: one", 0.0)


_ONE_SIDED = math.radians(5.0)


@dataclasses.dataclass(frozen=True)
class Rudder:
    """Rudder, its effective-inflow law and its interaction with the hull.

    Of two rudders the numbers are those of the starboard one (the port one is its mirror image):
    ``gamma_R_p`` holds for the rudder on the leeward side of a turn, ``gamma_R_n`` to windward.
    """

    A_R: float = quantity("m2", "lateral area of the law")
    f_alpha: float = quantity("-", "gradient of the normal force coefficient")
    epsilon: float = quantity("-", "ratio of the wake at the rudder to that at the propeller")
    kappa: float = quantity("-", "share of the race's acceleration that reaches the rudder")
    eta: float = quantity("-", "share of the rudder's height in the race, D / H_R")
    gamma_R_p: float = quantity("-", "flow straightening for beta_R > 0 (turn to starboard)")
    gamma_R_n: float = quantity("-", "flow straightening for beta_R < 0 (turn to port)")
    l_R: float = quantity("m", "effective lever of the yaw rate in beta_R, aft of midship negative")
    x_R: float = quantity("m", "position of the rudder stock, aft of midship negative")
    t_R: float = quantity("-", "steering resistance deduction")
    a_H: float = quantity("-", "rudder force increase by the hull")
    x_H: float = quantity("m", "point of attack of that increase, aft of midship negative")
    y_R: float = quantity("m", "distance of each of two from the centreline; 0: one", 0.0)
    gamma_R_over: float = quantity("rad", "beta_R at which gamma_R is that side's own", _ONE_SIDED)
    neutral: float = quantity("rad", "angle without force straight ahead, of a single screw", 0.0)
    v_rrr: float = quantity("-", "c_Rrrr of Son & Nomoto (1982), v_R by r'^3", 0.0)
    v_rrv: float = quantity("-", "their c_Rrrv, v_R by r'^2 v'", 0.0)
    beaufoy: float = quantity("-", "1: Beaufoy's formula instead of the effective inflow", 0.0)


@dataclasses.dataclass(frozen=True)
class SteeringGear:
    """Steering gear: command to rate-limited rudder angle."""

    delta_max: float = quantity("rad", "largest rudder angle")
    rate: float = quantity("rad/s", "rudder rate")


@dataclasses.dataclass(frozen=True)
class Engine:
    """Engine with a constant-rpm governor; torque and inertia are of each shaft."""

    n_max: float = quantity("rev/s", "largest propeller speed")
    rate: float = quantity("rev/s2", "largest change of propeller speed per second")
    time_constant: float = quantity("s", "first-order lag; 0: none")
    torque_max: float = quantity("N m", "torque limit at the propeller", math.inf)
    n_astern: float = quantity("rev/s", "largest propeller speed astern; 0: no reversing", 0.0)
    reversal_time: float = quantity("s", "to stop and restart the other way; 0: none", 0.0)
    torque_brake: float = quantity("N m", "against turning: friction, compression, air", 0.0)
    shaft_inertia: float = quantity("kg m2", "shaft, engine and propeller in water; 0: none", 0.0)


@dataclasses.dataclass(frozen=True)
class OpenWater:
    """Axis of the open-water table (advance angle in the wake)."""

    start: float = quantity("rad", "first advance angle")
    step: float = quantity("rad", "distance of the grid points")


@dataclasses.dataclass(frozen=True)
class Surrogate:
    """Axes, trained box and reference area of the deflected-rudder surrogate."""

    delta: float = quantity("rad", "trained rudder angle, the smallest; 0: no surrogate", 0.0)
    delta_step: float = quantity("rad", "step to the next trained rudder angle", 1.0)
    sin_delta: float = quantity("-", "its sine", 0.0)
    cos_delta: float = quantity("-", "its cosine", 1.0)
    S_R: float = quantity("m2", "reference area of C_N, C_A", 0.0)
    J_min: float = quantity("-", "trained box: smallest advance ratio", 0.0)
    J_max: float = quantity("-", "trained box: largest advance ratio", 1.0)
    beta_min: float = quantity("rad", "trained box: smallest drift angle", 0.0)
    beta_max: float = quantity("rad", "trained box: largest drift angle", 1.0)
    epsilon_start: float = quantity("rad", "table: first advance angle", 0.0)
    epsilon_step: float = quantity("rad", "table: step of the advance angle", 1.0)
    beta_start: float = quantity("rad", "table: first drift angle", 0.0)
    beta_step: float = quantity("rad", "table: step of the drift angle", 1.0)
    law_std: float = quantity("-", "rms relative error of the law fitted to the samples", 0.0)
    z_T: float = quantity("-", "thrust moved by this many standard deviations", 0.0)
    z_Q: float = quantity("-", "torque moved by this many standard deviations", 0.0)
    z_S: float = quantity("-", "propeller side force moved by this many", 0.0)
    z_N: float = quantity("-", "rudder normal force moved by this many, at every rudder angle", 0.0)
    z_A: float = quantity("-", "rudder chordwise force moved by this many", 0.0)


@dataclasses.dataclass(frozen=True)
class Inertia:
    """Dimensional mass matrix at midship, derived from the hull."""

    m_u: float = quantity("kg", "m + m_x")
    m_v: float = quantity("kg", "m + m_y")
    m_xG: float = quantity("kg m", "m x_G")
    I_r: float = quantity("kg m2", "I_zG + x_G^2 m + J_z")


@dataclasses.dataclass(frozen=True)
class HullForm:
    """Shape of the hull under water and the mass distribution, for waves; optional.

    ``seakeeping.hull_form`` draws a hull from it, ``seakeeping.snnm`` and the motions in waves read
    the lengths, draughts and radii. The trim is for the added resistance only: every mesh is on
    even keel at the mean draught ``hull.d``.
    """

    C_m: float = quantity("-", "midship section coefficient, by B d")
    C_wp: float = quantity("-", "waterplane coefficient, by L B")
    x_B: float = quantity("m", "centre of buoyancy, forward of midship positive")
    x_F: float = quantity("m", "centre of the waterplane, forward of midship positive")
    parallel: float = quantity("m", "half length of the parallel middle body, about midship")
    b_transom: float = quantity("-", "breadth of the waterline at the transom, by B; 0: pointed")
    a_transom: float = quantity("-", "area of the transom under water, by C_m B d")
    x_keel: float = quantity("m", "aft of here the keel rises to the transom; forward positive")
    L_E: float = quantity("m", "length of entrance of the waterline, to 0.99 of the beam")
    L_R: float = quantity("m", "length of run of the waterline, to 0.99 of the beam")
    KG: float = quantity("m", "centre of gravity above the keel")
    GM: float = quantity("m", "transverse metacentric height")
    k_xx: float = quantity("m", "radius of gyration in roll about the centre of gravity")
    k_yy: float = quantity("m", "radius of gyration in pitch about the centre of gravity")
    trim: float = quantity("m", "draught at the stern minus draught at the bow", 0.0)
    q_wl_aft: float = quantity("-", "exponent of the waterline's aft end: 1 angle, 0.5 round", 1.0)
    q_wl_fore: float = quantity("-", "exponent of the waterline's fore end, above 1 hollow", 1.0)
    q_area_aft: float = quantity("-", "exponent of the sectional area's aft end", 1.4)
    q_area_fore: float = quantity("-", "exponent of the sectional area's fore end", 1.4)
    l_bulb: float = quantity("m", "bulb: length ahead of the forward perpendicular; 0: none", 0.0)
    a_bulb: float = quantity("-", "bulb: sectional area at the perpendicular, by C_m B d", 0.0)
    b_bulb: float = quantity("-", "bulb: breadth there, by B", 0.0)
    z_bulb: float = quantity("-", "bulb: height of its middle there above the keel, by d", 0.0)
    z_nose: float = quantity("-", "bulb: height of its foremost point above the keel, by d", 0.0)


@dataclasses.dataclass(frozen=True)
class WindAreas:
    """What the wind sees of a ship above the water; the last three are for Isherwood only."""

    L_oa: float = quantity("m", "length over all")
    A_F: float = quantity("m2", "frontal projected area")
    A_L: float = quantity("m2", "lateral projected area")
    s_L: float = quantity("m", "centroid of the lateral area, forward of midship positive")
    s_H: float = quantity("m", "centroid of the lateral area above the water")
    A_SS: float = quantity("m2", "lateral area of the superstructure; 0: not given", 0.0)
    perimeter: float = quantity("m", "outline of the lateral area, no waterline, no masts", 0.0)
    masts: float = quantity("-", "distinct groups of masts seen from the side", 0.0)


@dataclasses.dataclass(frozen=True)
class PropulsionPoint:
    """Published self-propulsion on a straight course in calm water, to compare with; SI."""

    source: str
    speed: float  # [m/s] at the scale of this ship
    n: float | None = None  # propeller speed [rev/s]
    thrust: float | None = None  # of all propellers [N]
    effective_power: float | None = None  # resistance times speed [W]
    delivered_power: float | None = None  # of all propellers [W]


@dataclasses.dataclass(frozen=True)
class Ship:
    """A ship: particulars in SI, its propeller tables, and where each number comes from.

    Attributes
    ----------
    full_length : float
        Length of the full-scale ship [m]; this one's own if it is no model.
    rho, nu : float
        Water density [kg/m3] and kinematic viscosity [m2/s].
    speed : float
        Nominal speed [m/s], of the ship file or, see `at_share`, a share of that.
    share : float
        Of the ship file's nominal speed that `speed` is.
    open_water : Table
        C_T, C_Q over the advance angle.
    surrogate : Table or None
        CFD surrogate at the trained rudder angle; None: MMG rudder, open-water propeller.
    wind : WindAreas or None
        Areas above the water; None: the ship cannot sail in wind.
    wind_type : str
        Type of ship for Blendermann's coefficients, ``sea.wind_coefficients.ship_types``.
    wave_table : str
        Path of its wave table, of any scale; empty: the ship cannot sail in waves.
    wave_state : tuple of int
        Time and size of that file when the ship was loaded: a table that is computed anew is read
        by the next ship that is loaded, and a ship that sails keeps hers.
    form : HullForm or None
        Hull form and mass distribution, for meshes and loads in waves; None: not in the file.
    propulsion : tuple of PropulsionPoint
        Published points of self-propulsion, beside those of ``powering.powering``.
    sources : dict
        "section.field" to the source of its number.
    estimated : dict
        "section.field" to the reason, for every number that no source prints for this ship.
    strict : bool
        False: numbers outside the ranges of ``plausible`` are a warning, not an error.
    implausible : tuple of str
        A line for each such number; empty if the ship is strict.
    """

    name: str
    title: str
    status: str
    full_length: float
    rho: float
    nu: float
    speed: float
    hull: Hull
    propeller: Propeller
    rudder: Rudder
    gear: SteeringGear
    engine: Engine
    open_water: Table
    surrogate: Table | None = None
    surrogate_name: str = "none"
    variant: str = "published"
    trials: tuple[Trial, ...] = ()
    form: HullForm | None = None
    wind: WindAreas | None = None
    wind_type: str = ""
    wave_table: str = ""
    wave_state: tuple[int, ...] = ()
    propulsion: tuple[PropulsionPoint, ...] = ()
    share: float = 1.0
    sources: dict[str, str] = dataclasses.field(default_factory=dict, hash=False)
    estimated: dict[str, str] = dataclasses.field(default_factory=dict, hash=False)
    strict: bool = True
    implausible: tuple[str, ...] = ()

    @property
    def mass(self) -> float:
        """Displacement mass [kg]."""
        return self.rho * self.hull.volume

    @property
    def propellers(self) -> int:
        """1 on the centreline or 2."""
        return 2 if self.propeller.y_P > 0.0 else 1

    @property
    def inertia(self) -> Inertia:
        """Dimensional mass matrix."""
        h, m = self.hull, self.mass
        added = 0.5 * self.rho * h.L**2 * h.d
        I_r = m * (h.k_zz**2 + h.x_G**2) + h.J_z * added * h.L**2
        return Inertia(m + h.m_x * added, m + h.m_y * added, m * h.x_G, I_r)

    @property
    def scale(self) -> float:
        """Length of the full-scale ship divided by this one's, 1 for full scale."""
        return self.full_length / self.hull.L

    @property
    def time_unit(self) -> float:
        """Model second in full-scale seconds by Froude's law: sqrt(scale)."""
        return math.sqrt(self.scale)

    @property
    def file_speed(self) -> float:
        """Nominal speed of the ship file [m/s]."""
        return self.speed / self.share

    def at_share(self, share: float) -> Ship:
        """Give the ship with a share of the ship file's nominal speed, whatever she has now.

        Only the speed changes that everything non-dimensional refers to: hull, propeller and
        resistance coefficients stay those of the file.
        """
        if share == self.share:
            return self
        return dataclasses.replace(self, speed=share * self.file_speed, share=share)

    def describe(self) -> str:
        """What the model is, its power beside published ones and its estimates, as text."""
        from ship_gym.ships.powering import powering_text  # late: it is about ships

        lines = [
            f"{self.name}: {self.title}",
            f"  status: {self.status}; hull set: {self.variant}; surrogate: {self.surrogate_name}",
            f"  L {self.hull.L:.4g} m, B {self.hull.B:.4g} m, d {self.hull.d:.4g} m, "
            f"nominal speed {self.speed:.4g} m/s (Fn {self.froude(self.speed):.3f})",
        ]
        lines += [f"  {line}" for line in powering_text(self)]
        lines += [f"  estimated {name}: {why}" for name, why in self.estimated.items()]
        lines += [f"  implausible {line}" for line in self.implausible]
        return "\n".join(lines)

    def froude(self, speed: float) -> float:
        """Froude number of a speed [m/s]."""
        return speed / math.sqrt(G * self.hull.L)
