"""Parameters of a ship as kernels read them: named tuples, so that it reads ``ship.hull.L``.

Kernels that a loop over ships is made of get a `ShipParameters` whose numbers come from a scratch
of columns (`ship_at`); whoever has one record of ``ship_gym.ships.records`` may pass that instead,
or make a tuple of it (`of_record`). Meaning and unit of every number: ``ships.particulars``.

What none of the ships of a batch has is a constant there (`Traits`), so that the compiler leaves
out what belongs to it: two propellers, one of four wake laws, drawn surrogates and so on.
"""

from __future__ import annotations

import os
from collections import namedtuple
from typing import Any

import numpy as np

from ship_gym.physics._kernel import inlined

Hull = namedtuple(
    "Hull",
    "L d C_D R_0 X_vv X_vr X_rr X_vvvv Y_v Y_r Y_vvv Y_vvr Y_vrr Y_rrr "
    "N_v N_r N_vvv N_vvr N_vrr N_rrr",
)
Propeller = namedtuple(
    "Propeller",
    "D x_P t_P w_P0 wake_C1 wake_C2_p wake_C2_n wake_tau wake_beta2 wake_l_P y_P",
)
Rudder = namedtuple(
    "Rudder",
    "A_R f_alpha epsilon kappa eta gamma_R_p gamma_R_n l_R x_R t_R a_H x_H y_R gamma_R_over "
    "neutral v_rrr v_rrv beaufoy",
)
SteeringGear = namedtuple("SteeringGear", "delta_max rate")
Engine = namedtuple(
    "Engine",
    "n_max rate time_constant torque_max n_astern reversal_time torque_brake shaft_inertia",
)
Inertia = namedtuple("Inertia", "m_u m_v m_xG I_r")
OpenWater = namedtuple("OpenWater", "start step")
Surrogate = namedtuple(
    "Surrogate",
    "delta delta_step sin_delta cos_delta S_R J_min J_max beta_min beta_max epsilon_start "
    "epsilon_step beta_start beta_step law_std z_T z_Q z_S z_N z_A",
)
SECTIONS: dict[str, Any] = {
    "hull": Hull,
    "propeller": Propeller,
    "rudder": Rudder,
    "gear": SteeringGear,
    "engine": Engine,
    "inertia": Inertia,
    "open_water": OpenWater,
    "surrogate": Surrogate,
}
ShipParameters = namedtuple("ShipParameters", ("rho", *SECTIONS))  # type: ignore[misc]
# in the order of a ship's record behind its `kind`
COLUMNS = (("rho",), *((name, field) for name, part in SECTIONS.items() for field in part._fields))
N_PARAMETERS = len(COLUMNS)

# trait -> what it means that no ship has it: these parameters have these values
ABSENT = {
    "twin": {("propeller", "y_P"): 0.0, ("rudder", "y_R"): 0.0},
    "spread": {("surrogate", f"z_{k}"): 0.0 for k in "TQSNA"},
    "lever_wake": {("propeller", "wake_l_P"): 0.0},
    "yasukawa_wake": {("propeller", "wake_C1"): 0.0},
    "sway_wake": {("propeller", "wake_tau"): 0.0},
    "cubic_inflow": {("rudder", "v_rrr"): 0.0, ("rudder", "v_rrv"): 0.0},
    "beaufoy": {("rudder", "beaufoy"): 0.0},
    "torque_limit": {("engine", "torque_max"): np.inf},
    "astern": {("engine", "n_astern"): 0.0},
}
Traits = namedtuple("Traits", ("each", *ABSENT))  # type: ignore[misc]  # computed
"""For each trait 1 if a ship of the batch has it, else None: a type to numba, so a constant."""


def as_numbers(ships: np.ndarray) -> np.ndarray:
    """Records of ships, shape (n,), seen as numbers, shape (n, 2 + N_PARAMETERS); no copy."""
    return np.asarray(ships).view(np.float64).reshape(len(ships), -1)


def traits_of(ships: np.ndarray, expected: tuple[str, ...] = ()) -> Traits:
    """Traits of some ships' records, shape (n,), and those that are expected.

    All of them where the environment variable ``SHIP_GYM_ONE_VERSION`` is set: then one version of
    the compiled kernels serves all ships, with the same bits. It saves compiling where many ships
    sail a little, as in tests; large batches of one ship take twice the time.
    """
    if os.environ.get("SHIP_GYM_ONE_VERSION"):
        return Traits(*[1] * len(Traits._fields))
    bits = as_numbers(ships).view(np.int64)
    found = {"each": (bits != bits[0]).any()} | {
        name: any((ships[part][field] != value).any() for (part, field), value in off.items())
        for name, off in ABSENT.items()
    }
    return Traits(**{name: 1 if yes or name in expected else None for name, yes in found.items()})


@inlined
def unless(trait, value, otherwise):
    """The value if a ship of the batch has the trait, else the constant."""
    if trait is None:
        return otherwise
    return value


def _made(argument: str, of_column, extra: str = ""):
    """Function that makes a `ShipParameters`, its text written from the columns above."""
    trait = {place: (name, off[place]) for name, off in ABSENT.items() for place in off}
    values = {}
    for k, place in enumerate(COLUMNS):
        value = of_column(k, place)
        if extra and place in trait:
            name, otherwise = trait[place]
            value = f"unless(traits.{name}, {value}, {float(otherwise)!r})"
        values[place] = value
    parts = ", ".join(
        f"{cls.__name__}({', '.join(values[name, field] for field in cls._fields)})"
        for name, cls in SECTIONS.items()
    )
    text = f"def made({argument}{extra}):\n    return ShipParameters({values['rho',]}, {parts})\n"
    scope = {cls.__name__: cls for cls in SECTIONS.values()}
    scope |= {"ShipParameters": ShipParameters, "unless": unless, "inf": np.inf}
    exec(text, scope)
    return inlined(scope["made"])


ship_at = _made("x, i", lambda k, place: f"x.ship[{k}, i]", ", traits")
"""``ship_at(x, i, traits)``: parameters of lane i of a scratch ``physics.step.SCRATCH``."""
of_record = _made("record", lambda k, place: f"record.{'.'.join(place)}")
"""``of_record(record)``: parameters of one ship from its record."""


@inlined
def of_lane(x, i, traits, common):
    """Parameters of lane i; those in `common` if all ships of the batch are one."""
    if traits.each is None:
        return common
    return ship_at(x, i, traits)


def _fill_lane():
    """Function that writes a record's parameters into a lane, its text written from the columns."""
    lines = [f"    x.ship[{k}, i] = record.{'.'.join(place)}" for k, place in enumerate(COLUMNS)]
    scope: dict = {}
    exec("def fill_lane(x, i, record):\n" + "\n".join(lines) + "\n", scope)
    return inlined(scope["fill_lane"])


fill_lane = _fill_lane()
"""``fill_lane(x, i, record)``: write the parameters of a ship's record into lane i."""
