"""How Sphinx makes the site; `tools/build_site.py` puts its pages together and calls it."""

import re
import sys
from html import escape
from pathlib import Path
from textwrap import shorten
from typing import Any

from docutils import nodes

import cvnotes

sys.path.insert(0, str(Path(__file__).parents[1] / "tools"))
from front_page import ROOT, sentence
from reminders import remind

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
nb_code_prompt_show = "Show the code"
nb_code_prompt_hide = "Hide the code"
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 3
# With Tab one goes from link to link and from slider to slider, not through a hundred formulas.
mathjax3_config = {
    "options": {"menuOptions": {"settings": {"inTabOrder": False}}},
    # Formulas are as large as the type they stand in, whether it is there yet or not.
    "chtml": {"matchFontHeight": False, "scale": 1.06},
}

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
html_theme_options = {
    "navbar_persistent": [],
    "home_page_in_toc": True,
    "article_header_start": ["toggle-primary-sidebar.html", "chapters.html"],
}
templates_path = ["templates"]

numpydoc_show_class_members = False
suppress_warnings = ["ref.python"]  # a word that names several things is then just a word
html_static_path = ["site.css", "site.js"]
html_css_files = ["site.css"]
html_js_files: list[Any] = ["site.js"]

# Sphinx's own tags: the site has Python for the browser, and JupyterLite.
LIVE, LITE = (tags.has(name) for name in ("live", "lite"))  # type: ignore[name-defined] # noqa: F821
if LIVE:
    html_static_path += ["static", "../cvnotes/show/explorations/grips.js"]
    html_css_files.append("live/live.css")
    defer = {"defer": "defer"}  # in this order, once the page is there
    scripts = ("page", "explore", "exercises", "visit")
    html_js_files += [("grips.js", defer), *((f"live/{name}.js", defer) for name in scripts)]
    html_sidebars = {
        "**": ["navbar-logo.html", "search-button-field.html", "run.html", "sbt-sidebar-nav.html"]
    }
RUN = (
    '<p class="run"><span><a href="{address}">Run this chapter in this browser</a>: '
    "nothing to install, 66 MB once.</span></p>"
)


def escape_initials(*event: Any) -> None:
    """Keep a reference that begins with an author's initial ("Z. Zhang") from being a list."""
    lines = event[-1]
    lines[:] = [re.sub(r"^(\s*\.\. \[\d+\] [A-Z])\. ", r"\1\\. ", line) for line in lines]


def offer_to_run(*event: Any) -> None:
    """Lead from a chapter to its notebook in JupyterLite, below its motto and beside each page."""
    _, page, _, context, _ = event
    context["lite"] = LITE
    context["chapter"] = chapter = page.removeprefix("notebooks/") if "notebooks/" in page else ""
    if LITE and chapter and "body" in context:
        address = context["pathto"]("lite/notebooks/index.html", 1)
        link = RUN.format(address=f"{address}?path={page}.ipynb")
        head = re.compile(r"</h1>(\s*<blockquote>.*?</blockquote>)?", re.S)
        context["body"] = head.sub(rf"\g<0>\n{link}", context["body"], count=1)


def name_chapters(*event: Any) -> None:
    """Tell the head of each page which chapters there are: page, number and title."""
    app, _, _, context, _ = event
    titles = app.env.titles
    context["chapters"] = [
        (page, f"{int(name[:2])}" if name[0].isdigit() else name.partition("_")[0], titles[page])
        for page in sorted(titles)
        if (name := page.removeprefix("notebooks/")) != page
    ]


CONTENTS: dict[tuple[Any, ...], tuple[str, str]] = {}
LINK = '<li class="toctree-l1"><a class="reference internal" href="{}.html">'
HERE = '<li class="toctree-l1 current"><a class="current reference internal" href="#">'


def share_contents(*event: Any) -> None:
    """Write the table of contents once for all pages of a folder, and for all of source.

    It takes longer than all else of most pages, and differs but for the mark at the page itself.
    """
    _, page, _, context, doctree = event
    own = context["toctree"]
    where = page.count("/") if doctree is None else page.rpartition("/")[0]

    def toctree(**how: Any) -> str:
        key = (where, *sorted(how.items()))
        if key not in CONTENTS:
            CONTENTS[key] = page, own(**how)
        first, text = CONTENTS[key]
        if doctree is None or page == first:
            return text
        return move_mark(text, first, page) or own(**how)

    context["toctree"] = toctree


def move_mark(text: str, first: str, page: str) -> str:
    """Mark another page of the folder as the one that is read; gives nothing if it is not there."""
    name, old = (each.rpartition("/")[2] for each in (page, first))
    text = text.replace(HERE, LINK.format(old)).replace('<ul class="current">', "<ul>")
    before, link, after = text.partition(LINK.format(name))
    if not link:
        return ""
    outside, _, inside = before.rpartition("<ul>")
    return f'{outside}<ul class="current">{inside}{HERE}{after}'


CHECKED = re.compile(r'^check\("(\w+)"', re.MULTILINE)


def name_exercises(_: Any, doctree: Any) -> None:
    """Let links lead to the cell in which an exercise is answered: #exercise-name."""
    for node in doctree.findall(nodes.container):
        if "cell" in node["classes"] and (found := CHECKED.search(node.astext())):
            node["ids"].append(f"exercise-{found[1]}")


WAY_BACK = re.compile(r'(reference/[\w.]+)\.html#([\w.]+)"')


def lead_back(*event: Any) -> None:
    """Let a page of source lead back to where each of its names is documented.

    viewcode takes all names of a file for names of the module that it met first; ours are
    documented with their chapters.
    """
    app, page, _, context, _ = event
    if not page.startswith("_modules/"):
        return
    documented: dict[str, list[str]] = {}  # names by document
    for full, entry in app.env.domains["py"].objects.items():
        documented.setdefault(entry.docname, []).append(full)

    def known(match: re.Match[str]) -> str:
        """Lead to the documented name that has most of its last parts in common with this one."""
        document, name = match.groups()
        parts = name.split(".")
        for tail in (".".join(["", *parts[i:]]) for i in range(len(parts))):
            for full in documented.get(document, ()):
                if f".{full}".endswith(tail):
                    return f'{document}.html#{full}"'
        return match[0]

    context["body"] = WAY_BACK.sub(known, context["body"])


FRONT = sentence((ROOT / "README.md").read_text(encoding="utf-8"))
DESCRIBED = 160  # letters: what searches and previews show


def describe(*event: Any) -> None:
    """Say what a page is about to those who show links: its first paragraph, and the picture."""
    _, page, _, context, doctree = event
    if doctree is None:
        return
    shown = (each.astext() for each in doctree.findall(lambda node: node.tagname == "paragraph"))
    first = FRONT if page == "index" else next((text for text in shown if len(text) > 40), FRONT)
    words = shorten(first, DESCRIBED, placeholder=" …")
    address = context["pathto"]("_figures/front.png", 1)
    if base := event[0].config.html_baseurl:
        address = f"{base.rstrip('/')}/_figures/front.png"
    about = {"og:title": context["title"], "og:description": words, "og:image": address}
    tags = [f'<meta name="description" content="{escape(words)}">']
    tags += [f'<meta property="{key}" content="{escape(said)}">' for key, said in about.items()]
    context["metatags"] = context.get("metatags", "") + "\n".join(tags)


def setup(app: Any) -> None:
    """Have Sphinx call us before numpydoc, and when a page is read or written."""
    app.connect("autodoc-process-docstring", escape_initials, priority=100)
    app.connect("doctree-read", name_exercises)
    app.connect("doctree-resolved", remind)
    app.connect("html-page-context", describe)
    app.connect("html-page-context", name_chapters)
    app.connect("html-page-context", share_contents)
    app.connect("html-page-context", lead_back)
    if LIVE:
        app.connect("html-page-context", offer_to_run)
