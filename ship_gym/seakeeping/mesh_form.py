"""What loads in waves need of a section ``form``, from a mesh, for a ship file without one.

Entrance and run come from the mesh's waterline, its metacentre from its hydrostatics. How the mass
lies, no mesh tells: see `form_of_mesh`.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from ship_gym.seakeeping.hull_mesh import HullMesh
from ship_gym.seakeeping.hydrostatics import hydrostatics
from ship_gym.ships.particulars import HullForm, Ship

_SHORTEST = 0.05  # L of entrance and run: `ranges` allows no shorter one
_BEAM = 0.99  # of the beam, to where entrance and run reach
_LEAST_GM = 0.02  # by B; the ships of the package have 0.012 to 0.11
_K_XX = 0.37  # by B; they have 0.325 to 0.40
_K_YY = 0.25  # by L; they have 0.24 to 0.251
ASSUMED = (
    "no [form] in the ship file: centre of gravity in the waterline, or lower for GM = 0.02 B; "
    "k_xx = 0.37 B, k_yy = 0.25 L"
)


def form_of_mesh(mesh: HullMesh, ship: Ship) -> HullForm:
    """Form of a ship from her panels, for loads in waves.

    The centre of gravity is put into the waterline, or so much lower that GM = 0.02 B, with radii
    of gyration 0.37 B in roll and 0.25 L in pitch: assumptions (`ASSUMED`), which roll depends on.

    Parameters
    ----------
    mesh : HullMesh
        Below the waterline, ship axes [m].
    ship : Ship

    Returns
    -------
    HullForm
        What only a drawn hull needs (transom, keel, midship section) is of no meaning here.
    """
    found, L, B = hydrostatics(mesh), ship.hull.L, ship.hull.B
    KG = min(ship.hull.d, found.KM - _LEAST_GM * B)
    L_E, L_R = _ends(mesh, L)
    C_wp = min(1.0, found.A_wp / (L * B))
    return HullForm(
        C_m=1.0,
        C_wp=C_wp,
        x_B=found.x_B,
        x_F=found.x_F,
        parallel=0.0,
        b_transom=0.0,
        a_transom=0.0,
        x_keel=0.0,
        L_E=L_E,
        L_R=L_R,
        KG=KG,
        GM=found.KM - KG,
        k_xx=_K_XX * B,
        k_yy=_K_YY * L,
    )


def _ends(mesh: HullMesh, L: float) -> tuple[float, float]:
    """Length of entrance and of run [m]: from the ends of the waterline to 0.99 of the beam."""
    x, y = mesh.vertices[np.abs(mesh.vertices[:, 2]) < 1e-6 * L, :2].T
    full = x[np.abs(y) >= _BEAM * np.abs(y).max()]
    ends = np.array([x.max() - full.max(), full.min() - x.min()])
    entrance, run = np.clip(ends, _SHORTEST * L, L).tolist()
    return entrance, run


def with_form(ship: Ship, mesh: HullMesh) -> tuple[Ship, HullMesh]:
    """The ship with a form, of the mesh if the file has none; the mesh's report then says so."""
    if ship.form is not None:
        return ship, mesh
    ship = dataclasses.replace(ship, form=form_of_mesh(mesh, ship))
    return ship, mesh.with_report(ASSUMED)
