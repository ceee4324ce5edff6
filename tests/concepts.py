"""The register: where each concept of the notes is a function, a place in a notebook and a test.

Rows 1 to 77 are what the notes contain, in their order; rows a to p are what they leave out but
need. The data are in ``concepts.toml`` beside this module.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from cvnotes.base import CvnotesError


@dataclass(frozen=True)
class Concept:
    """One row of the register.

    `notes` is the section, `functions` are dotted names, `cells` pairs of a notebook and a few
    words that stand in one of its cells only, and `tests` are names that pytest understands.
    """

    row: str
    what: str
    notes: str
    functions: tuple[str, ...]
    cells: tuple[tuple[str, str], ...]
    tests: tuple[str, ...]

    def __str__(self) -> str:
        """Return the row as text for a terminal."""
        lines = [f"{self.row}. {self.what} (notes {self.notes})"]
        lines += [f"   function  {name}" for name in self.functions]
        lines += [f"   notebook  {name}: {words}" for name, words in self.cells]
        return "\n".join(lines + [f"   test      {name}" for name in self.tests])


@cache
def concepts() -> Mapping[str, Concept]:
    """Return the whole register, rows by name, in the order of the notes.

    Examples
    --------
    >>> concepts()["8"].functions
    ('cvnotes.projective.from_homogeneous',)
    """
    table = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    return MappingProxyType({row: _concept(row, entry) for row, entry in table.items()})


def find(words: str) -> tuple[Concept, ...]:
    """Return the concepts whose description or functions contain all words, whatever their case.

    Examples
    --------
    >>> print(*(concept.what for concept in find("vanishing cosines")))
    Direction cosines; lines parallel to z vanish in the principal point
    """
    wanted = words.lower().split()
    if not wanted:
        raise CvnotesError("find what? Give at least one word, such as 'homography'")
    return tuple(
        concept
        for concept in concepts().values()
        if all(word in " ".join([concept.what, *concept.functions]).lower() for word in wanted)
    )


def _concept(row: str, entry: dict[str, Any]) -> Concept:
    return Concept(
        row=row,
        what=entry["what"],
        notes=entry["notes"],
        functions=tuple(entry["functions"]),
        cells=tuple((notebook, words) for notebook, words in entry["cells"]),
        tests=tuple(entry["tests"]),
    )
