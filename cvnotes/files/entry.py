"""Values of a file that still know where they stand."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np

from cvnotes.base import Array, FileError
from cvnotes.base.text import clipped


@dataclass(frozen=True)
class Entry:
    """A value of a file together with where it stands, so that errors can say it.

    Examples
    --------
    >>> Entry({"rms": 0.25}, "a.json")["rms"].number()
    0.25
    """

    value: Any
    file: str
    key: str = ""

    def error(self, what: str) -> FileError:
        """Make the error that names file and key."""
        return FileError(f"{self.file}: {self.key or 'the file'}: {what}")

    def __getitem__(self, name: str) -> "Entry":
        """Go to a key that must be there."""
        entry = self.get(name)
        if entry is None:
            raise self.error(f"the key {name!r} is missing")
        return entry

    def get(self, name: str) -> "Entry | None":
        """Go to a key that may be missing."""
        if not isinstance(self.value, dict):
            raise self.error(f"expected keys and values, got {_kind(self.value)}")
        if name not in self.value:
            return None
        return Entry(self.value[name], self.file, f"{self.key}.{name}" if self.key else name)

    def __iter__(self) -> Iterator["Entry"]:
        if not isinstance(self.value, list):
            raise self.error(f"expected a list, got {_kind(self.value)}")
        for i, item in enumerate(self.value):
            yield Entry(item, self.file, f"{self.key}[{i}]")

    def items(self) -> dict[str, "Entry"]:
        """Return the entries of a mapping by name."""
        if not isinstance(self.value, dict):
            raise self.error(f"expected keys and values, got {_kind(self.value)}")
        return {name: self[name] for name in self.value}

    def number(self) -> float:
        """Return a finite number."""
        if isinstance(self.value, bool) or not isinstance(self.value, int | float):
            raise self.error(f"expected a number, got {_kind(self.value)}")
        number = float(self.value)
        if not math.isfinite(number):
            raise self.error(f"expected a finite number, got {number}")
        return number

    def whole(self) -> int:
        """Return a whole number."""
        number = self.number()
        if number != int(number):
            raise self.error(f"expected a whole number, got {number:g}")
        return int(number)

    def text(self) -> str:
        """Return a text."""
        if not isinstance(self.value, str):
            raise self.error(f"expected a text, got {_kind(self.value)}")
        return self.value

    def flag(self) -> bool:
        """Return true or false."""
        if not isinstance(self.value, bool):
            raise self.error(f"expected true or false, got {_kind(self.value)}")
        return self.value

    def array(self, *shape: int | None) -> Array:
        """Return nested lists of numbers as an array; None stands for any length.

        Examples
        --------
        >>> Entry({"k": [-0.25, 0.1]}, "a.json")["k"].array(None)
        array([-0.25,  0.1 ])
        """
        if not shape:
            return np.array(self.number())
        if (plain := _plain(self.value, shape)) is not None:
            return plain
        items = list(self)
        if shape[0] not in (None, len(items)):
            raise self.error(f"expected {shape[0]} values, got {len(items)}")
        if not items:
            return np.zeros([n or 0 for n in shape])
        return np.array([item.array(*shape[1:]) for item in items])


def _plain(value: Any, shape: tuple[int | None, ...]) -> Array | None:
    """Return the array if that is how it is: only who finds fault has to know every entry's key."""
    found: list[int] = []
    level = [value]
    for n in shape:
        if not all(type(x) is list for x in level) or len(lengths := {*map(len, level)}) != 1:
            return None
        found += lengths
        if n not in (None, found[-1]):
            return None
        level = list(chain.from_iterable(level))
    if {*map(type, level)} != {float} or not all(map(math.isfinite, level)):
        return None
    return np.array(level).reshape(found)


def _kind(value: Any) -> str:
    names = {dict: "keys and values", list: "a list", bool: "true or false", type(None): "nothing"}
    return names.get(type(value), clipped(repr(value), 40))
