"""The figures of the site's pages as files: a page is read at once, and a figure when it is seen.

A wide figure of two or three panels gets marks where it may be cut, `data-cuts`; `site.js` puts its
panels one below the other where the page is narrow.
"""

import base64
import hashlib
import io
import re
from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image

FOLDER = "_figures"
_WIDE = 1.8  # widths over heights from which a figure may be cut
_THREE = 2.6  # from which it may have three panels
_GAP = 12  # px without ink that part two panels
_INK = 250  # grey levels below which something is drawn
_STORED = re.compile(
    r'(<img alt="[^"]*" width="(\d+)" style=")([^"]*" )src="data:image/(png|jpeg);base64,([^"]+)"'
)


def put_into_files(made: Path) -> None:
    """Write the figures that stand in the notebooks' pages to files, and have them fetched late."""
    folder = made / FOLDER
    folder.mkdir()
    for page in sorted((made / "notebooks").glob("*.html")):
        text = page.read_text(encoding="utf-8")
        page.write_text(_STORED.sub(lambda found: _fetched(found, folder), text), encoding="utf-8")


def _fetched(found: re.Match[str], folder: Path) -> str:
    """Write one figure, and give the beginning of the element that fetches it."""
    content = base64.b64decode(found[5])
    name = f"{hashlib.sha256(content).hexdigest()[:16]}.{found[4]}"
    (folder / name).write_bytes(content)
    with Image.open(io.BytesIO(content)) as image:
        width, height = image.size
        cuts = places_to_cut(np.asarray(image.convert("RGB")))
    marks = f'data-cuts="{" ".join(map(str, cuts))}" ' if cuts else ""
    tall = round(int(found[2]) * height / width)
    return (
        f'{found[1]}height: auto; {found[3]}height="{tall}" loading="lazy" {marks}'
        f'src="../{FOLDER}/{name}"'
    )


def places_to_cut(picture: npt.NDArray[np.uint8]) -> list[int]:
    """Return the columns of a picture (height, width, 3) in which its panels meet.

    Examples
    --------
    >>> picture = np.full((100, 300, 3), 255, np.uint8)
    >>> picture[20:80, 10:130] = picture[20:80, 160:290] = 0
    >>> places_to_cut(picture)
    [145]
    """
    height, width = picture.shape[:2]
    if width < _WIDE * height:
        return []
    empty = np.asarray((picture >= _INK).all(axis=(0, 2)))
    if width > _THREE * height:
        thirds = [_gap(empty, 0.25, 0.42), _gap(empty, 0.58, 0.75)]
        if None not in thirds:
            return [cut for cut in thirds if cut is not None]
    middle = _gap(empty, 0.33, 0.67)
    return [] if middle is None else [middle]


def _gap(empty: npt.NDArray[np.bool_], begin: float, end: float) -> int | None:
    """Return the middle of the widest run of empty columns in a part; None if narrow."""
    first, last = round(begin * len(empty)), round(end * len(empty))
    edges = np.flatnonzero(np.diff(np.r_[0, empty[first:last], 0]))
    runs = edges.reshape(-1, 2)
    if not len(runs):
        return None
    start, stop = max(runs.tolist(), key=lambda run: run[1] - run[0])
    return first + round((start + stop) / 2) if stop - start >= _GAP else None
