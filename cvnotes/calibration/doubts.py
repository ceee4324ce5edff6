"""Sentences about what is doubtful, that know which views and corners they are about."""

from collections.abc import Callable
from typing import NamedTuple

_LISTED = 20  # views that a sentence lists: who is to leave them out needs all of their names


class Views(NamedTuple):
    """Views, counted from 0."""

    indices: tuple[int, ...]

    def listed(self, name: Callable[[int], str] = str, most: int = _LISTED) -> str:
        """Return their names, or those of the first of many."""
        return ", ".join(map(name, self.indices[:most])) + " …" * (len(self.indices) > most)

    def __str__(self) -> str:
        return f"views {self.listed()}"


class View(NamedTuple):
    """One view, counted from 0."""

    number: int

    def __str__(self) -> str:
        return f"view {self.number}"


class Corner(NamedTuple):
    """One corner of a view, both counted from 0."""

    view: int
    corner: int

    def __str__(self) -> str:
        return f"view {self.view}, corner {self.corner}"


Place = Views | View | Corner


class Doubt(str):
    """A sentence about what is doubtful.

    Views and corners are counted in it, as a program counts them; `naming` calls them otherwise.

    Parameters
    ----------
    sentence : str
        With ``{}`` for each place.
    places : Views, View or Corner
        What it is about.

    Examples
    --------
    >>> doubt = Doubt("{} does not fit", View(3))
    >>> doubt
    'view 3 does not fit'
    >>> doubt.naming(lambda place: f"photograph {place.number + 1}")
    'photograph 4 does not fit'
    """

    __slots__ = ("places", "sentence")
    sentence: str
    places: tuple[Place, ...]

    def __new__(cls, sentence: str, *places: Place) -> "Doubt":
        """Make the sentence, with places counted from 0."""
        doubt = super().__new__(cls, sentence.format(*places) if places else sentence)
        doubt.sentence, doubt.places = sentence, places
        return doubt

    def naming(self, name: Callable[[Place], str]) -> str:
        """Return the sentence with other names for its places."""
        return self.sentence.format(*map(name, self.places)) if self.places else self.sentence

    def __reduce__(self) -> tuple[type["Doubt"], tuple[str | Place, ...]]:
        """Return what a copy in another process is made of."""
        return Doubt, (self.sentence, *self.places)
