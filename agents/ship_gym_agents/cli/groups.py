"""Groups of verbs, each verb imported when it is asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import click


class Verbs(click.Group):
    """A group that knows its verbs by their lines of help.

    Parameters
    ----------
    verbs : mapping
        Verb to its one line of help, in the order of the help.
    load : callable
        ``load(verb)``, its click command.
    examples : sequence of str
        What follows the name of the group.
    """

    def __init__(
        self,
        *args,
        verbs: Mapping[str, str],
        load: Callable[[str], click.Command],
        examples: Sequence[str] = (),
        **kwargs,
    ):
        super().__init__(*args, **kwargs)
        self.verbs, self.load, self.examples = verbs, load, examples

    def list_commands(self, ctx: click.Context) -> list[str]:
        """All verbs, in the order of the help."""
        return list(self.verbs)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of a verb; None if there is no such verb."""
        return self.load(cmd_name) if cmd_name in self.verbs else None

    def resolve_command(self, ctx: click.Context, args: list[str]):
        """As click's, but an unknown verb names the nearest one."""
        if args[0] not in self.verbs and not args[0].startswith("-") and not ctx.resilient_parsing:
            from ship_gym.config import check_known

            check_known("verb", args[0], self.verbs)
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The table of verbs, without importing them."""
        with formatter.section("Verbs"):
            formatter.write_dl(list(self.verbs.items()))

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Examples as they can be typed, then click's."""
        if self.examples:
            formatter.write("\nexamples:\n")
            for example in self.examples:
                formatter.write(f"  {ctx.command_path} {example}\n")
        super().format_epilog(ctx, formatter)
