"""Sections of ``reports.page`` as a Markdown page, its pictures as files in a folder beside it."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from ship_gym.reports.page import Block, Command, Folded, Grid, Heading, Picture, Row, Section, Text
from ship_gym.text import paragraph, table
from ship_gym.writing import atomic_path


def write_markdown_page(
    path: str | os.PathLike, title: str, mark: str, sections: Sequence[Section]
) -> list[Path]:
    """Write the page, and its pictures into the folder of its name without the suffix.

    Pictures that the folder holds from before and that this page does not show are removed.

    Parameters
    ----------
    path : path-like
    title : str
    mark : str
        A comment at the top, such as what writes the file.
    sections : sequence of Section
        Those without blocks are left out; one without a title continues what stands before.

    Returns
    -------
    list of pathlib.Path
        The page and the pictures.
    """
    path = Path(path)
    folder = path.with_suffix("")
    text = markdown(title, mark, sections, folder.name)
    files = []
    for picture in pictures(sections):
        files.append(folder / f"{picture.name}.png")
        with atomic_path(files[-1]) as temporary:
            temporary.write_bytes(picture.png)
    for old in folder.glob("*.png"):
        if old not in files:
            old.unlink()
    with atomic_path(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return [path, *files]


def pictures(sections: Sequence[Section]) -> list[Picture]:
    """All pictures of a page, in its order; each needs a name of its own."""
    found = [each for section in sections for block in section.blocks for each in _of(block)]
    names = [picture.name for picture in found]
    if not all(names) or len(set(names)) < len(names):
        raise ValueError(f"pictures {names}: each needs a name of its own")
    return found


def _of(block: Block) -> Iterator[Picture]:
    if isinstance(block, Picture):
        yield block
    elif isinstance(block, Row):
        yield from block.pictures
    elif isinstance(block, Folded):
        for each in block.blocks:
            yield from _of(each)


def markdown(title: str, mark: str, sections: Sequence[Section], folder: str) -> str:
    """The page as text; `folder` is where its pictures lie."""
    parts = [f"<!-- {mark} -->", f"# {title}"]
    for section in sections:
        if section.blocks:
            parts += [f"## {section.title}"] if section.title else []
            parts += [text for block in section.blocks if (text := _markdown(block, folder))]
    return "\n\n".join(parts) + "\n"


def _markdown(block: Block, folder: str) -> str:
    """One block; text is left as it is, so it must not hold what Markdown reads as a sign."""
    match block:
        case Text(text):
            return paragraph(text, "")
        case Heading(text):
            return f"### {text}"
        case Command(text):
            return f"```text\n{text}\n```"
        case Grid():
            return _grid(block)
        case Picture():
            return f"![{block.caption}]({folder}/{block.name}.png)"
        case Row():
            return "\n\n".join(_markdown(each, folder) for each in block.pictures)
        case Folded():
            inner = "\n\n".join(_markdown(each, folder) for each in block.blocks)
            return f"<details><summary>{block.title}</summary>\n\n{inner}\n\n</details>"
    raise TypeError(f"no Markdown of a {type(block).__name__}")


def _grid(grid: Grid) -> str:
    """A table under its caption; an empty one is left out."""
    if not grid.rows:
        return ""
    rows = [[str(cell) for cell in row] for row in grid.rows]
    caption = f"{paragraph(grid.caption, '')}:\n\n" if grid.caption else ""
    return caption + table(grid.header, rows, markdown=True)
