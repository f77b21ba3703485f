"""Blocks of code in the pages of docs and beside them, and the marks that except them."""

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md")),
    *ROOT.glob("ship_gym/README.md"),  # not beside an installed package
    *sorted((ROOT / "docs").rglob("*.md")),
]
# a fence, with the mark that may stand on the line before it
FENCE = re.compile(
    r"(?:<!-- not run: (?P<why>[^>]+?) -->\n)?^```(?P<language>\w+)\n(?P<code>.*?)^```$",
    flags=re.MULTILINE | re.DOTALL,
)
SHELL = ("bash", "sh")
FILE = re.compile(r"# ([\w/]+\.(?:py|toml))(?::.*)?\n")


@dataclass(frozen=True)
class Block:
    """One block of a page: its language, code, line, and why it is not run (or None)."""

    page: str
    line: int
    language: str
    code: str
    why: str | None

    @property
    def file(self) -> str | None:
        """Name of the file that a block in Python or TOML is, by its first line."""
        found = FILE.match(self.code) if self.language in ("python", "toml") else None
        return found and found[1]

    def __str__(self) -> str:
        return f"{self.page}:{self.line}"


def blocks_of(page: Path) -> list[Block]:
    """All blocks of a page with a language."""
    text, name = page.read_text("utf-8"), page.relative_to(ROOT).as_posix()
    return [
        Block(name, text.count("\n", 0, m.start("code")), m["language"], m["code"], m["why"])
        for m in FENCE.finditer(text)
    ]


def commands(code: str) -> list[str]:
    """Lines of a block of shell, without comments and with continued lines joined.

    Of a session, whose commands have a ``$`` before them, those alone.
    """
    lines = code.replace("\\\n", " ").splitlines()
    if code.startswith("$ "):
        lines = [line[2:] for line in lines if line.startswith("$ ")]
    return [line.strip() for line in lines if line.strip() and not line.strip().startswith("#")]
