"""What an exploration is: settings, and a pure function from their values to a picture."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError
from cvnotes.show.explorations.lettering import with_minus
from cvnotes.show.explorations.paper import Drawn, Grip, Paper
from cvnotes.show.picture import Picture, packed
from cvnotes.show.style import ESTIMATED

Values = Mapping[str, float]
_PULL = 40  # px of the page: so far that every slider takes a step


class Setting(NamedTuple):
    """A number that can be moved.

    Attributes
    ----------
    name : str
        The keyword of the model's ``picture``.
    label : str
        What stands beside the slider, with the unit.
    low, high, step, value : float
        Range, step and start.
    help : str
        What it means, for the tooltip.
    tint : str
        Colour behind its label, where matrices show what it moves on the same one.
    names : tuple of str
        What its values are called, from `low` on: a list to choose from and no slider.
    """

    name: str
    label: str
    low: float
    high: float
    step: float
    value: float
    help: str
    tint: str = ""
    names: tuple[str, ...] = ()

    @property
    def is_choice(self) -> bool:
        """Whether this is yes or no, 1 or 0: a switch and no slider."""
        return (self.low, self.high, self.step) == (0, 1, 1)


class Drawing(NamedTuple):
    """What a model shows for one set of values.

    Attributes
    ----------
    picture : ndarray
        (height, width, 3) of uint8.
    sentence : str
        Its numbers, in words.
    matrices : str
        Matrices that stand beside it, as HTML; empty if there are none.
    grips : tuple of Grip
        Where a hand can take hold of the picture.
    """

    picture: Drawn
    sentence: str
    matrices: str = ""
    grips: tuple[Grip, ...] = ()

    def as_data(self) -> dict[str, Any]:
        """Return all but the pixels, as a page is told it."""
        height, width = self.picture.shape[:2]
        return {
            "size": [width, height],
            "sentence": self.sentence,
            "matrices": self.matrices,
            "grips": [grip._asdict() for grip in self.grips],
        }


Drag = Callable[[Values, Array], Values]


def placed(x: str, y: str = "", start: npt.ArrayLike = (0, 0)) -> Drag:
    """Return what a hand does whose place says two settings, or one of them is "" and stays.

    They are counted from where both are 0.
    """
    return lambda _, at: {
        name: far for name, far in zip((x, y), np.subtract(at, start), strict=True) if name
    }


def nearest(name: str, tried: npt.NDArray[Any], places: Callable[[Values, Any], Array]) -> Drag:
    """Return what a hand does that pulls a point along its way: the value whose place is nearest.

    For each value that is tried there is a place, (n, 2).
    """

    def pulled(values: Values, at: Array) -> Values:
        return {name: tried[np.linalg.norm(places(values, tried) - at, axis=1).argmin()]}

    return pulled


@dataclass(frozen=True)
class Model:
    """An exploration without its sliders: values go in, a picture and a sentence come out.

    Parameters
    ----------
    name : str
        As in ``model(name)``.
    about : str
        What the picture shows, in a sentence or a paragraph, whose lines are joined; the beginning
        of its alternative text.
    settings : tuple of Setting
        What can be moved.
    draw : callable
        (paper, values) → `Drawing`.
    drags : mapping
        What a hand that takes hold of the picture changes, by the name of the grip: (values, where
        it is pulled to, in its panel's coordinates) → changed values. `placed` and `nearest` make
        the usual ones.

    Examples
    --------
    >>> def draw(paper, values):
    ...     panel = paper.panel((200, 100), (0, 1), (0, 1))
    ...     return Drawing(paper.join((panel,)), f"x is {values['x']:g}.")
    >>> model = Model("empty", "A frame.", (Setting("x", "x", 0, 1, 0.1, 0.5, "a number"),), draw)
    >>> model.drawing(x=0.3).sentence
    'x is 0.3.'
    >>> model.picture().dtype
    dtype('uint8')
    """

    name: str
    about: str
    settings: tuple[Setting, ...]
    draw: Callable[[Paper, Values], Drawing]
    drags: Mapping[str, Drag] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "about", _in_one_line(self.about))

    def values(self, **given: float) -> dict[str, float]:
        """Fill up given values with the starting ones; refuse what no slider could say."""
        values = {setting.name: setting.value for setting in self.settings}
        for name, value in given.items():
            if name not in values:
                raise CvnotesError(f"{self.name}: {name!r} is none of {', '.join(values)}")
            values[name] = value
        for s in self.settings:
            if not s.low <= values[s.name] <= s.high:
                ends = f"expected a number from {s.low:g} to {s.high:g}"
                raise CvnotesError(f"{s.name}: {ends}, got {values[s.name]!r}")
        return values

    def starting(self, **values: float) -> "Model":
        """Return the same model with other values at the start."""
        start = self.values(**values)
        moved = tuple(s._replace(value=start[s.name]) for s in self.settings)
        return replace(self, settings=moved)

    def drawing(self, **values: float) -> Drawing:
        """Return picture and sentence; where there is no answer, the sentence says why."""
        return self.drawn_on(Paper(), self.values(**values))

    def drawn_on(self, paper: Paper, values: Values) -> Drawing:
        """Draw all values on some paper: sharper than usual, or narrow."""
        try:
            drawing = self.draw(paper, values)
            sentence = with_minus(_in_one_line(drawing.sentence))
            return drawing._replace(sentence=sentence, grips=paper.grips)
        except CvnotesError as reason:
            panel = paper.panel((660, 120), (0, 1), (0, 1))
            panel.text([0.5, 0.5], "no answer for these values", ESTIMATED, anchor="mm", size=14)
            return Drawing(paper.join((panel,)), f"No answer: {reason}.")

    def picture(self, **values: float) -> Drawn:
        """Return the picture alone, (height, width, 3) of uint8."""
        return self.drawing(**values).picture

    def dragged(self, name: str, at: tuple[float, float], **values: float) -> dict[str, float]:
        """Return the values after a grip was pulled to a place in the coordinates of its panel.

        They are such as sliders can show: in steps, and no farther than these go.

        Examples
        --------
        >>> from cvnotes.show.explorations import model
        >>> model("parallel").dragged("vanishing point", (325, 200))["slope"]
        2.5
        """
        values = self.values(**values)
        if name not in self.drags:
            raise CvnotesError(f"{self.name}: {name!r} is none of {', '.join(self.drags)}")
        if not np.isfinite(at).all():
            raise CvnotesError(f"at: expected two finite numbers, got {at}")
        pulled = self.drags[name](values, np.array(at, dtype=np.float64))
        moved = values | {name: float(value) for name, value in pulled.items()}
        for s in self.settings:
            if moved[s.name] != values[s.name]:
                steps = round((moved[s.name] - s.low) / s.step)
                moved[s.name] = min(max(round(s.low + steps * s.step, 9) + 0.0, s.low), s.high)
        return moved

    def folded(self, **values: float) -> tuple[str, ...]:
        """Name the settings whose sliders are folded below the picture.

        Where a hand can pull all that sliders set, they say it once more, and many of them push
        the text away from the picture. A switch or a list stays: no hand can pull it. So do one or
        two sliders, which take no more room than what would open them, and sliders whose colours
        say what the entries of a matrix are.

        Examples
        --------
        >>> from cvnotes.show.explorations import model
        >>> model("walks").folded(), model("lens").folded()
        (('X', 'Z', 'turn'), ())
        """
        values = self.values(**values)
        sliders = tuple(s.name for s in self.settings if not (s.is_choice or s.names))
        if len(sliders) <= 2 or any(s.tint for s in self.settings):
            return ()
        by_hand = set()
        for grip in self.drawing(**values).grips:
            for way in (-_PULL, 0), (_PULL, 0), (0, -_PULL), (0, _PULL):
                at = tuple(np.array(grip.at) + np.array(way) * grip.unit)
                pulled = self.dragged(grip.name, at, **values)
                by_hand |= {name for name in sliders if pulled[name] != values[name]}
        return sliders if len(by_hand) == len(sliders) else ()

    def still(self, **values: float) -> Picture:
        """Return the picture for a page: at twice the resolution, with its alternative text."""
        drawing = self.drawn_on(Paper(2), self.values(**values))
        alt = f"{self.about} {drawing.sentence}"
        data, mime = packed(drawing.picture, level=9)
        return Picture(data, alt, drawing.picture.shape[1] // 2, mime)


def _in_one_line(paragraph: str) -> str:
    """Return words as they are told, which the code may have broken into lines."""
    return " ".join(paragraph.split())
