"""Other simulators of ships in Python, timed where they are installed.

Each is called as its own documentation shows, with one second as the step: what a user of it pays
for a second at sea, in one process. The models are of different depth, none has waves.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ship_gym.reports.speed_child import Work, best_of, physics
from ship_gym.sea.state import CALM
from ship_gym.ships.loader import load_ship

# K_T of KVLCC2's propeller, Yasukawa & Yoshimura (2015), as in our ship file
_THRUST = {"k_0": 0.2931, "k_1": -0.2753, "k_2": -0.1385}
_SPAN = 100  # seconds in one call of shipmmg, which integrates a whole history


def mmgdynamics() -> Work:
    """``pstep`` of 1 s with its KVLCC2 of 64 m, as it integrates itself."""
    import mmgdynamics
    from mmgdynamics.calibrated_vessels import kvlcc2_l64

    vessel = mmgdynamics.Vessel(**kvlcc2_l64)
    water = dict.fromkeys(("water_depth", "fl_psi", "fl_vel", "w_vel", "beta_w"))
    now = {"X": [3.85, 0.0, 0.0], "pos": [0.0, 0.0], "psi": 0.0}

    def step(k: int) -> None:
        delta = math.radians(10.0 * (-1.0) ** (k // 20))
        uvr, (x, y, psi) = mmgdynamics.pstep(
            vessel=vessel, dT=1.0, nps=4.0, delta=delta, **now, **water
        )
        now.update(X=uvr, pos=[x, y], psi=psi)

    return Work(step, 1)


def shipmmg() -> Work:
    """``simulate_mmg_3dof`` over 100 s with KVLCC2's 7 m model, by each second of it.

    It interpolates a history of commands and steps as SciPy's RK45 thinks fit.
    """
    from shipmmg.mmg_3dof import simulate_mmg_3dof

    basic, derivatives, speed, n = shipmmg_ship()
    time = np.arange(_SPAN + 1.0)
    rudder, revolutions = np.full(_SPAN + 1, math.radians(10.0)), np.full(_SPAN + 1, n)
    return Work(
        lambda k: simulate_mmg_3dof(basic, derivatives, time, rudder, revolutions, u0=speed),
        _SPAN,
    )


def shipmmg_ship() -> tuple[Any, Any, float, float]:
    """Our KVLCC2 model in the records of shipmmg, her speed [m/s] and propeller speed [rev/s]."""
    from shipmmg.mmg_3dof import Mmg3DofBasicParams, Mmg3DofManeuveringParams

    from ship_gym.simulation import self_propulsion

    ship = load_ship("kvlcc2_model")
    hull, propeller, rudder = ship.hull, ship.propeller, ship.rudder
    L, d, rho = hull.L, hull.d, ship.rho
    mass, inertia = 0.5 * rho * L**2 * d, 0.5 * rho * L**4 * d
    m = rho * hull.volume
    basic = Mmg3DofBasicParams(
        L_pp=L, B=hull.B, d=d, x_G=hull.x_G, D_p=propeller.D, m=m, I_zG=m * hull.k_zz**2,
        A_R=rudder.A_R, η=rudder.eta, m_x=hull.m_x * mass, m_y=hull.m_y * mass,
        J_z=hull.J_z * inertia, f_α=rudder.f_alpha, ϵ=rudder.epsilon, t_R=rudder.t_R,
        x_R=rudder.x_R, a_H=rudder.a_H, x_H=rudder.x_H, γ_R_minus=rudder.gamma_R_n,
        γ_R_plus=rudder.gamma_R_p, l_R=rudder.l_R / L, κ=rudder.kappa, t_P=propeller.t_P,
        w_P0=propeller.w_P0, x_P=propeller.x_P / L,
    )  # fmt: skip
    names = "X_vv X_vr X_rr X_vvvv Y_v Y_r Y_vvv Y_vvr Y_vrr Y_rrr N_v N_r N_vvv N_vvr N_vrr N_rrr"
    derivatives = {f"{name}_dash": getattr(hull, name) for name in names.split()}
    made = Mmg3DofManeuveringParams(R_0_dash=hull.R_0, **_THRUST, **derivatives)
    return basic, made, ship.speed, self_propulsion(ship, ship.speed)


def python_vehicle_simulator() -> Work:
    """``shipClarke83.dynamics`` and the attitude of her 50 m ship: one Euler step of 1 s."""
    from python_vehicle_simulator.lib.gnc import attitudeEuler
    from python_vehicle_simulator.vehicles import shipClarke83

    vehicle = shipClarke83()
    now = {"eta": np.zeros(6), "nu": vehicle.nu, "u": vehicle.u_actual}

    def step(k: int) -> None:
        command = vehicle.stepInput(float(k % 100))
        nu, actual = vehicle.dynamics(now["eta"], now["nu"], now["u"], command, 1.0)
        now.update(eta=attitudeEuler(now["eta"], nu, 1.0), nu=nu, u=actual)

    return Work(step, 1)


# module -> (what is timed, work, where it is from)
PEERS: dict[str, tuple[str, Callable[[], Work], str]] = {
    "mmgdynamics": ("pstep of 1 s, one ship", mmgdynamics, "its repository: nikpau/mmgdynamics"),
    "shipmmg": ("simulate_mmg_3dof, by the second", shipmmg, 'pip install "ship-gym[peers]"'),
    "python_vehicle_simulator": (
        "shipClarke83, one Euler step of 1 s",
        python_vehicle_simulator,
        "its repository: cybergalactic/PythonVehicleSimulator",
    ),
}
# ours, the same way: a second of KVLCC2 at full scale in calm water, one integration step
OURS = {
    "Ship Gym, kvlcc2, one ship": lambda: physics(1, CALM, False, "kvlcc2"),
    "Ship Gym, kvlcc2, 4096 ships": lambda: physics(4096, CALM, False, "kvlcc2"),
}


def measure_peers(repeats: int, seconds: float) -> list[dict[str, Any]]:
    """Time ours and every peer that is installed.

    Returns
    -------
    list of dict
        ``name``, ``what``; ``seconds`` of one step (processor time), or None with a ``reason``.
    """
    rows = []
    for name, make in OURS.items():
        found = best_of(make(), repeats, seconds)
        rows.append({"name": name, "what": "ShipSim.step of 1 s", "seconds": found["processor"]})
    for name, (what, make, source) in PEERS.items():
        rows.append({"name": name, "what": what, **_peer(name, make, source, repeats, seconds)})
    return rows


def _peer(
    name: str, make: Callable[[], Work], source: str, repeats: int, seconds: float
) -> dict[str, Any]:
    if importlib.util.find_spec(name) is None:
        return {"seconds": None, "reason": f"not installed ({source})"}
    try:
        return {"seconds": best_of(make(), repeats, seconds)["processor"]}
    except Exception as error:  # another version of it than the one we know must not end the run
        return {"seconds": None, "reason": f"failed: {type(error).__name__}: {error}"}
