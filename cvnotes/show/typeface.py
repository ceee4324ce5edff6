"""The type of pictures: Source Sans, that of the pages, so that a figure belongs to its page."""

import os
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

from PIL import ImageFont

from cvnotes.base import FileError

_PLACES = (
    ("font_source_sans_pro", "files/SourceSansPro-Regular.ttf"),
    ("matplotlib", "mpl-data/fonts/ttf/DejaVuSans.ttf"),  # where the first cannot be installed
)
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
