"""Make slides of the notebooks: for the room, offline, one page of HTML for each notebook.

    python tools/build_slides.py                    into docs/_build/slides
    python tools/build_slides.py --out FOLDER
    python tools/build_slides.py notebooks/07*      of one notebook
    python tools/build_slides.py --serve            and hand them out, for explorations that move
    python tools/build_slides.py --parts FOLDER     Pyodide from a folder of yours
    python tools/build_slides.py --without-python   the slides alone

Needs the extra `docs` (`python3 start.py slides` sets it up). Nothing is executed: headings,
theses, formulas, traps and figures are taken from the notebooks as they are committed. What a
slide leaves out stands in its notes, for the lecturer; of a cell the code is there, too. Printed by
the browser, each slide is a page.

With the parts of Python for the browser (`tools/browser_parts.py` says where they come from) the
explorations move as they do on the site, with the same scripts, and without a network. A browser
runs Python only for pages that a server hands out: `--serve` is one, for this machine alone. Opened
as files, the slides show each exploration as a picture.
"""

import argparse
import functools
import http.server
import json
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from string import Template
from typing import Any

from browser_parts import PartsMissingError, gather, lay_out
from lectures import plan
from markdown_it import MarkdownIt
from mdit_py_plugins.dollarmath import dollarmath_plugin

ROOT = Path(__file__).resolve().parents[1]
LOOKS = ROOT / "docs" / "slides"
MATHJAX = ("tex-chtml.js", "input", "output")
# Of the site's scripts, those that let explorations move.
LIVE = tuple(
    ROOT / folder / name
    for folder, names in (
        ("docs/static/live", ("python.js", "worker.js", "page.js", "explore.js", "live.css")),
        ("cvnotes/show/explorations", ("grips.js",)),  # shared with the notebook
    )
    for name in names
)
# Sections that are read, and not shown.
NOT_SHOWN = ("further reading", "what comes next", "the same in opencv")
# An answer is folded under its question; on slides it stands in the notes.
_ANSWER = re.compile(
    r"^ *<details><summary>(?:Answer|Proof|More exactly)</summary>\n(.+?)^ *</details>$",
    re.M | re.S,
)
_DISPLAY = re.compile(r"\$\$.+?\$\$", re.S)
_QUESTION = re.compile(r"^guess\(\"[^\"]+\", \.\.\., \"([^\"]+)\"", re.M)

_markdown = (
    MarkdownIt("commonmark", {"html": False})
    .enable("table")
    .use(
        dollarmath_plugin,
        renderer=lambda text, options: (
            f"\\[{escape(text)}\\]" if options["display_mode"] else f"\\({escape(text)}\\)"
        ),
    )
)


@dataclass
class Slide:
    """What is shown at once, and what the lecturer has beside it."""

    title: str
    shown: list[str] = field(default_factory=list)  # HTML
    notes: list[str] = field(default_factory=list)  # Markdown
    code: str = ""
    kind: str = "words"

    def html(self, number: int) -> str:
        """Return the slide as a part of a page."""
        code = f'<pre class="code">{escape(self.code)}</pre>' if self.code else ""
        notes = _markdown.render("\n\n".join(self.notes)) if self.notes else ""
        shown = "\n".join(self.shown)
        return (
            f'<section class="slide {self.kind}" id="s{number}"><h2>{inline(self.title)}</h2>'
            f'<div class="shown">{shown}</div>{code}<aside class="notes">{notes}</aside></section>'
        )


def inline(text: str) -> str:
    """Render a line of Markdown."""
    return str(_markdown.renderInline(text))


def slides_of(notebook: dict[str, Any]) -> list[Slide]:
    """Return the slides of a notebook, in its order."""
    slides: list[Slide] = []
    before = ""  # the paragraph in front of a cell: it says what to look for
    skipped = False
    for cell in notebook["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            source = _ANSWER.sub(lambda folded: f"Answer: {' '.join(folded[1].split())}", source)
            for title, text in parts_of(source):
                if title is not None:
                    skipped = title.lower().startswith(NOT_SHOWN)
                    if not skipped:
                        slides.append(Slide(title, kind="title" if not slides else "words"))
                if not skipped and slides:
                    add_words(slides, text)
            said = [part for part in paragraphs(source) if not part.startswith("Answer: ")]
            before = said[-1] if said else ""
        elif not skipped and slides:
            slides.extend(shown_by(cell, source, slides[-1].title, before))
    for slide in slides:
        if (
            slide.kind == "words"
            and slide.notes
            and not any("thesis" not in x for x in slide.shown)
        ):
            slide.shown.append(f"<p>{inline(first_sentences(slide.notes[0]))}</p>")
    return [slide for slide in slides if slide.shown or slide.kind == "title"]


def parts_of(source: str) -> Iterator[tuple[str | None, str]]:
    """Cut a cell at its headings; what stands before the first has none."""
    pieces = re.split(r"^##? (.+)$", source, flags=re.M)
    if pieces[0].strip():
        yield None, pieces[0]
    yield from zip(pieces[1::2], pieces[2::2], strict=True)


def paragraphs(text: str) -> list[str]:
    """Cut a text where a line is empty."""
    return [part.strip() for part in re.split(r"\n\s*\n", text) if part.strip()]


def add_words(slides: list[Slide], text: str) -> None:
    """Show of a text its thesis, formulas, lists, tables, questions and traps; keep the rest."""
    slide = slides[-1]
    for part in paragraphs(text):
        if part.startswith("Answer: "):
            slide.notes.append(part)
        elif part.startswith("**Careful"):
            slides.append(Slide(slide.title, [_markdown.render(part)], kind="careful"))
        elif part.startswith(">"):
            slide.shown.insert(0, f'<p class="thesis">{inline(part.lstrip("> ").strip("*"))}</p>')
        elif slide.kind in ("picture", "careful"):  # a new thought, after what was shown
            slides.append(Slide(slide.title))
            add_words(slides, part)
            slide = slides[-1]
        else:
            slide.notes.append(part)
            if shown := essence(part):
                slide.shown.append(shown)


def essence(part: str) -> str:
    """Return what of a paragraph is to be seen from the last row."""
    if part.startswith(("|", "* ", "- ", "1. ")):
        return str(_markdown.render(part))
    formulas = "".join(f"<div>{_markdown.render(f)}</div>" for f in _DISPLAY.findall(part))
    without = _DISPLAY.sub(" ", part)
    asked = re.findall(r"(?:(?<=[.!?:] )|^)([A-Z*$][^.!?]*\?)", without)
    questions = "".join(f'<p class="question">{inline(q)}</p>' for q in asked)
    defined = re.match(r"\*\*(You will learn|Change this and run again)\.?\*\*", part)
    return (_markdown.render(part) if defined else "") + formulas + questions


def shown_by(cell: dict[str, Any], source: str, title: str, before: str) -> Iterator[Slide]:
    """Return a slide for each figure of a cell, and one for what it prints."""
    if question := _QUESTION.search(source):
        yield Slide(title, [f'<p class="question">Guess: {inline(question[1])}?</p>'])
        return
    if re.search(r"^check\(", source, re.M):
        return
    for output in cell.get("outputs", []):
        data = output.get("data", {})
        html = "".join(data.get("text/html", ""))
        text = "".join(output.get("text", "")) or "".join(data.get("text/plain", ""))
        if "<img" in html or "<svg" in html:
            caption = f'<p class="caption">{inline(last_sentences(before))}</p>'
            shown = f'<div class="output">{html}</div>'
            yield Slide(title, [shown, caption], [before], source, "picture")
        elif html or text.strip():
            said = f"<p>{inline(last_sentences(before))}</p>"
            printed = html or f"<pre>{escape(text.rstrip())}</pre>"
            yield Slide(title, [said, printed], [before], source, "printed")


def sentences_of(text: str) -> list[str]:
    """Cut a paragraph into its sentences, without its formulas on lines of their own."""
    return re.split(r"(?<=[.?!]) (?=[A-Z*])", " ".join(_DISPLAY.sub(" ", text).split()))


def first_sentences(text: str, longest: int = 220) -> str:
    """Return the beginning of a paragraph, in whole sentences, as far as it is short."""
    first, *others = sentences_of(text)
    for sentence in others:
        if len(first) + len(sentence) > longest:
            break
        first = f"{first} {sentence}"
    return first


def last_sentences(text: str, longest: int = 220) -> str:
    """Return the end of a paragraph, in whole sentences, as far as it is short."""
    *others, last = sentences_of(text)
    for sentence in reversed(others):
        if len(sentence) + len(last) > longest:
            break
        last = f"{sentence} {last}"
    return last


def page(name: str, slides: list[Slide], *, live: bool) -> str:
    """Return the whole page of one notebook; `live`: the folder has Python for the browser."""
    template = Template((LOOKS / "slides.html").read_text(encoding="utf-8"))
    body = "\n".join(slide.html(i) for i, slide in enumerate(slides, 1))
    has = ' data-live="yes"' if live else ""
    return template.substitute(title=escape(slides[0].title), name=name, slides=body, live=has)


def index(made: dict[str, list[Slide]]) -> str:
    """Return the page that leads to all."""
    teaching = (ROOT / "docs" / "teaching.md").read_text(encoding="utf-8")
    whole = len(made) == len(list(ROOT.glob("notebooks/*.ipynb")))
    lectures = plan(teaching, made) if whole else {}
    links = [
        f'<li><a href="{name}.html">{inline(slides[0].title)}</a> ({len(slides)} slides)'
        + (f"<p>In 90 minutes: {inline(lectures[name[1]])}</p>" if name[1] in lectures else "")
        + "</li>"
        for name, slides in made.items()
    ]
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width"><title>Slides</title>'
        '<link rel="stylesheet" href="slides.css"><body class="index"><h1>Slides of the course</h1>'
        f"<ul>{''.join(links)}</ul></body></html>"
    )


def formulas() -> Path:
    """Find MathJax, which the site uses, too."""
    for folder in map(Path, sys.path):
        found = folder / "sphinx-mathjax-offline" / "static" / "mathjax"
        if (found / "tex-chtml.js").exists():
            return found
    raise SystemExit("The slides need the extra `docs`: python3 start.py slides installs it.")


def python_parts(folder: Path | None) -> Path | None:
    """Find Python for the browser; without it the slides are as good, and nothing moves."""
    try:
        return gather(folder)
    except PartsMissingError as error:
        print(f"The explorations will be pictures: {error}")
        return None


def serve(folder: Path) -> None:
    """Hand the slides out to this machine until Ctrl-C."""
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=folder)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        print(f"They move at http://127.0.0.1:{server.server_port}/ until Ctrl-C", flush=True)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            print()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("notebooks", nargs="*", type=Path, help="default: all")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "_build" / "slides")
    parser.add_argument("--parts", type=Path, help="a folder that has the parts of Pyodide")
    parser.add_argument("--without-python", action="store_true", help="explorations as pictures")
    parser.add_argument("--serve", action="store_true", help="hand the slides out to this machine")
    given = parser.parse_args()
    if given.out.exists() and not (given.out / "slides.js").is_file():
        print(f"{given.out} is in the way: it is no folder of slides, and is not replaced")
        return 1
    mathjax = formulas()
    parts = None if given.without_python else python_parts(given.parts)
    made = {}
    for path in given.notebooks or sorted((ROOT / "notebooks").glob("*.ipynb")):
        made[path.stem] = slides_of(json.loads(path.read_text(encoding="utf-8")))
    with tempfile.TemporaryDirectory() as folder:
        new = Path(folder) / "slides"
        new.mkdir()
        for name, slides in made.items():
            text = page(name, slides, live=parts is not None)
            (new / f"{name}.html").write_text(text, encoding="utf-8")
        (new / "index.html").write_text(index(made), encoding="utf-8")
        for looks in ("slides.css", "slides.js"):
            shutil.copy(LOOKS / looks, new)
        for part in MATHJAX:
            copy = shutil.copytree if (mathjax / part).is_dir() else shutil.copy
            (new / "mathjax").mkdir(exist_ok=True)
            copy(mathjax / part, new / "mathjax" / part)
        if parts:
            lay_out(parts, new / "python")
            (new / "_static" / "live").mkdir(parents=True)
            for script in LIVE:
                shutil.copy(script, new / "_static" / "live")
        if given.out.exists():
            shutil.rmtree(given.out)
        shutil.copytree(new, given.out)
    print(f"The slides are in {given.out / 'index.html'}")
    if given.serve:
        serve(given.out)
    elif parts:
        print("Explorations move where a server hands them out: add --serve")
    return 0


if __name__ == "__main__":
    sys.exit(main())
