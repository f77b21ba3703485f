"""The class of a verb, and options that mean the same in every verb."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any

import click

from ship_gym_agents.cli.values import Name, OutFile, whole

TYPED = "ship_gym.typed"  # of a context's meta: the words behind the verb
SEEDS = 2**32 - 1  # the largest seed that every random generator here takes


class Several(click.Option):
    """An option that takes all values that follow it, and may be given again."""

    def __init__(self, *args: Any, **kwargs: Any):
        super().__init__(*args, **{**kwargs, "multiple": True})


class MayStandAlone(click.Option):
    """An option whose value may be left out; it is then the empty text."""

    alone = True  # for the types of values


class Verb(click.Command):
    """A command whose help ends with examples.

    Parameters
    ----------
    examples : sequence of str
        What follows the name of the verb, with a comment if it needs one.
    notes : str
        More text at the end of the help.
    """

    def __init__(self, *args, examples: Sequence[str] = (), notes: str = "", **kwargs):
        super().__init__(*args, **kwargs)
        self.examples, self.notes = examples, notes

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse with ``--option a b`` as ``--option a --option b`` where an option allows it."""
        if zero := [word for word in args if "\0" in word]:  # no shell gives it, a program may
            raise click.UsageError(f"{zero[0][:60]!r}: no word has a zero byte", ctx)
        ctx.meta[TYPED] = [*args]
        return super().parse_args(ctx, self._expanded(args))

    def _expanded(self, args: list[str]) -> list[str]:
        kinds = {opt: p for p in self.params for opt in p.opts}
        made, args = [], list(args)
        while args:
            word = args.pop(0)
            kind = kinds.get(word)
            if isinstance(kind, Several):
                values = []
                while args and not args[0].startswith("-"):
                    values.append(args.pop(0))
                for value in values or [""]:
                    made += [word, value]
            elif isinstance(kind, MayStandAlone) and (not args or args[0].startswith("-")):
                made += [word, ""]
            else:
                made.append(word)
                takes_value = isinstance(kind, click.Option) and not kind.is_flag
                made += [args.pop(0)] if takes_value and args else []
        return made

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Examples as they can be typed, then the notes."""
        formatter.write("\nexamples:\n")
        for example in self.examples:
            formatter.write(f"  {ctx.command_path} {example}".rstrip() + "\n")
        if self.notes:
            formatter.write(f"\n{self.notes.strip()}\n")


def verb(*examples: str, notes: str = "") -> Callable[[Callable], click.Command]:
    """Make a function a verb with ``--json`` (argument `as_json`) and examples in its help."""

    def decorate(function: Callable) -> click.Command:
        function = click.option(
            "--json", "as_json", is_flag=True, help="Print the result as JSON on stdout."
        )(function)
        return click.command(
            cls=Verb,
            examples=examples,
            notes=notes,
            context_settings={
                "help_option_names": ["-h", "--help"],
                "max_content_width": 100,
                "show_default": True,
            },
        )(function)

    return decorate


def ship(text: str = "the scenario's", default: str | None = None):
    """Option ``--ship``."""
    text = "Name or ship file." if default else f"Name or ship file; default: {text}."
    return click.option("--ship", type=Name("ships"), default=default, help=text)


def seed(text: str, default: int | None = 0, largest: int = SEEDS):
    """Option ``--seed``."""
    return click.option("--seed", type=whole(0, largest), default=default, help=text)


def out(suffix: str, text: str, name: str = "--out", default: str | None = None, more=()):
    """An option for a file to write; `more` extensions are allowed, too."""
    return click.option(name, type=OutFile(suffix, *more), default=default, help=text)


def report():
    """Option ``--report [FILE.html]``; ``output.report_page`` says which file it means."""
    return click.option(
        "--report",
        cls=MayStandAlone,
        type=OutFile(".html"),
        help="Write a page with all pictures and tables; alone: beside the table file.",
    )


def force():
    """Option ``--force``; ``replace.check_replaced`` says when it is needed."""
    return click.option(
        "--force",
        is_flag=True,
        help="Replace what is at the place that was named, whatever it is; without it only an "
        "earlier result of the same. Pictures are always replaced.",
    )


def jobs():
    """Option ``--jobs``."""
    return click.option(
        "--jobs", type=whole(1, 1024), default=os.cpu_count() or 1, help="Processes."
    )


def environment(whose: str = "heading_keeping, kcs, rudder", several_ships: bool = False):
    """Options of what is sailed: ``--scenario``, ``--task``, ``--ship``, ``--control``, ``--set``.

    Parameters
    ----------
    whose : str
        What the defaults are.
    several_ships : bool
        ``--ship`` takes several; the argument is then `ships`.
    """
    names = click.option("--ship", type=Name("ships"), help="Name or ship file.")
    if several_ships:
        names = click.option(
            "--ship",
            "--ships",
            "ships",
            cls=Several,
            type=Name("ships"),
            help="Names or ship files, several; all: every ship of the package.",
        )
    made = (
        click.option(
            "--scenario",
            type=Name("scenarios"),
            help=f"Name or TOML file; scenario, ship and control default to {whose}.",
        ),
        click.option(
            "--task",
            type=Name("tasks"),
            help="A task, by its name or as your own FILE.py[:NAME]; brings its scenario.",
        ),
        names,
        click.option("--control", type=Name("controls"), help="rudder or rudder+rpm."),
        click.option(
            "--set",
            "overrides",
            cls=Several,
            metavar="KEY=VALUE",
            callback=_overrides,
            help="Key of the scenario and its TOML value, as in sensors.noise=false; several.",
        ),
    )

    def decorate(function: Callable) -> Callable:
        for option in reversed(made):
            function = option(function)
        return function

    return decorate


def _overrides(ctx: click.Context, param: click.Parameter, given: Sequence[str]) -> dict[str, Any]:
    """Pairs KEY=VALUE as a mapping of dotted keys."""
    found: dict[str, Any] = {}
    for pair in given:
        key, equals, value = pair.partition("=")
        if not (key.strip() and equals):
            raise click.UsageError(f"--set {pair}: must be KEY=VALUE", ctx)
        if key.strip() in found:
            raise click.UsageError(f"--set {pair}: {key.strip()} is given twice", ctx)
        found[key.strip()] = toml_value(value.strip())
    return found


def toml_value(text: str) -> Any:
    """The value of a TOML text; what is none is the text itself, so that names need no quotes."""
    from ship_gym.config import ConfigError  # late: it imports Gymnasium
    from ship_gym.reading import parsed_toml

    try:
        found = parsed_toml(f"value = {text}", "--set")
    except ConfigError:
        return text
    return found["value"] if len(found) == 1 else text
