"""The report of a benchmark: judged results as one HTML page, or as a page of the documentation."""

from ship_gym.evaluation.report.benchmark import Benchmark, judge
from ship_gym.evaluation.report.episodes import Episode, Sail
from ship_gym.evaluation.report.write import write_markdown, write_report

__all__ = ["Benchmark", "Episode", "Sail", "judge", "write_markdown", "write_report"]
