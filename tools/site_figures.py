"""The figures of the site's pages as files: a page is read at once, and a figure when it is seen.

A wide figure of two or three panels, or of two rows of them, gets their rectangles, `data-panels`;
`site.js` puts them one below the other where the page is narrow. An exploration draws another still
for such a page, whose letters are as large.
"""

import base64
import hashlib
import html
import io
import json
import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image

from cvnotes.show.explorations import NAMES
from cvnotes.show.explorations.page import asked

FOLDER = "_figures"
_WIDE = 1.55  # widths over heights from which a figure may be cut
_THREE = 2.6  # from which it may have three panels
_GAP = 8  # px without ink that part two panels; a photograph blurs four of twelve
_INK = 250  # grey levels below which something is drawn
_STORED = re.compile(
    r'(<img alt="[^"]*" width="(\d+)" style=")([^"]*" )src="data:image/(png|webp);base64,([^"]+)"'
)
_DRAWN = re.compile(r'data:image/svg\+xml;base64,([^"]+)')
_EXPLORED = re.compile(
    rf'(<img [^>]*?)(data-panels="[^"]*" )?(src="\.\./{FOLDER}/[^>]+>)'
    r'((?:(?!<img ).)*?data-explore=")([^"]+)"',
    re.S,
)


def put_into_files(made: Path) -> None:
    """Write the figures that stand in the notebooks' pages to files, and have them fetched late."""
    folder = made / FOLDER
    folder.mkdir()
    for page in sorted((made / "notebooks").glob("*.html")):
        text = page.read_text(encoding="utf-8")
        text = _STORED.sub(lambda found: _fetched(found, folder), text)
        text = _DRAWN.sub(lambda found: _file(base64.b64decode(found[1]), "svg", folder), text)
        text = _EXPLORED.sub(lambda found: _for_telephones(found, folder), text)
        page.write_text(text, encoding="utf-8")


def _fetched(found: re.Match[str], folder: Path) -> str:
    """Write one figure, and give the beginning of the element that fetches it."""
    content = base64.b64decode(found[5])
    with Image.open(io.BytesIO(content)) as image:
        width, height = image.size
        panels = panels_of(np.asarray(image.convert("RGB")))
    words = ";".join(" ".join(map(str, panel)) for panel in panels)
    marks = f'data-panels="{words}" ' if len(panels) > 1 else ""
    tall = round(int(found[2]) * height / width)
    return (
        f'{found[1]}height: auto; {found[3]}height="{tall}" loading="lazy" {marks}'
        f'src="{_file(content, found[4], folder)}"'
    )


def _file(content: bytes, kind: str, folder: Path) -> str:
    """Write a picture to a file of its own, and return how a page of a chapter calls it."""
    name = f"{hashlib.sha256(content).hexdigest()[:16]}.{kind}"
    (folder / name).write_bytes(content)
    return f"../{FOLDER}/{name}"


def _for_telephones(found: re.Match[str], folder: Path) -> str:
    """Put beside an exploration's still the one that a narrow page would draw."""
    image, _, source, between, data = found.groups()
    told = json.loads(html.unescape(data))
    if told["name"] not in NAMES:  # points that are pulled ask the cells of the page
        return found[0]
    question = {key: told[key] for key in ("name", "values", "camera", "board")}
    shown = asked(json.dumps(question | {"sharpness": 2, "narrow": True}))
    rest = json.loads(shown.rest)
    drawn = Image.frombytes("RGBA", rest["size"], shown.pixels).convert("RGB")
    drawn.save(packed := io.BytesIO(), "webp", quality=85)
    width, height = size = [side // 2 for side in rest["size"]]
    told["narrow"] = {"size": size, "grips": rest["grips"]}
    data = html.escape(json.dumps(told, ensure_ascii=False))
    return (
        f'<picture><source media="(max-width: 40rem)" '
        f'srcset="{_file(packed.getvalue(), "webp", folder)}" '
        f'width="{width}" height="{height}">{image}{source}</picture>{between}{data}"'
    )


def panels_of(picture: npt.NDArray[np.uint8]) -> list[tuple[int, int, int, int]]:
    """Return the panels of a picture (height, width, 3): left, top, width and height of each.

    Examples
    --------
    >>> picture = np.full((100, 300, 3), 255, np.uint8)
    >>> picture[20:80, 10:130] = picture[20:80, 160:290] = 0
    >>> panels_of(picture)
    [(0, 0, 145, 100), (145, 0, 155, 100)]
    >>> uneven = np.full((100, 300, 3), 255, np.uint8)
    >>> uneven[20:80, 10:195] = uneven[20:80, 210:290] = 0
    >>> panels_of(uneven)
    [(0, 0, 202, 100), (202, 0, 98, 100)]
    >>> picture[5:12, 20:80] = picture[5:12, 180:220] = 0  # titles, which stay with their panels
    >>> [panel[:2] for panel in panels_of(np.vstack([picture, picture]))]
    [(0, 0), (145, 0), (0, 92), (145, 92)]
    """
    height, width = picture.shape[:2]
    if width < _WIDE * height:
        row = _above_titles(np.asarray((picture >= _INK).all(axis=(1, 2))))
        if row is None or min(width / row, width / (height - row)) < _WIDE:
            return [(0, 0, width, height)]
        upper, lower = panels_of(picture[:row]), panels_of(picture[row:])
        if 1 in (len(upper), len(lower)):
            return [(0, 0, width, height)]
        return upper + [(left, row + top, wide, high) for left, top, wide, high in lower]
    empty = np.asarray((picture >= _INK).all(axis=(0, 2)))
    cuts, three = [_gap(empty, 0.29, 0.71)], [_gap(empty, 0.25, 0.42), _gap(empty, 0.58, 0.75)]
    halved = cuts[0] is not None and abs(cuts[0] / width - 0.5) < 0.05  # two panels, or two and two
    if width > _THREE * height and not halved and None not in three:
        cuts = three
    edges = [0, *(cut for cut in cuts if cut is not None), width]
    return [(a, 0, b - a, height) for a, b in pairwise(edges) if not empty[a:b].all()]


def _runs(empty: npt.NDArray[np.bool_], begin: float, end: float) -> list[list[int]]:
    """Return where the runs of empty columns, or rows, of a part begin and end."""
    first, last = round(begin * len(empty)), round(end * len(empty))
    edges = np.flatnonzero(np.diff(np.r_[0, empty[first:last], 0]))
    return (first + edges.reshape(-1, 2)).tolist()


def _gap(empty: npt.NDArray[np.bool_], begin: float, end: float) -> int | None:
    """Return the middle of the widest run of empty columns in a part; None if narrow."""
    start, stop = max(_runs(empty, begin, end), key=lambda run: run[1] - run[0], default=(0, 0))
    return round((start + stop) / 2) if stop - start >= _GAP else None


def _above_titles(empty: npt.NDArray[np.bool_]) -> int | None:
    """Return the row above the titles of the lower panels, which stand before the last gap."""
    gaps = [run for run in _runs(empty, 0.4, 0.6) if run[1] - run[0] >= _GAP / 2]
    return round(sum(gaps[-2]) / 2) if len(gaps) > 1 else None
