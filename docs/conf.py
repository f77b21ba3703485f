"""Sphinx: the pages of docs, CONTRIBUTING and the map of the package as one site.

``bash scripts/build_site.sh`` runs it. The source folder is the root of the repository, so that
the links between pages are the same here and on GitHub.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "agents"), str(ROOT / "docs")]

import ship_gym  # noqa: E402
from website.sources import linkcode_resolve  # noqa: E402, F401 (read by sphinx.ext.linkcode)

project = "Ship Gym"
author = "Ship Gym contributors"
copyright = author
version = release = ship_gym.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.linkcode",
    "sphinx_copybutton",
    "website.command_line",
    "website.mathml",
    "website.members",
    "website.pictures",
    "website.sources",
    "website.tables",
]

root_doc = "docs/index"
include_patterns = [
    "docs/**.md",
    "ship_gym/README.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "CHANGELOG.md",
]
exclude_patterns = [".venv", "runs", "build", "dist", ".git", "tests", "agents", "**/__pycache__"]
source_suffix = {".md": "markdown"}

# Markdown as GitHub reads it: anchors of headings, ```math
myst_enable_extensions = ["dollarmath"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 4
# generated pages and pages of records begin below their first heading
suppress_warnings = ["myst.header"]

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"members": True, "show-inheritance": True}
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_param = True
napoleon_use_ivar = True  # attributes in a list, as they stand in the docstring
default_role = "literal"  # `name` in our docstrings is code

pygments_style = "default"
pygments_dark_style = "github-dark"
copybutton_exclude = ".linenos, .gp"
html_theme = "furo"
html_title = f"Ship Gym {version}"
html_static_path = ["website/static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_show_sourcelink = False
html_show_sphinx = False
html_theme_options = {"navigation_with_keys": True}
