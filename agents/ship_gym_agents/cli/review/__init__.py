"""``ship-gym review``: small verbs around recordings, one module each."""

from __future__ import annotations

import importlib
import os

import click

from ship_gym_agents.cli.groups import Verbs

# verb -> one line of help; list is a word of Python
VERBS = {
    "list": "List the runs of folders: filter, sort, find the worst.",
    "show": "Show recordings in rerun's viewer, in a window or in a browser.",
    "picture": "Draw a recording at its worst moment, at a time, or as a strip.",
    "compare": "Compare runs: metrics side by side, and one recording with all of them.",
    "export": "Write recordings as csv, parquet, png, mp4, gpx, geojson or kml.",
    "metrics": "Print the metrics of recordings side by side, computed from the files.",
}


def load_verb(verb: str) -> click.Command:
    """The click command of a verb."""
    name = "listing" if verb == "list" else verb
    return importlib.import_module(f"ship_gym_agents.cli.review.{name}").command


class _Review(Verbs):
    """The verbs; files or options without a verb are of ``metrics``, as in older versions."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse what follows ``review``."""
        first = args[0] if args else ""
        if not first and not ctx.resilient_parsing:
            raise click.UsageError(
                "review what? Name a verb, such as: review list FOLDER, review show FILE, "
                "review metrics FILE",
                ctx,
            )
        option = first.startswith("-") and first not in ("-h", "--help")
        file = first.endswith((".rrd", ".partial")) or os.path.isfile(first)
        if first not in self.verbs and (option or file):
            args = ["metrics", *args]
        return super().parse_args(ctx, args)


command = _Review(
    "review",
    verbs=VERBS,
    load=load_verb,
    help="Find, show, draw, compare, export and measure recordings.",
    examples=("list runs --worst 5", "picture runs/rollout.rrd --at worst"),
    epilog="Each verb has --help with examples, and --json.",
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
