"""Pictures as links to themselves: on a page they may be too small to read."""

from __future__ import annotations

import posixpath

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.osutil import relative_uri


def link(app: Sphinx, doctree: nodes.document, docname: str) -> None:
    """Lead from each picture of a page that leads nowhere to its file."""
    if app.builder.format != "html":
        return
    folder = relative_uri(app.builder.get_target_uri(docname), app.builder.imagedir)
    for picture in list(doctree.findall(nodes.image)):
        if picture["uri"] in app.env.images and not isinstance(picture.parent, nodes.reference):
            file = posixpath.join(folder, app.env.images[picture["uri"]][1])
            around = nodes.reference("", "", internal=True, refuri=file)
            picture.replace_self(around)
            around += picture


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the step."""
    app.connect("doctree-resolved", link)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
