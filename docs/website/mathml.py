"""Equations as MathML, which browsers draw by themselves: no script, no network.

docutils translates the LaTeX. Sphinx's own renderers want a script of a content network or LaTeX.
"""

from __future__ import annotations

from typing import Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.errors import SphinxError


def translated(latex: str, node: nodes.Element, display: bool) -> str:
    """LaTeX as MathML; a formula that docutils cannot read stops the build."""
    try:
        return tex2mathml(latex, as_block=display)
    except ValueError as error:  # its MathError
        raise SphinxError(f"{node.source}:{node.line}: {latex!r}: {error}") from None


def inline(translator: Any, node: nodes.math) -> None:
    """Write a formula within a line."""
    translator.body.append(translated(node.astext(), node, False))
    raise nodes.SkipNode


def block(translator: Any, node: nodes.math_block) -> None:
    """Write a displayed formula, which a narrow page can scroll sideways."""
    formula = translated(node.astext(), node, True)
    translator.body.append(f'<div class="equation">{formula}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
