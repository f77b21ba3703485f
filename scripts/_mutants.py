"""Small faults in Python source: where they can be made, and the source with one of them.

A fault replaces a few characters, so all line numbers stay. Left alone are documentation,
annotations, decorators, error messages and whatever only formats text.
"""

from __future__ import annotations

import ast
import random
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

KINDS = ("sign", "constant", "off by one", "swapped arguments", "removed limit")
# area -> folder and share of the draws; files that only say how a viewer looks are left out
AREAS = {
    "physics": ("ship_gym/physics", 5),
    "sea": ("ship_gym/sea", 3),
    "tasks": ("ship_gym/tasks", 3),
    "envs": ("ship_gym/envs", 3),
    "evaluation": ("ship_gym/evaluation", 3),
    "recording": ("ship_gym/recording", 1),
    "agents": ("agents/ship_gym_agents", 2),
}
_LEFT_OUT = ("__init__.py", "_kernel.py", "panels.py", "live.py", "view.py", "registration.py")
_LEFT_OUT += ("docstring.py",)  # text of pages
_NOT_IN = ("cli",)  # command lines: their tests start processes
_LIMITS = ("min", "max", "clip", "clipped", "minimum", "maximum")
_ANY_ORDER = (*_LIMITS, "hypot", "isinstance", "getattr", "hasattr", "print")
# keywords of drawings, and what only checks
_NO_MATTER = ("radii", "colors", "color", "width", "height", "labels", "visible", "strict")
_COUNTS = ("range", "prange", "arange")
_FLIPPED = {ast.Add: ("+", "-"), ast.Sub: ("-", "+")}
_NEIGHBOUR = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
}


class Mutant(NamedTuple):
    """One fault.

    Attributes
    ----------
    path : str
        Module, from the root of the checkout.
    area, kind, function : str
        ``<module>`` stands for code outside functions.
    line : int
    lines : tuple of int
        Lines of the statement it is in.
    before, after : str
        First line of it.
    start, end : int
        Bytes of the source that `text` replaces.
    text : bytes
    """

    path: str
    area: str
    kind: str
    function: str
    line: int
    lines: tuple[int, int]
    before: str
    after: str
    start: int
    end: int
    text: bytes

    @property
    def key(self) -> str:
        """Name that does not change when lines move."""
        return f"{self.path} {self.function}: {self.before} -> {self.after}"

    def applied(self, source: bytes) -> bytes:
        """The source with this fault."""
        return source[: self.start] + self.text + source[self.end :]


class _Finder(ast.NodeVisitor):
    """Collects (kind, function, statement, start, end, text) of one module."""

    def __init__(self, source: bytes):
        self.source, self.found, self._names = source, [], []
        self._statement: ast.stmt | None = None
        self._offsets = [0]
        for line in source.splitlines(keepends=True):
            self._offsets.append(self._offsets[-1] + len(line))

    def span(self, node) -> tuple[int, int]:
        first, last = self._offsets[node.lineno - 1], self._offsets[node.end_lineno - 1]
        return first + node.col_offset, last + node.end_col_offset

    def add(self, kind: str, start: int, end: int, text: bytes) -> None:
        where = ".".join(self._names) or "<module>"
        self.found.append((kind, where, self._statement, start, end, text))

    def visit(self, node):
        if isinstance(node, ast.stmt) and not isinstance(node, ast.FunctionDef | ast.ClassDef):
            self._statement = node
        return super().visit(node)

    def visit_FunctionDef(self, node):
        self._names.append(node.name)
        self._statement = node
        for default in (*node.args.defaults, *filter(None, node.args.kw_defaults)):
            self.visit(default)
        for child in node.body:
            self.visit(child)
        self._names.pop()

    def visit_ClassDef(self, node):
        self._names.append(node.name)
        for child in node.body:
            self.visit(child)
        self._names.pop()

    def _leave(self, node):
        """Nothing in here."""

    visit_Raise = visit_Assert = visit_JoinedStr = visit_Import = visit_ImportFrom = _leave

    def visit_keyword(self, node):
        if node.arg not in _NO_MATTER:
            self.visit(node.value)

    def visit_AnnAssign(self, node):
        if node.value is not None:
            self.visit(node.value)

    def visit_BinOp(self, node):
        if type(node.op) in _FLIPPED and not _is_text(node.left) and not _is_text(node.right):
            self._operator("sign", node.left, node.right, *_FLIPPED[type(node.op)])
        self.generic_visit(node)

    def visit_AugAssign(self, node):
        if type(node.op) in _FLIPPED:
            self._operator("sign", node.target, node.value, *_FLIPPED[type(node.op)])
        self.visit(node.value)

    def visit_UnaryOp(self, node):
        if isinstance(node.op, ast.USub):
            start, _ = self.span(node)
            self.add("sign", start, start + 1, b" ")
        self.generic_visit(node)

    def visit_Compare(self, node):
        operands = [node.left, *node.comparators]
        for left, op, right in zip(operands[:-1], node.ops, operands[1:], strict=True):
            if type(op) in _NEIGHBOUR:
                self._operator("off by one", left, right, *_NEIGHBOUR[type(op)])
        self.generic_visit(node)

    def _operator(self, kind, left, right, old, new):
        """Replace the operator that stands between two operands."""
        start, end = self.span(left)[1], self.span(right)[0]
        at = self.source.find(old.encode(), start, end)
        if at >= 0 and b"#" not in self.source[start:end]:
            self.add(kind, at, at + len(old), new.encode())

    def visit_Subscript(self, node):
        self.visit(node.value)
        for part in ast.walk(node.slice):
            if isinstance(part, ast.Constant) and type(part.value) is int:
                start, end = self.span(part)
                self.add("off by one", start, end, str(part.value + 1).encode())

    def visit_Call(self, node):
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        spans = [self.span(arg) for arg in node.args]
        texts = [self.source[a:b] for a, b in spans]
        if name in _LIMITS and len(texts) > 1:
            self._without_limit(node, texts)
        if name in _COUNTS and texts:
            end = spans[min(1, len(spans) - 1)][1]
            self.add("off by one", end, end, b" - 1")
        if name not in _ANY_ORDER and not any(isinstance(a, ast.Starred) for a in node.args):
            for k in range(len(spans) - 1):
                (a, b), (c, d) = spans[k : k + 2]
                if texts[k] != texts[k + 1]:
                    between = self.source[b:c]
                    self.add("swapped arguments", a, d, texts[k + 1] + between + texts[k])
        self.generic_visit(node)

    def _without_limit(self, node, texts):
        """The call becomes its first argument that is no number."""
        keep = [t for t, arg in zip(texts, node.args, strict=True) if not _is_number(arg)]
        start, end = self.span(node)
        kept = keep[0] if keep else texts[0]
        lost = self.source[start:end].count(b"\n") - kept.count(b"\n")
        self.add("removed limit", start, end, b"(" + kept + b"\n" * lost + b")")

    def visit_Constant(self, node):
        value, (start, end) = node.value, self.span(node)
        if isinstance(value, bool):
            self.add("constant", start, end, str(not value).encode())
        elif isinstance(value, float):
            self.add("constant", start, end, repr(1.1 * value if value else 1.0).encode())
        elif isinstance(value, int):
            self.add("constant", start, end, str(value + 1).encode())


def _is_text(node) -> bool:
    return isinstance(node, ast.JoinedStr) or (
        isinstance(node, ast.Constant) and isinstance(node.value, str)
    )


def _is_number(node) -> bool:
    if isinstance(node, ast.UnaryOp):
        node = node.operand
    return isinstance(node, ast.Constant)


def mutants_of(root: Path, path: str, area: str) -> Iterator[Mutant]:
    """Every fault that can be made in one module."""
    source = (root / path).read_bytes()
    finder = _Finder(source)
    finder.visit(ast.parse(source))
    seen: dict[str, int] = {}
    for kind, function, statement, start, end, text in finder.found:
        line = source.count(b"\n", 0, start) + 1
        changed = source[:start] + text + source[end:]
        before, after = (s.splitlines()[line - 1].decode().strip() for s in (source, changed))
        last = statement.body[0].lineno if isinstance(statement, ast.FunctionDef) else (
            statement.body[0].lineno - 1 if hasattr(statement, "body") else statement.end_lineno
        )  # fmt: skip
        lines = (statement.lineno, max(last, line))
        made = Mutant(path, area, kind, function, line, lines, before, after, start, end, text)
        seen[made.key] = seen.get(made.key, 0) + 1
        if seen[made.key] > 1:  # the same line twice in one function
            made = made._replace(function=f"{function}#{seen[made.key]}")
        yield made


def modules(root: Path) -> Iterator[tuple[str, str]]:
    """(path, area) of the modules in which faults are made."""
    for area, (folder, _) in AREAS.items():
        for file in sorted((root / folder).rglob("*.py")):
            if file.name not in _LEFT_OUT and file.parent.name not in _NOT_IN:
                yield file.relative_to(root).as_posix(), area


def draw(root: Path, count: int, seed: int, only: str | None = None) -> list[Mutant]:
    """`count` faults, the kinds in turn, the areas by their shares; the same for the same seed."""
    pools: dict[tuple[str, str], list[Mutant]] = {}
    for path, area in modules(root):
        if only is None or Path(path).match(only):
            for made in mutants_of(root, path, area):
                pools.setdefault((made.area, made.kind), []).append(made)
    rng, drawn = random.Random(seed), []
    for pool in pools.values():
        rng.shuffle(pool)
    while len(drawn) < count and any(pools.values()):
        kind = KINDS[len(drawn) % len(KINDS)]
        areas = [area for area in AREAS if pools.get((area, kind))]
        if not areas:
            kind = next(k for (_, k), pool in pools.items() if pool)
            areas = [area for area in AREAS if pools.get((area, kind))]
        area = rng.choices(areas, [AREAS[a][1] for a in areas])[0]
        drawn.append(pools[area, kind].pop())
    return drawn
