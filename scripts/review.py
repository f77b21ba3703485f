"""Print the metrics of recordings side by side, computed from the files."""

from __future__ import annotations

from pathlib import Path

from _cli import parser, progress, run, show

from ship_gym.config import ConfigError
from ship_gym.evaluation import all_metrics, metrics
from ship_gym.recording import Trajectory
from ship_gym.text import table

EXAMPLES = (
    "python scripts/review.py runs/rollout.rrd",
    "python scripts/review.py runs/pid.rrd runs/quickstart/rollout.rrd --csv > runs/metrics.csv",
)


def arguments():
    p = parser(__doc__, EXAMPLES)
    p.add_argument("files", nargs="+", type=Path, metavar="FILE", help=".rrd files of record.py")
    p.add_argument("--csv", action="store_true", help="print comma-separated, with all digits")
    return p.parse_args()


def read(path: Path) -> tuple[dict, dict[str, float]]:
    """Meta and metrics of one recording; errors name the file."""
    try:
        trajectory = Trajectory.from_rrd(path)
        return trajectory.meta, metrics(trajectory)
    except ValueError as error:
        text = str(error)
        raise ConfigError(text if str(path) in text else f"{path}: {text}") from None


def main() -> None:
    args = arguments()
    found = {str(path): read(path) for path in progress(args.files, "reading")}
    kept = ("task", "controller", "seed", "outcome")
    rows = [["metric", "unit", *found]]
    rows += [[k, "", *(str(meta[k]) for meta, _ in found.values())] for k in kept]
    rows.append(["ship", "", *(meta["ship"]["name"] for meta, _ in found.values())])
    form = repr if args.csv else "{:.5g}".format
    for name, metric in all_metrics().items():
        cells = [form(v[name]) if name in v else "" for _, v in found.values()]
        if any(cells):
            rows.append([name, metric.unit, *cells])
    data = {path: {k: meta[k] for k in kept} | {"metrics": m} for path, (meta, m) in found.items()}
    text = "\n".join(map(",".join, rows)) if args.csv else table(rows[0], rows[1:], None)
    show(args.json, data, text)


if __name__ == "__main__":
    run(main)
