"""Recompute what the sources print of propeller and rudder models, ours beside theirs."""

from __future__ import annotations

from _cli import parser, progress, run, show

from reproduce import (
    families,
    measured_motion,
    open_water_example,
    rudder_formulas,
    thesis_tables,
    unsteady_tables,
)
from reproduce.unsteady import compare_seeds

# what is computed and how it is shown
PARTS = {
    # Knight (2021): regression, process, error budget; a quarter of a minute
    "thesis": (thesis_tables.as_dict, thesis_tables.as_text),
    # Knight (2021): mean forces in the measured turn, and the state that they fix
    "forces": (measured_motion.as_dict, measured_motion.as_text),
    # Knight (2021): the one-dimensional example
    "example": (open_water_example.as_dict, open_water_example.as_text),
    # Knight & Maki (2020): order of the regression, early stopping; half a minute
    "network": (lambda: unsteady_tables.as_dict(compare_seeds()), unsteady_tables.as_text),
    # Stern et al. (2021): Beaufoy's formula and the MMG rudder
    "rudder": (rudder_formulas.as_dict, rudder_formulas.as_text),
    # turning circles and zig-zags of KCS with each family of surrogate
    "families": (families.as_dict, families.as_text),
}
EXAMPLES = (
    "python scripts/reproduce.py                  # everything",
    "python scripts/reproduce.py thesis forces families",
    "python scripts/reproduce.py rudder --json > runs/rudder.json",
)


def main() -> None:
    p = parser(__doc__, EXAMPLES)
    p.add_argument("parts", nargs="*", metavar="PART", help=f"{', '.join(PARTS)} (default: all)")
    args = p.parse_args()
    unknown = [part for part in args.parts if part not in PARTS]
    if unknown:
        p.error(f"unknown part {unknown[0]!r}; known: {', '.join(PARTS)}")
    wanted = args.parts or list(PARTS)
    data = {part: PARTS[part][0]() for part in progress(wanted, "recomputing")}
    text = "\n\n\n".join(PARTS[part][1](data[part]) for part in wanted)
    show(args.json, data, text)


if __name__ == "__main__":
    run(main)
