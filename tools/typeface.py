"""The site's type: Source Serif for what is read, Source Sans for what labels; as small as it goes.

Both come from packages of the extra `docs`. What is written here is a modified version, which their
licence (SIL Open Font License 1.1) lets nobody call by the reserved name: the name is left out, and
the pages call them "cvnotes serif" and "cvnotes sans" (`docs/site.css`).
"""

from importlib.resources import as_file, files
from pathlib import Path

from cvnotes.show.typeface import subset_of

FACES = "Regular", "It", "Semibold"  # for text, for emphasis, for headings and strong words
FAMILIES = {
    "serif": ("font_source_serif_pro", "SourceSerifPro"),
    "sans": ("font_source_sans_pro", "SourceSansPro"),
}
_KEPT = ["kern", "liga", "tnum"]
LETTERS = "".join(map(chr, (*range(0x20, 0x180), *range(0x370, 0x400), *range(0x2000, 0x2300))))


def write_typefaces(folder: Path) -> None:
    """Write the faces of both families into a folder, and their licence beside them."""
    folder.mkdir(parents=True, exist_ok=True)
    for family, (package, stem) in FAMILIES.items():
        given = files(package) / "files"
        (folder / f"{family}-LICENSE.txt").write_bytes((given / "LICENSE.txt").read_bytes())
        for face in FACES:
            target = folder / f"{family}-{face}.woff"
            with as_file(given / f"{stem}-{face}.ttf") as source:
                target.write_bytes(subset_of(source, LETTERS, flavor="woff", layout_features=_KEPT))
