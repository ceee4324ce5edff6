"""The type of pictures: Source Sans, that of the pages, so that a figure belongs to its page."""

import base64
import io
import logging
import os
import re
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from PIL import ImageFont

from cvnotes.base import FileError

_PLACES = (
    ("font_source_sans_pro", "files/SourceSansPro-Regular.ttf"),
    ("matplotlib", "mpl-data/fonts/ttf/DejaVuSans.ttf"),  # where the first cannot be installed
)
_NOT_DRAWN = ["FFTM", "GPOS", "GSUB", "GDEF", "BASE", "DSIG", "meta"]
_X = 0.547  # of DejaVu Sans, to which the sizes in the code belong: height of its x in em


@lru_cache(maxsize=1)
def font_file() -> Path:
    """Find the type's file; neither matplotlib nor the font's package is loaded for it.

    On a page neither is there: whoever runs the explorations there names a file with their
    letters in CVNOTES_FONT.

    Examples
    --------
    >>> font_file().name
    'SourceSansPro-Regular.ttf'
    """
    if given := os.environ.get("CVNOTES_FONT"):
        return Path(given)
    for package, place in _PLACES:
        found = find_spec(package)
        if found is not None and found.origin is not None:
            return Path(found.origin).parent / place
    raise FileError("there is no type to write with: matplotlib, which brings one, is missing")


@lru_cache(maxsize=1)
def enlargement() -> float:
    """Return what sizes are multiplied by, so that letters of any type are equally high.

    Examples
    --------
    >>> round(enlargement(), 2)
    1.13
    """
    em = 1000
    x = -ImageFont.truetype(font_file(), em).getbbox("x", anchor="ls")[1]
    return _X * em / float(x)


def svg(
    body: str, width: int, height: int, *, style: str, left: int = 0, scale: float = 1
) -> bytes:
    """Return a drawing of its own, in px: as an image it may ask for no file, and brings its type.

    Its words have the family ``cvnotes``; those of class ``s``, which are strong, have weight 600.

    Examples
    --------
    >>> svg("<text>±</text>", 90, 20, style="text{font:14px cvnotes}")[:50]
    b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0'
    """
    written = re.findall(r"<text([^>]*)>([^<]+)", body)
    faces = ""
    for weight, name in ((400, "Regular"), (600, "Semibold")):
        strong = weight == 600
        letters = {c for how, words in written if ('class="s"' in how) == strong for c in words}
        if letters:
            faces += (
                f"@font-face{{font-family:cvnotes;font-weight:{weight};"
                f"src:url(data:font/woff;base64,{_embedded(name, ''.join(sorted(letters)))})}}"
            )
    size = f'width="{round(scale * width)}" height="{round(scale * height)}"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{left} 0 {width} {height}" '
        f"{size}><style>{faces}{style}</style>{body}</svg>"
    ).encode()


@lru_cache(maxsize=32)
def _embedded(face: str, letters: str) -> str:
    """Return some letters of a face in base 64."""
    source = font_file().with_name(font_file().name.replace("Regular", face))
    cut = subset_of(source, letters, flavor="woff", hinting=False, drop_tables=_NOT_DRAWN)
    return base64.b64encode(cut).decode()


def subset_of(source: Path, letters: str, **how: Any) -> bytes:
    """Return a font with some letters alone, the same bytes each time; without its reserved name.

    The licence (SIL Open Font License 1.1) lets nobody call a changed version by that name.
    """
    from fontTools import subset

    logging.getLogger("fontTools").setLevel(logging.WARNING)
    kept = {"drop_tables": ["FFTM"], "name_IDs": [0, 13, 14]}
    options: Any = subset.Options(**(kept | how))
    font = subset.load_font(str(source), options)
    cutter: Any = subset.Subsetter(options)
    cutter.populate(text=letters)
    cutter.subset(font)
    font.recalcTimestamp = False
    cut = io.BytesIO()
    subset.save_font(font, cut, options)
    font.close()
    return cut.getvalue()
