"""Ships that cannot exist: each must be refused, by its numbers or by how it behaves.

A row is a ship of the package and the values that are put in place of its own, by dotted key; None
takes a key away. Values are in the units of the file.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

NAME = "impossible ship"
KCS, VL, DTC = "kcs_model", "kvlcc2_model", "dtc_model"

IMPOSSIBLE: tuple[tuple[str, dict[str, Any]], ...] = (
    # the whole
    (KCS, {"title": ["a", "list"]}),
    (KCS, {"full_length.value": -320.0}),
    (KCS, {"full_length.value": 0.0}),
    (KCS, {"full_length.value": 3.0e6}),
    (KCS, {"rho.value": 1.025}),
    (KCS, {"rho.value": 1.0e6}),
    (KCS, {"rho.value": -999.0}),
    (KCS, {"nu.value": -1.1386e-6}),
    (KCS, {"nu.value": 0.0}),
    (KCS, {"nu.value": 1.1386}),
    (KCS, {"speed.value": 0.0}),
    (KCS, {"speed.value": -0.86}),
    (KCS, {"speed.value": 86.0}),
    # the hull
    (KCS, {"hull.L.value": 230.0}),
    (KCS, {"hull.L.value": -3.057}),
    (KCS, {"hull.B.value": 32.2}),
    (KCS, {"hull.B.value": 0.0}),
    (KCS, {"hull.d.value": 10.8}),
    (KCS, {"hull.d.value": 0.001}),
    (KCS, {"hull.volume.value": 52030.0}),
    (KCS, {"hull.volume.value": 0.00122}),
    (VL, {"hull.x_G.value": 25.0}),
    (KCS, {"hull.x_G.value": -4.5}),
    (KCS, {"hull.k_zz.value": 57.5}),
    (KCS, {"hull.k_zz.value": 0.00764}),
    (KCS, {"hull.S.value": 9424.0}),
    (KCS, {"hull.form_factor.value": -1.1}),
    (KCS, {"hull.form_factor.value": 11.0}),
    (KCS, {"hull.C_D.value": -0.97}),
    (KCS, {"hull.R_0": -0.022}),
    (KCS, {"hull.R_0": 0.0}),
    (KCS, {"hull.R_0": 1.83}),
    (KCS, {"hull.m_x": -0.5}),
    (KCS, {"hull.m_y": -0.15}),
    (KCS, {"hull.J_z": -0.0089}),
    (KCS, {"hull.m_x": 6.1}),
    (KCS, {"hull.Y_v": 0.231}),
    (KCS, {"hull.Y_v": -23.1}),
    (KCS, {"hull.N_r": 0.0446}),
    (KCS, {"hull.N_r": -4.46}),
    (KCS, {"hull.Y_vvv": 163.5}),
    (KCS, {"hull.X_vv": 7.26}),
    (KCS, {"hull.N_rrr": 3.44}),
    # the propeller
    (KCS, {"propeller.D.value": 7.9}),
    (KCS, {"propeller.D.value": -0.105}),
    (KCS, {"propeller.D.value": 0.00105}),
    (KCS, {"propeller.x_P.value": -336.0}),
    (KCS, {"propeller.x_P.value": 1.473}),
    (KCS, {"propeller.t_P": 1.78}),
    (KCS, {"propeller.w_P0": 1.353}),
    (KCS, {"propeller.w_P0": -3.0}),
    (VL, {"open_water.J_range": [1.0, 0.0]}),
    (KCS, {"open_water.degree": 40}),
    # the rudder
    (KCS, {"rudder.A_R.value": 54.45}),
    (KCS, {"rudder.A_R.value": -0.0096}),
    (KCS, {"rudder.f_alpha": -3.0}),
    (KCS, {"rudder.f_alpha": 300.0}),
    (KCS, {"rudder.epsilon": -1.0}),
    (KCS, {"rudder.eta.value": 626.0}),
    (KCS, {"rudder.kappa": 63.0}),
    (KCS, {"rudder.a_H": 90.0}),
    (KCS, {"rudder.t_R": 2.58}),
    (KCS, {"rudder.x_R.value": 1.527}),
    (KCS, {"rudder.x_R.value": -115.0}),
    (KCS, {"rudder.gamma_R_p": -4.9}),
    (KCS, {"rudder.x_H.value": 43.6}),
    # what moves and drives them
    (KCS, {"gear.delta_max.value": 350.0}),
    (KCS, {"gear.rate.value": -20.1}),
    (KCS, {"gear.rate.value": 0.0}),
    (KCS, {"engine.n_max.value": 0.0}),
    (KCS, {"engine.time_constant.value": -5.0}),
    (KCS, {"engine.rate.value": -1.5}),
    (KCS, {"engine.torque_max.value": -0.2363}),
)


def seeds() -> Iterator[Any]:
    """Each of the list as the input of a case."""
    from _fuzz_seeds import Seed, ships
    from _fuzz_values import toml

    whole = {seed.name: seed for seed in ships()}
    for name, values in IMPOSSIBLE:
        beside = {k: v for k, v in whole[name].files.items() if k != "ship.toml"}
        text = toml(_with(whole[name].files["ship.toml"], values))
        told = f"{name}: " + ", ".join(f"{key} = {value}" for key, value in values.items())
        yield Seed(told, {"ship.toml": text.encode(), **beside})


def _with(data: bytes, values: dict[str, Any]) -> dict[str, Any]:
    """The tree of a ship file with values by dotted key; each must be there before."""
    import tomllib

    tree = tomllib.loads(data.decode())
    for dotted, value in values.items():
        *path, last = dotted.split(".")
        holder = tree
        for key in path:
            holder = holder[key]
        if last not in holder:
            raise KeyError(f"{dotted}: the ship has no such key")
        holder[last] = value
    return tree
