"""Recompute what the sources print of propeller and rudder models, ours beside theirs."""

from __future__ import annotations

from pathlib import Path

from _cli import parser, progress, run, show

from reproduce import (
    families,
    measured_motion,
    open_water_example,
    rudder_formulas,
    rudder_primes,
    stern_tables,
    thesis_tables,
    unsteady_tables,
)
from reproduce.unsteady import compare_seeds
from reproduce.white import as_dict as white_findings
from reproduce.white import as_text as white_text
from ship_gym.writing import check_place

# what is computed and how it is shown
PARTS = {
    # Knight (2021): regression, process, error budget; a quarter of a minute
    "thesis": (thesis_tables.as_dict, thesis_tables.as_text),
    # Knight (2021): mean forces in the measured turn, and the state that they fix
    "forces": (measured_motion.as_dict, measured_motion.as_text),
    # Knight (2021): the one-dimensional example
    "example": (open_water_example.as_dict, open_water_example.as_text),
    # Knight & Maki (2020): order of the regression, early stopping, test cases; three minutes
    "network": (lambda: unsteady_tables.as_dict(compare_seeds()), unsteady_tables.as_text),
    # Stern et al. (2021): Beaufoy's formula and the MMG rudder
    "rudder": (
        lambda: rudder_formulas.as_dict() | {"primes": rudder_primes.primes()},
        lambda data: rudder_formulas.as_text(data) + "\n\n" + rudder_primes.as_text(data["primes"]),
    ),
    # Stern et al. (2021): turns to port and to starboard, force balance, findings
    "stern": (stern_tables.as_dict, stern_tables.as_text),
    # turning circles and zig-zags of KCS with each family of surrogate
    "families": (families.as_dict, families.as_text),
    # White (2020): turning circles in waves of DTC and KCS
    "white": (white_findings, white_text),
}
EXAMPLES = (
    "python scripts/reproduce.py                  # everything",
    "python scripts/reproduce.py thesis forces families",
    "python scripts/reproduce.py rudder --json > runs/rudder.json",
    "python scripts/reproduce.py stern --plot runs/stern.png --record",
)


def main() -> None:
    p = parser(__doc__, EXAMPLES)
    p.add_argument("parts", nargs="*", metavar="PART", help=f"{', '.join(PARTS)} (default: all)")
    p.add_argument(
        "--plot",
        type=Path,
        metavar="FILE.png",
        help="draw force balance and drift of the part stern",
    )
    p.add_argument(
        "--record", action="store_true", help="write the part stern's table of findings again"
    )
    args = p.parse_args()
    unknown = [part for part in args.parts if part not in PARTS]
    if unknown:
        p.error(f"unknown part {unknown[0]!r}; known: {', '.join(PARTS)}")
    wanted = args.parts or list(PARTS)
    if (args.plot or args.record) and "stern" not in wanted:
        p.error("--plot and --record belong to the part stern")
    if args.plot and args.plot.suffix != ".png":
        p.error(f"--plot {args.plot}: allowed is a .png file")
    _check_places(args.plot, args.record)
    data = {part: PARTS[part][0]() for part in progress(wanted, "recomputing")}
    text = "\n\n\n".join(PARTS[part][1](data[part]) for part in wanted)
    written = _write(data["stern"], args.plot, args.record) if "stern" in wanted else []
    show(args.json, data, text + "".join(f"\nwrote {path}" for path in written))


def _check_places(plot: Path | None, record: bool) -> None:
    """Refuse, before the work, what could not be written."""
    from reproduce.stern_findings import RECORD

    if plot:
        check_place(plot, "--plot")
    if record:
        check_place(RECORD, "--record")


def _write(stern: dict, plot: Path | None, record: bool) -> list[str]:
    """Picture and table of the part stern, where they are asked for; where each was written."""
    written = []
    if record:
        written.append(stern_tables.write_record(stern))
    if plot:
        from reproduce.stern_picture import plot_sides

        plot_sides(stern, plot)
        written.append(str(plot))
    return written


if __name__ == "__main__":
    run(main)
