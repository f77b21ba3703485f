"""Tables of a page that is otherwise written by hand."""

from __future__ import annotations

from pathlib import Path

from ship_gym.writing import atomic_path


def write_tables(page: Path, tables: dict[str, str]) -> None:
    """Put each table between its marks in a page; a mark that is missing is an error."""
    text = with_tables(page.read_text(encoding="utf-8"), tables, page)
    with atomic_path(page) as temporary:
        temporary.write_text(text, encoding="utf-8")


def with_tables(text: str, tables: dict[str, str], page: Path) -> str:
    """The text of a page with each table between its marks."""
    for name, made in tables.items():
        start, end = f"<!-- {name} -->\n\n", f"\n\n<!-- /{name} -->"
        before, found, rest = text.partition(start)
        if not found or end not in rest:
            raise ValueError(f"{page}: no marks <!-- {name} --> and <!-- /{name} -->")
        text = before + start + made + rest[rest.index(end) :]
    return text
