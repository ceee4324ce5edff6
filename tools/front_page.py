"""The site's first page: what the course is in ten seconds, made of what the course is made of.

The sentence and the questions are README's, the picture is docs/figures/front.png (tools/
draw_front.py), the cards are the chapters' own figures, and the tutor's reply is what `check` says.
"""

import base64
import io
import json
import re
from functools import lru_cache
from html import escape
from pathlib import Path

import numpy as np
from PIL import Image
from site_figures import FOLDER, panels_of

from cvnotes.learn import check
from cvnotes.show import explorations
from cvnotes.show.explorations.page import page_data
from cvnotes.show.explorations.paper import Panel, Paper, Range

ROOT = Path(__file__).resolve().parents[1]
TEMPLATE = ROOT / "docs" / "templates" / "front.md"
PICTURE = ROOT / "docs" / "figures" / "front.png"
EXPLORED = "cube"
CARD = (480, 320)  # px: twice what is shown
# Cards that are a part of an exploration: its settings, the left and upper end, the width in px.
PARTS = {
    "03_camera_model": ("glass", {}, (6, 88, 360)),
    "06_homography_dlt": ("homography", {"u": 0.0, "v": 0.0}, (20, 42, 346)),
    "07_zhang_calibration": ("nails", {}, (6, 44, 500)),
    "10_two_pictures": ("rectification", {}, (256, 26, 432)),
    "11_board_we_believed": ("sheets", {"amount": 1.0}, (366, 33, 308)),
}
_ROW = re.compile(r"^\| (\S+) \| \[(.+?)\]\(notebooks/(\w+)\.ipynb\) \| (.+?) \|$", re.M)
_HOURS = re.compile(r"^\|\w+\|\[.+?\]\((\w+)\.ipynb\)\|.+\|(\S+)\|$", re.M)
_IMAGE = re.compile(r'src="data:image/(?:png|webp);base64,([^"]+)"')

# What is drawn on the buttons: an open book, a triangle in a ring, a camera.
BOOK = "M12 6v14M12 6C9 4 6 4 2.5 4.5v14C6 18 9 18 12 20c3-2 6-2 9.5-1.5v-14C18 4 15 4 12 6"
PLAY = "M12 2.5a9.5 9.5 0 1 0 .01 0zM9.8 7.8v8.4l6.8-4.2z"
LENS = "M2.5 7h4.5l2-3h6l2 3h4.5v13h-19zM12 9a4.2 4.2 0 1 0 .01 0z"

# A common mistake, as a student writes it.
WRONG = """def my_camera_centre(R, T):
    return T


check("camera_centre", my_camera_centre)"""
# Before the picture, which follows the hand.
QUESTION = """<p class="front-question"><strong>The tower is not there:</strong> it is drawn where
the camera would see it. Pull the camera nearer, as if we had mistaken where it stood: the tower
leaves its true outline, dashed. Can a shorter focal length hide this? Pull the glass pane towards
the camera.</p>"""
# Below it.
SOLUTION = """<details><summary>Answer</summary><p>No: when the foot is right,
the top is not. <a href="notebooks/00_start_here.html">Chapter 0</a> says why.</p></details>"""
# What docs/static/live/exercises.js makes a box of.
BOX = """A student writes `return T`, and below it the
course answers. Mend it, and press *Check*.

```{raw} html
<div class="front-answer"><div class="cell_input"><pre>@CODE@</pre></div>
<p class="front-reply"><strong>Not yet right.</strong> @SAID@</p></div>
```"""
REPLY = """A student writes `return T`, and the course answers:

> **Not yet right.** @SAID@"""


def camera_centre(R: object, T: object) -> object:  # noqa: ARG001
    """Answer as in WRONG."""
    return T


def front_page(live: bool, lite: bool) -> str:
    """Write the page: with an exploration that moves and what runs here, if there is Python."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    rows = _ROW.findall(readme)
    parts = {
        "SENTENCE": sentence(readme),
        "BUTTONS": buttons(live, lite),
        "WHOM": whom(readme),
        "EXPLORATION": exploration(live),
        "QUESTION": QUESTION if live else "",
        "SOLUTION": SOLUTION if live else "",
        "CARDS": "\n".join(card(*row) for row in rows if row[0].isdigit()),
        "BEYOND": "\n".join(line(*row) for row in rows if not row[0].isdigit()),
        "ANSWER": answer(live),
    }
    page = TEMPLATE.read_text(encoding="utf-8")
    return re.sub(r"@([A-Z]+)@", lambda found: parts[found[1]], page)


def sentence(readme: str) -> str:
    """Return what README says first."""
    found = re.search(r"^\*\*(.+?)\*\*", readme, re.M | re.S)
    if not found:
        raise ValueError("README.md says nothing in bold letters, which the front page repeats")
    return " ".join(found[1].split())


def whom(readme: str) -> str:
    """Return for whom README says the course is, what it needs and how long it takes."""
    found = re.search(r"^For students .+$", readme, re.M)
    if not found:
        raise ValueError("README.md has no line 'For students ...', which the front page repeats")
    return found[0]


def buttons(live: bool, lite: bool) -> str:
    """Write the three ways into the course, those first that need nothing."""
    start = "notebooks/00_start_here"
    run = (
        "lite/notebooks/index.html?path=notebooks/00_start_here.ipynb"
        if lite
        else "docs/install.html"
    )
    own = "your_camera.html" if live else "notebooks/09_your_own_camera.html"
    at_home = "on your machine", ""
    ways = (  # on a telephone only the name, and what it costs
        (f"{start}.html", BOOK, "Read", f"chapter 0, {minutes()['00_start_here'][0]} minutes", ""),
        (run, PLAY, "Run", *(("Python in this page, ", "66 MB once") if lite else at_home)),
        (own, LENS, "Your own camera", "from photographs of a chessboard", ""),
    )
    return "\n".join(
        f'<a href="{to}"><svg viewBox="0 0 24 24" aria-hidden="true"><path d="{sign}"/></svg>'
        f'<strong>{name}</strong> <span><span class="front-what">{what}</span>{cost}</span></a>'
        for to, sign, name, what, cost in ways
    )


def exploration(live: bool) -> str:
    """Write the exploration as it is before Python comes: a picture for each width, and data."""
    model = explorations.model(EXPLORED)
    wide = json.loads(page_data(model, None, None, {}))
    data = model.drawn_on(Paper(1, narrow=True), model.values()).as_data()
    narrow = {"size": data["size"], "grips": data["grips"]}
    width, height = data["size"]
    picture = (
        f'<picture><source media="(max-width: 40rem)" srcset="{FOLDER}/front-narrow.png" '
        f'width="{width}" height="{height}">'
        f'<img src="{FOLDER}/front.png" width="{wide["size"][0]}" height="{wide["size"][1]}" '
        f'alt="{escape(model.still().alt)}"></picture>'
    )
    if not live:
        return picture
    data = escape(json.dumps(wide | {"narrow": narrow}, ensure_ascii=False))
    return f'{picture}<span class="cvnotes-explore" hidden data-explore="{data}"></span>'


def answer(live: bool) -> str:
    """Write a wrong answer and what the course says to it; with Python, in a box that checks."""
    said = check("camera_centre", camera_centre).message
    if live:
        return BOX.replace("@CODE@", escape(WRONG)).replace("@SAID@", escape(said))
    return REPLY.replace("@SAID@", said)


def card(number: str, title: str, name: str, question: str) -> str:
    """Write a chapter's card: its richest picture, its name and its question."""
    question = re.sub(r"\*(.+?)\*", r"<em>\1</em>", escape(question))
    return (
        f'<li><a href="notebooks/{name}.html"><img src="{FOLDER}/card-{name}.jpg" alt="" '
        f'width="{CARD[0] // 2}" height="{CARD[1] // 2}" loading="lazy">'
        f"<small>{hours().get(name, '')}</small> <strong>{int(number)} · {escape(title)}</strong> "
        f"<span>{question}</span></a></li>"
    )


def line(_: str, title: str, name: str, question: str) -> str:
    """Write what leads to a notebook that is no chapter."""
    link = f'<a href="notebooks/{name}.html">{escape(title)}</a>'
    return f'<p class="front-beyond">{link}: {escape(question)}</p>'


@lru_cache(maxsize=1)
def hours() -> dict[str, str]:
    """Return how long a chapter takes with its exercises, as the table of chapter 0 says."""
    first = json.loads((ROOT / "notebooks" / "00_start_here.ipynb").read_text(encoding="utf-8"))
    said = "\n".join("".join(cell["source"]) for cell in first["cells"])
    rows = {name: f"{each} h" for name, each in _HOURS.findall(said)}
    return {"00_start_here": f"{sum(minutes()['00_start_here'])} min"} | rows


@lru_cache(maxsize=1)
def minutes() -> dict[str, list[int]]:
    """Return the minutes of reading, and of all else, that each chapter names under its title."""
    times = {}
    for path in sorted(ROOT.glob("notebooks/[0-9]*.ipynb")):
        (line,) = re.findall(r"\*\*Time\*\* .+? min\.", path.read_text(encoding="utf-8"))
        times[path.stem] = [int(said) for said in re.findall(r"(\d+) min", line)]
    return times


def put_pictures(made: Path) -> None:
    """Write the pictures of the page into the site."""
    for path in sorted(ROOT.glob("notebooks/[0-9]*.ipynb")):
        card_of(path).save(made / FOLDER / f"card-{path.stem}.jpg", quality=80, optimize=True)
    (made / FOLDER / "front.png").write_bytes(PICTURE.read_bytes())
    drawn(narrow=True).save(made / FOLDER / "front-narrow.png", optimize=True)


def drawn(narrow: bool = False) -> Image.Image:
    """Draw the exploration at twice its resolution, in 256 colours: PNG is shown everywhere."""
    model = explorations.model(EXPLORED)
    picture = model.drawn_on(Paper(2, narrow=narrow), model.values()).picture
    return Image.fromarray(picture).quantize(256, dither=Image.Dither.NONE)


def card_of(path: Path) -> Image.Image:
    """Return one clear thing of a notebook, as it is seen at the size of a card."""
    if path.stem not in PARTS:
        return richest(path)
    name, settings, (left, top, width) = PARTS[path.stem]
    model = explorations.model(name)
    picture = Image.fromarray(model.drawn_on(_Wordless(2), model.values() | settings).picture)
    box = np.array([left, top, left + width, top + width * CARD[1] / CARD[0]])
    return picture.resize(CARD, Image.Resampling.LANCZOS, tuple(2 * box))


class _Wordless(Paper):
    """A paper on which no words are written: on a card they could not be read."""

    def panel(self, size: tuple[int, int], x: Range, y: Range, title: str = "") -> Panel:
        """Make a panel of the same size, the strip for its title kept."""
        return _Silent(size, x, y, title, 2 * self.sharpness)


class _Silent(Panel):
    def text(self, *_: object, **__: object) -> None:
        """Write nothing."""

    def grip(self, *_: object, **__: object) -> None:
        """Draw no ring: a card is not pulled."""


def richest(path: Path) -> Image.Image:
    """Return the panel that has most colours and least paper, of the cell with the tag `card`.

    Where no cell has it, of all figures of the notebook.
    """
    best, wealth = Image.new("RGB", CARD, "white"), 0.0
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    for cell in [each for each in cells if "card" in each["metadata"].get("tags", [])] or cells:
        for output in cell.get("outputs", []):
            for found in _IMAGE.finditer("".join(output.get("data", {}).get("text/html", ""))):
                figure = Image.open(io.BytesIO(base64.b64decode(found[1]))).convert("RGB")
                for left, top, width, height in panels_of(np.asarray(figure)):
                    panel = figure.crop((left, top, left + width, top + height))
                    if 0.9 < panel.width / panel.height < 1.8 and (own := _wealth(panel)) > wealth:
                        best, wealth = panel, own
    return fitted(best)


def _wealth(panel: Image.Image) -> float:
    small = panel.copy()
    small.thumbnail((240, 240))
    pixels = np.asarray(small)
    # One number for each colour: rows of three are sorted for seconds.
    colours = len(np.unique((pixels // 16).astype(int) @ [256, 16, 1]))
    return colours * float((pixels.min(axis=2) < 245).mean())


def fitted(panel: Image.Image) -> Image.Image:
    """Cut the middle of what is drawn, without the numbers along its axes."""
    ink = np.asarray(panel).min(axis=2) < 245
    rows, columns = (np.flatnonzero(ink.mean(axis=axis) > 0.5) for axis in (1, 0))
    if len(rows) > 40 and len(columns) > 40:
        panel = panel.crop((columns[0] + 3, rows[0] + 3, columns[-1] - 2, rows[-1] - 2))
    width, height = panel.size
    scale = max(CARD[0] / width, CARD[1] / height)
    panel = panel.resize((round(width * scale), round(height * scale)), Image.Resampling.LANCZOS)
    left, top = (panel.width - CARD[0]) // 2, (panel.height - CARD[1]) // 2
    return panel.crop((left, top, left + CARD[0], top + CARD[1]))
