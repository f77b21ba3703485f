"""Tables that Knight (2021) prints of his surrogates, recomputed from his printed points.

What cannot be recomputed is said in the text, with the reason.
"""

from __future__ import annotations

from typing import Any

from reproduce import thesis_errors, thesis_fits, thesis_process
from ship_gym.text import paragraph

_MISSING = (
    "Not recomputable, because the forces are not in the thesis: points 13-28 (B.13, the 16 points "
    "of KCS in 3.7-3.10, the 16 and 24 points of 3.11 and 5.3.4), KCS with k-omega SST at points "
    "5-12 (A.10), and the movable part of the rudder (C_Fx and C_Fy of 3.11)."
)


def as_dict() -> dict[str, Any]:
    """All tables as plain data, for ``--json``."""
    return {
        "coefficients": thesis_fits.coefficients(),
        "held_out_errors_percent": thesis_fits.held_out_errors(),
        "process_errors_percent": thesis_process.process_errors(),
        "epsilon_cells_percent": thesis_errors.cells(),
        "mean_errors_percent": thesis_errors.means(),
        "error_budget_percent": thesis_errors.budgets(),
    }


def as_text(data: dict[str, Any]) -> str:
    """All tables for people, from `as_dict`: ours beside theirs."""
    return "\n\n".join(
        [
            thesis_fits.coefficient_text(data["coefficients"]),
            thesis_fits.error_text(data["held_out_errors_percent"]),
            thesis_process.process_text(data["process_errors_percent"]),
            thesis_errors.cell_text(data["epsilon_cells_percent"]),
            thesis_errors.mean_text(data["mean_errors_percent"]),
            thesis_errors.budget_text(data["error_budget_percent"]),
            paragraph(_MISSING),
        ]
    )
