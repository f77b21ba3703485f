"""Physical range of every number of a ship, by dimension: lengths by L, areas by L d, and so on.

A range is what a ship can have, not what she should have: it spans the published ships with room,
by a factor of about three where nothing else bounds it, and leaves out slips of a unit, of a sign
and of the scale. ``published`` is what the nine ships of the package span, their hull variants and
surrogates included; their sources stand in the ship files, and a test holds the two together.
``plausible`` checks ships against this table and knows what each basis is (``BASES``).
"""

from __future__ import annotations

import math
from typing import NamedTuple

INF = math.inf
ANY = (-INF, INF)
TINY = 5e-324  # the least number above zero
BOX = 1.00001  # C_B of a box, whose volume is printed with six digits
POSITIVE = (TINY, INF)
NOT_NEGATIVE = (0.0, INF)


class Range(NamedTuple):
    """What one number may be, in units of `by`.

    Attributes
    ----------
    low, high : float
        Of a ship that exists; ``strict = false`` lets others pass, with a warning.
    by : str
        Basis, of ``plausible.BASES``; empty: the number as it stands, in SI.
    published : (float, float)
        Smallest and largest of the ships of the package, rounded to three digits; None: they have
        none.
    must : (float, float)
        Outside nothing can be computed, whatever the ship file says: the number is divided by, a
        root is taken of it, or energy comes from nowhere.
    endless : bool
        Whether infinity stands for no limit at all.
    """

    low: float
    high: float
    by: str = ""
    published: tuple[float, float] | None = None
    must: tuple[float, float] = ANY
    endless: bool = False


# Water of 0 to 40 deg C, fresh to as salt as the sea, has 990 to 1030 kg/m3 and 0.65e-6 to
# 1.85e-6 m2/s. Lengths: from the smallest models to the largest ships.
TOP = {
    "full_length": Range(0.5, 500.0, "", (154.0, 355.0), POSITIVE),
    "full_length / hull.L": Range(0.3, 300.0, "", (1.0, 75.2)),
    "rho": Range(985.0, 1035.0, "", (999.0, 1030.0), POSITIVE),
    "nu": Range(0.6e-6, 2e-6, "", (1.14e-6, 1.19e-6), POSITIVE),
    "speed": Range(0.03, 0.7, "sqrt(g L)", (0.142, 0.25), POSITIVE),
}

# Signs: of every published ship Y_v, N_v, N_r damp or turn as here. Y_vrr has the sign of Y_v: a
# copy of KCS' set A with +0.8341 circulates, in the beta form, and turns at 36 deg of drift.
HULL = {
    "L": Range(0.5, 500.0, "", (3.06, 355.0), POSITIVE),
    "B": Range(0.05, 0.5, "L", (0.122, 0.181), POSITIVE),
    "d": Range(0.08, 1.0, "B", (0.284, 0.362), POSITIVE),
    "volume": Range(0.25, BOX, "L B d", (0.535, 0.8), (TINY, BOX)),  # C_B
    "x_G": Range(-0.1, 0.1, "L", (-0.0164, 0.0357)),
    "k_zz": Range(0.15, 0.4, "L", (0.24, 0.251), POSITIVE),
    "S": Range(0.7, 1.6, "L (1.7 d + C_b B)", (1.0, 1.06), POSITIVE),  # Denny-Mumford
    "form_factor": Range(0.9, 1.7, "", (1.09, 1.23), POSITIVE),
    "C_A": Range(-0.0005, 0.002, "", (0.000204, 0.000424)),
    "C_D": Range(0.1, 2.5, "", (0.967, 0.967), NOT_NEGATIVE),
    "R_0": Range(0.002, 0.08, "", (0.00762, 0.0197), POSITIVE),
    "X_vv": Range(-0.5, 0.02, "", (-0.105, -0.04)),
    "X_vr": Range(-0.5, 0.3, "", (-0.0649, 0.002)),
    "X_rr": Range(-0.2, 0.2, "", (-0.0162, 0.011)),
    "X_vvvv": Range(-1.0, 4.0, "", (-0.076, 0.771)),
    "Y_v": Range(-1.2, -0.03, "", (-0.315, -0.203)),
    "Y_r": Range(-0.3, 0.4, "", (0.0306, 0.083)),
    "Y_vvv": Range(-8.0, 0.0, "", (-2.24, -1.61)),
    "Y_vvr": Range(-3.0, 3.0, "", (-0.75, 0.542)),
    "Y_vrr": Range(-4.0, 0.3, "", (-1.1, -0.391)),
    "Y_rrr": Range(-0.3, 0.3, "", (-0.051, 0.0487)),
    "N_v": Range(-0.6, 0.0, "", (-0.137, -0.0714)),
    "N_r": Range(-0.25, -0.005, "", (-0.049, -0.0374)),
    "N_vvv": Range(-1.5, 0.8, "", (-0.291, 0.0634)),
    "N_vvr": Range(-4.0, 0.2, "", (-0.881, -0.294)),
    "N_vrr": Range(-1.0, 0.5, "", (-0.188, 0.0705)),
    "N_rrr": Range(-0.3, 0.05, "", (-0.0485, -0.013)),
    "m_x": Range(0.0, 0.1, "", (0.00204, 0.022)),
    "m_y": Range(0.02, 0.8, "", (0.11, 0.223)),
    "J_z": Range(0.001, 0.05, "", (0.00845, 0.011)),
}

PROPELLER = {
    "D": Range(0.2, 1.3, "d", (0.47, 0.949), POSITIVE),
    "x_P": Range(-0.65, -0.3, "L", (-0.541, -0.427)),
    "t_P": Range(-0.1, 0.5, "", (0.077, 0.22), (-INF, 0.99)),
    "w_P0": Range(-0.3, 0.7, "", (-0.153, 0.4), (-INF, 0.99)),
    "wake_C1": Range(0.0, 10.0, "", (0.0, 2.0), NOT_NEGATIVE),
    "wake_C2_p": Range(0.0, 4.0, "", (1.0, 1.6)),
    "wake_C2_n": Range(0.0, 4.0, "", (1.0, 1.1)),
    "wake_tau": Range(0.0, 5.0, "", (0.0, 1.09), NOT_NEGATIVE),
    "wake_beta2": Range(0.0, 20.0, "", (0.0, 4.0), NOT_NEGATIVE),
    "wake_l_P": Range(-1.5, 0.0, "L", (-0.7, 0.0)),
    "y_P": Range(0.0, 0.5, "B", (0.0, 0.219), NOT_NEGATIVE),
}

RUDDER = {
    "A_R": Range(0.004, 0.1, "L d", (0.0167, 0.034), POSITIVE),  # of each
    "f_alpha": Range(1.0, 6.2, "", (2.19, 3.01), POSITIVE),
    "epsilon": Range(0.4, 1.8, "", (0.662, 1.09)),
    "kappa": Range(0.0, 1.5, "", (0.5, 1.0)),
    "eta": Range(0.2, 1.0, "", (0.626, 0.87), (TINY, 1.0)),  # a share of the rudder's height
    "gamma_R_p": Range(0.0, 1.5, "", (0.088, 0.64)),
    "gamma_R_n": Range(0.0, 1.5, "", (0.088, 0.748)),
    "l_R": Range(-4.0, -0.2, "L", (-1.79, -0.71)),
    "x_R": Range(-0.65, -0.3, "L", (-0.515, -0.456)),
    "t_R": Range(-0.1, 0.8, "", (0.0, 0.441)),
    "a_H": Range(-0.1, 1.0, "", (0.182, 0.361)),
    "x_H": Range(-0.8, -0.2, "L", (-0.495, -0.436)),
    "y_R": Range(0.0, 0.5, "B", (0.0, 0.219), NOT_NEGATIVE),
    "gamma_R_over": Range(0.0, 60.0, "deg", (5.0, 5.0), (0.0, 180.0)),
    "neutral": Range(-10.0, 10.0, "deg", (0.0, 0.55)),
    "v_rrr": Range(-5.0, 5.0, "", (-0.304, 0.0)),
    "v_rrv": Range(-10.0, 10.0, "", (0.0, 1.96)),
    "beaufoy": Range(0.0, 1.0, "", (0.0, 0.0), (0.0, 1.0)),
}

GEAR = {
    "delta_max": Range(5.0, 80.0, "deg", (35.0, 35.0), (TINY, 90.0)),
    # 65 deg in 28 s (SOLAS) is 3.3 of a ship of 20 m; a rate of the other scale is outside
    "rate": Range(3.0, 80.0, "deg / sqrt(L/g)", (11.2, 21.1), POSITIVE),
}

ENGINE = {
    "n_max": Range(0.4, 10.0, "U/D", (1.37, 2.56), POSITIVE),
    "rate": Range(0.001, 20.0, "n_max / sqrt(L/g)", (0.0272, 0.0479), POSITIVE),
    "time_constant": Range(0.0, 30.0, "sqrt(L/g)", (0.805, 2.47), NOT_NEGATIVE),
    "torque_max": Range(0.002, 10.0, "rho n_max^2 D^5", (0.0162, 0.0559), POSITIVE, endless=True),
    "n_astern": Range(0.0, 1.0, "n_max", (0.6, 0.6), (0.0, 1.0)),
    "reversal_time": Range(0.0, 60.0, "sqrt(L/g)", (2.49, 3.78), NOT_NEGATIVE),
    "torque_brake": Range(0.0, 1.0, "torque_max", (0.2, 0.2), NOT_NEGATIVE),
    "shaft_inertia": Range(0.0, 1.0, "rho D^5", (0.00999, 0.01), NOT_NEGATIVE),
}


def _drawn(low: float, high: float, by: str, published: tuple[float, float]) -> Range:
    """Range of the form: a hull is drawn from it, which nothing outside makes possible."""
    return Range(low, high, by, published, (low, high))


FORM = {
    "C_m": _drawn(0.4, 1.0, "", (0.83, 0.998)),
    "C_wp": _drawn(0.4, 1.0, "", (0.7, 0.89)),
    "x_B": _drawn(-0.15, 0.15, "L", (-0.0164, 0.0357)),
    "x_F": _drawn(-0.15, 0.15, "L", (-0.055, 0.005)),
    "parallel": _drawn(0.0, 0.45, "L", (0.0, 0.18)),
    "b_transom": _drawn(0.0, 1.0, "", (0.1, 0.75)),
    "a_transom": _drawn(0.0, 1.0, "", (0.0004, 0.05)),
    "x_keel": _drawn(-0.5, 0.0, "L", (-0.465, -0.2)),
    "L_E": _drawn(0.05, 1.0, "L", (0.3, 0.4)),
    "L_R": _drawn(0.05, 1.0, "L", (0.15, 0.3)),
    "KG": _drawn(0.0, 1.0, "B", (0.32, 0.474)),
    "GM": _drawn(0.0, 1.0, "B", (0.0118, 0.11)),
    "k_xx": _drawn(0.1, 1.0, "B", (0.325, 0.4)),
    "k_yy": _drawn(0.1, 0.5, "L", (0.24, 0.251)),
    "trim": _drawn(-1.0, 1.0, "d", (0.0, 0.0)),
    "q_wl_aft": _drawn(0.3, 4.0, "", (0.67, 1.0)),
    "q_wl_fore": _drawn(0.3, 4.0, "", (0.6, 1.55)),
    "q_area_aft": _drawn(0.3, 4.0, "", (1.4, 1.58)),
    "q_area_fore": _drawn(0.3, 4.0, "", (1.0, 2.01)),
    "l_bulb": _drawn(0.0, 0.1, "L", (0.0, 0.0312)),
    "a_bulb": _drawn(0.0, 0.3, "", (0.0, 0.1)),
    "b_bulb": _drawn(0.0, 1.0, "", (0.0, 0.16)),
    "z_bulb": _drawn(0.0, 1.0, "", (0.0, 0.563)),
    "z_nose": _drawn(0.0, 1.0, "", (0.0, 0.75)),
}

WIND = {
    "L_oa": Range(0.9, 1.4, "L", (1.0, 1.06), POSITIVE),
    "A_F": Range(0.03, 6.0, "B^2", (0.356, 1.01), POSITIVE),
    "A_L": Range(0.004, 0.5, "L^2", (0.0361, 0.121), POSITIVE),
    "s_L": Range(-0.35, 0.35, "L_oa", (-0.0721, 0.0), (-0.5, 0.5)),
    "s_H": Range(0.002, 0.3, "L", (0.0219, 0.0587), POSITIVE),
    "A_SS": Range(0.0, 1.0, "A_L", (0.176, 0.688), NOT_NEGATIVE),
    "perimeter": Range(0.0, 5.0, "L_oa", (1.19, 1.35), NOT_NEGATIVE),
    "masts": Range(0.0, 10.0, "", (1.0, 1.0), NOT_NEGATIVE),
}

# At the lower end of the data the thrust of a propeller that pulls, and it falls with J.
OPEN_WATER = {
    "J_low": Range(0.0, 1.5, "", (0.0, 0.55), (-3.0, 3.0)),
    "J_high": Range(0.2, 2.5, "", (0.8, 1.35), (-3.0, 3.0)),
    "K_T at J_low": Range(0.05, 1.5, "", (0.293, 0.54)),
    "K_Q at J_low": Range(0.004, 0.4, "", (0.0311, 0.123)),
    "K_T at J_high": Range(-0.5, 0.5, "", (-0.0158, 0.219)),
    "mean slope of K_T": Range(-1.5, -0.15, "", (-0.513, -0.386)),
    # J K_T / (2 pi K_Q); a tenth of it where the data hold 10 K_Q
    "largest efficiency": Range(0.15, 0.95, "", (0.527, 0.859), (-INF, 1.0)),
}

# Trials and points of self-propulsion are at the scale of their ship; n by the point's own speed.
TRIAL = {
    "speed": Range(0.02, 0.8, "sqrt(g L)", (0.142, 0.26), POSITIVE),
    "delta_deg": Range(-80.0, 80.0, "", (-35.0, 35.0), (-90.0, 90.0)),
    "psi_deg": Range(-90.0, 90.0, "", (-20.0, 20.0), (-360.0, 360.0)),
    "n": Range(0.3, 10.0, "U/D", (0.861, 1.61), POSITIVE),
    "length": Range(0.3, 500.0, "", (6.07, 6.07), POSITIVE),
    "wave_height": Range(0.0, 0.2, "L", (0.0, 0.02), NOT_NEGATIVE),
    "wavelength": Range(0.0, 20.0, "", (0.0, 1.0), NOT_NEGATIVE),
    "wave_from_deg": Range(-360.0, 360.0, "", (0.0, 0.0), (-360.0, 360.0)),
    "facilities": Range(1, 1000, "", (1, 6), (1, INF)),
    "movable_factor": Range(0.1, 2.0, "", (1.07, 1.07), POSITIVE),
}
PROPULSION = {
    "speed": Range(0.02, 0.8, "sqrt(g L)", (0.142, 0.26), POSITIVE),
    "n": Range(0.3, 10.0, "U/D", (0.861, 1.89), POSITIVE),
    "thrust": Range(0.002, 0.3, "rho L d U^2 / 2", (0.0208, 0.0208), POSITIVE),
    "effective_power": Range(0.002, 0.1, "rho L d U^3 / 2", (0.00783, 0.00783), POSITIVE),
    "delivered_power": Range(0.002, 0.4, "rho L d U^3 / 2", None, POSITIVE),
}

RANGES: dict[str, dict[str, Range]] = {
    "hull": HULL,
    "propeller": PROPELLER,
    "rudder": RUDDER,
    "gear": GEAR,
    "engine": ENGINE,
    "form": FORM,
    "wind": WIND,
}
