"""Compare ratios of speed with the baseline of this repository; see --help."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from _cli import parser, progress, run, show

BASELINE = Path(__file__).with_name("speed_baseline.json")


def main() -> None:
    from ship_gym.reports import speed, speed_check
    from ship_gym.writing import atomic_path, check_place

    made = parser(
        "Measure ratios of processor times in one run (some 20 s) and compare them with "
        "scripts/speed_baseline.json. Exit code 1: something is slower beyond the margin. A check "
        "for review on a fairly quiet machine, not one of the tests.",
        ("python scripts/check_speed.py", "python scripts/check_speed.py --write"),
    )
    made.add_argument("--baseline", type=Path, default=BASELINE, help="file of ratios")
    made.add_argument("--write", action="store_true", help="write the baseline instead")
    made.add_argument(
        "--margin", type=float, default=speed_check.MARGIN, help="factor (default: %(default)s)"
    )
    given = made.parse_args()
    if given.write:
        check_place(given.baseline, "--baseline")
    else:
        baseline = speed_check.load_baseline(given.baseline)
        speed_check.compare(baseline, baseline, given.margin)  # refuses a margin before the work
    seconds = speed_check.run(progress=progress)
    now = speed_check.ratios(seconds)
    data = {"machine": speed.machine(), "seconds": seconds, "ratios": now}
    if given.write:
        with atomic_path(given.baseline) as temporary:
            temporary.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
        rows = speed_check.compare(now, now)
        text = f"{speed_check.as_text(rows)}\nwrote {given.baseline}"
        show(given.json, {**data, "files": [str(given.baseline)]}, text)
        return
    rows = speed_check.compare(now, baseline, given.margin)
    show(given.json, {**data, "compared": rows}, speed_check.as_text(rows, given.margin))
    if any(row["verdict"] == "slower" for row in rows):
        sys.exit(1)


if __name__ == "__main__":
    run(main)
