"""Measure how fast physics and environments step, beside Gymnasium's CartPole."""

from __future__ import annotations

from _cli import parser, progress, run, show

from ship_gym.reports import speed

EXAMPLES = (
    "python scripts/benchmark_speed.py            # about a minute, compiles once from nothing",
    "python scripts/benchmark_speed.py --quick    # seconds; less steady, no compilation",
    "python scripts/benchmark_speed.py --json > runs/speed.json",
)


def main() -> None:
    p = parser(__doc__, EXAMPLES)
    p.add_argument("--quick", action="store_true", help="short repeats, no compilation time")
    args = p.parse_args()
    repeats, seconds = (2, 0.03) if args.quick else (7, 0.4)
    jobs = list(speed.jobs())
    steps = [speed.measure(job, repeats, seconds) for job in progress(jobs, "measuring")]
    n, repeats = (64, 3) if args.quick else (4096, 30)
    overhead = [speed.overhead(name, n, repeats) for name in speed.COMPARED]
    start = speed.start_times(cold=not args.quick)
    data = {"machine": speed.machine(), "steps": steps, "overhead": overhead, "start": start}
    show(args.json, data, speed.as_text(data))


if __name__ == "__main__":
    run(main)
