"""How Sphinx makes the site; `tools/build_site.py` puts its pages together and calls it."""

import re
from typing import Any

import cvnotes

project = "cvnotes"
author = "The cvnotes authors"
copyright = "The cvnotes authors. Code: BSD 3-Clause. Text, figures and data: CC BY 4.0"  # noqa: A001
release = version = cvnotes.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "numpydoc",
    "sphinx.ext.viewcode",  # the source is the answer key
    "sphinx-mathjax-offline",
]
exclude_patterns: list[str] = []

nb_execution_mode = "off"  # they are committed executed
nb_render_markdown_format = "myst"
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 3

# `dlt` in a docstring leads to dlt where there is just one; shapes stand in the text, so that
# signatures can stay short.
default_role = "py:obj"
autodoc_typehints = "none"
autodoc_member_order = "bysource"
add_module_names = False

html_theme = "sphinx_book_theme"
html_title = "cvnotes"
html_context = {"default_mode": "auto"}  # light or dark, as the reader's machine is
html_favicon = "figures/favicon.svg"
html_theme_options = {"navbar_persistent": [], "home_page_in_toc": True}

numpydoc_show_class_members = False
suppress_warnings = ["ref.python"]  # a word that names several things is then just a word
html_static_path = ["site.css", "site.js"]
html_css_files = ["site.css"]
html_js_files: list[Any] = ["site.js"]
if tags.has("live"):  # type: ignore[name-defined] # noqa: F821  (Sphinx's: the site has Python)
    html_static_path.append("static")
    html_css_files.append("live/live.css")
    defer = {"defer": "defer"}  # in this order, once the page is there
    html_js_files += [(f"live/{name}.js", defer) for name in ("page", "explore", "exercises")]


def escape_initials(*event: Any) -> None:
    """Keep a reference that begins with an author's initial ("Z. Zhang") from being a list."""
    lines = event[-1]
    lines[:] = [re.sub(r"^(\s*\.\. \[\d+\] [A-Z])\. ", r"\1\\. ", line) for line in lines]


def setup(app: Any) -> None:
    """Have Sphinx call us before numpydoc."""
    app.connect("autodoc-process-docstring", escape_initials, priority=100)
