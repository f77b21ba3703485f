"""The verbs of ``ship-gym`` as sections of a page, made from the commands themselves.

The directive ``verbs`` names verbs; each becomes a section with what its ``--help`` says, so that
nothing is written twice. Options are targets of Sphinx's own kind: the search finds
``--wave-height``. The directive ``verb-table`` lists them all.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator

import click
from docutils import nodes
from ship_gym_agents.cli import PROGRAM, VERBS, load_verb, ship_gym
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

OPTION = re.compile(r"(?<!\S)(--[a-z][\w-]*)(?![\w/-])")


def contexts(verb: str) -> list[click.Context]:
    """A verb, then what stands below it, as ``review list`` below ``review``."""
    root = click.Context(ship_gym, info_name=PROGRAM)
    above = as_called(load_verb(verb), root, verb)
    group = above.command
    names = group.list_commands(above) if isinstance(group, click.Group) else []
    return [above, *(as_called(group.get_command(above, name), above, name) for name in names)]


def as_called(command: click.Command, parent: click.Context, name: str) -> click.Context:
    """As click makes it when a command is called: with what it says of defaults."""
    return click.Context(command, parent=parent, info_name=name, **command.context_settings)


def usage(context: click.Context) -> str:
    """The line of usage, not broken."""
    return " ".join([context.command_path, *context.command.collect_usage_pieces(context)])


def examples(context: click.Context) -> str:
    """The examples as they are typed, a line each."""
    given = getattr(context.command, "examples", ())
    return "\n".join(f"{context.command_path} {example}".rstrip() for example in given)


def options(context: click.Context) -> Iterator[tuple[click.Parameter, str, str]]:
    """Options: each with its names and value, and its help with the default."""
    for param in context.command.get_params(context):
        record = param.get_help_record(context)
        if record and record[1] and "--help" not in param.opts:  # every verb has that one
            yield param, *record


def block(text: str, language: str) -> nodes.literal_block:
    """Lines as they are typed or printed."""
    return nodes.literal_block(text, text, language=language)


def prose(text: str | None) -> list[nodes.Node]:
    """Paragraphs of a help; one with indented lines, as a table has them, keeps its columns."""
    made: list[nodes.Node] = []
    for part in inspect.cleandoc(text or "").split("\n\n"):
        if "\n  " in part:
            made.append(block(part, "text"))
        elif part:
            made.append(paragraph(part))
    return made


def paragraph(text: str) -> nodes.paragraph:
    """Text of a help, letter by letter, its options set as code."""
    words = OPTION.split(" ".join(text.split()))
    parts = (nodes.literal("", w) if OPTION.fullmatch(w) else nodes.Text(w) for w in words)
    return nodes.paragraph("", "", *parts, support_smartquotes=False)


class Verbs(SphinxDirective):
    """A section for each verb of the argument."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        """Sections, with those of what stands below a verb inside."""
        asked = self.arguments[0].split()
        if unknown := [verb for verb in asked if verb not in VERBS]:
            raise self.error(f"{PROGRAM} has no verb {', '.join(unknown)}")
        made: list[nodes.Node] = []
        for verb in asked:
            above, *below = (self.section(context) for context in contexts(verb))
            above += below
            made.append(above)
        return made

    def section(self, context: click.Context) -> nodes.section:
        """Usage, text, examples, options, notes."""
        path, command = context.command_path, context.command
        title = path.removeprefix(f"{PROGRAM} ")  # short, so that the search finds it
        made = nodes.section("", nodes.title("", title), names=[nodes.make_id(path)])
        self.state.document.note_explicit_target(made)
        made += [block(usage(context), "text"), *prose(command.help)]
        if lines := examples(context):
            made += block(lines, "bash")
        described = [self.option(path, *option) for option in options(context)]
        if described:
            made += nodes.definition_list("", *described, classes=["options"])
        made += prose(getattr(command, "notes", "")) + prose(command.epilog)
        return made

    def option(self, path: str, param: click.Parameter, names: str, text: str) -> nodes.Node:
        """One option, which the search and the index of the site find."""
        target = nodes.make_id(f"{path} {param.name}")
        named = [*param.opts, *param.secondary_opts]
        for name in named:
            domain = self.env.domains.standard_domain
            domain.add_program_option(path, name, self.env.docname, target)
        entries = [("single", f"{name}; {path}", target, "", None) for name in named]
        term = nodes.term("", "", nodes.literal("", names), ids=[target])
        term += addnodes.index(entries=entries)
        return nodes.definition_list_item("", term, nodes.definition("", paragraph(text)))


class VerbTable(SphinxDirective):
    """All verbs, each with its line of help, in the order of ``ship-gym --help``."""

    def run(self) -> list[nodes.Node]:
        """One table whose first column leads to the sections."""
        body = nodes.tbody()
        for verb, line in VERBS.items():
            body += nodes.row("", self.cell(self.link(verb)), self.cell(nodes.Text(line)))
        columns = [nodes.colspec(colwidth=width) for width in (1, 4)]
        return [nodes.table("", nodes.tgroup("", *columns, body, cols=2))]

    def link(self, verb: str) -> nodes.Node:
        """To the section of a verb."""
        target = {"reftarget": nodes.make_id(f"{PROGRAM} {verb}"), "refwarn": True}
        return addnodes.pending_xref(
            "",
            nodes.literal("", verb),
            refdomain="std",
            reftype="ref",
            refexplicit=True,
            refdoc=self.env.docname,
            **target,
        )

    @staticmethod
    def cell(content: nodes.Node) -> nodes.entry:
        """A cell of the table."""
        return nodes.entry("", nodes.paragraph("", "", content))


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directives."""
    app.add_directive("verbs", Verbs)
    app.add_directive("verb-table", VerbTable)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
