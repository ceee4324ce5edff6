"""A picture whose points are pulled by hand, and what a function of the reader's says of them."""

from collections.abc import Callable, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from PIL import Image

from cvnotes.base import Array, CvnotesError, points
from cvnotes.base.writing import PathLike
from cvnotes.files import read_photo
from cvnotes.show.explorations.model import Drag, Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper, circle
from cvnotes.show.guards import in_bytes
from cvnotes.show.guards import picture as checked
from cvnotes.show.style import ESTIMATED

# What is said of a picture and its points: a sentence, lines, and perhaps another picture.
Tell = Callable[[npt.NDArray[Any], Array], tuple[Any, ...]]

_ALONE, _LOUPE = (600, 440), 230  # px: the picture, and the width of the loupe beside it
_BESIDE, _OTHER, _LOWEST = (440, 340), (324, 210), 100  # px: with another picture over the loupe
_STEP = 0.5  # px
_MOST = 12  # points
_LARGE = 1600  # px, the longer side of a photograph of the reader's own


def hand_model(picture: npt.ArrayLike | PathLike, at: npt.ArrayLike, tell: Tell) -> Model:
    """Make the model of points on a picture, as `pull_points` describes them."""
    at = points(at, "at", 2).reshape(-1, 2)
    if isinstance(picture, str | Path):
        picture = _smaller(read_photo(picture).image)
        at = _around(picture.shape[1::-1], len(at))
    return _model(checked(picture, "picture"), at, tell)


def _smaller(photo: Drawn) -> Drawn:
    """Shrink a photograph by a whole number until a function that warps it follows the hand."""
    times = -(-max(photo.shape[:2]) // _LARGE)
    return np.asarray(Image.fromarray(photo).reduce(times))


def _around(size: Sequence[int], n: int) -> Array:
    """Lay n points around the middle of a picture of (width, height), clockwise."""
    turn = -3 * np.pi / 4 + 2 * np.pi * np.arange(n) / n
    place = np.array(size) * (0.5 + 0.35 * np.stack([np.cos(turn), np.sin(turn)], axis=1))
    return np.round(place)


def points_of(values: Values) -> Array:
    """Return where the points are, (n, 2)."""
    n = (len(values) - 1) // 2
    return np.array([[values[f"u{i}"], values[f"v{i}"]] for i in range(1, n + 1)])


def _model(picture: npt.NDArray[Any], at: Array, tell: Tell) -> Model:
    """Make the model; what cannot be told of the first points is an error at once."""
    photo = in_bytes(picture, "picture")
    h, w = photo.shape[:2]
    if not 1 <= len(at) <= _MOST:
        raise CvnotesError(f"at: expected 1 to {_MOST} points, got {len(at)}")
    if not ((at >= 0) & (at <= [w - 1, h - 1])).all():
        raise CvnotesError(f"at: expected points within the picture of {w} × {h} px")
    _told(tell, picture, at)
    settings = [Setting("point", "point", 1, len(at), 1, 1, "which point the loupe shows")]
    for i, place in enumerate(at.tolist(), 1):
        for name, most, start in zip("uv", (w - 1, h - 1), place, strict=True):
            meaning = f"{name} of point {i}, in px"
            settings.append(Setting(f"{name}{i}", f"{name}{i}", 0, most, _STEP, start, meaning))

    @lru_cache(maxsize=4)
    def fitted(width: int, height: int) -> Drawn:
        """Keep the photograph as large as its panel: it is the same wherever the points are."""
        return np.asarray(Image.fromarray(photo).resize((width, height), reducing_gap=2.0))

    def draw(paper: Paper, values: Values) -> Drawing:
        m, now = points_of(values), int(values["point"])
        told = _told_or_why(tell, picture, m)
        size = _fit((w, h), _ALONE if told.other is None else _BESIDE)
        panel = paper.picture_panel(size, (w, h), "pull the points")
        panel.image(fitted(paper.sharpness * size[0], paper.sharpness * size[1]))
        _draw_points(panel, m, told.lines)
        if told.other is None:
            column = [_loupe(paper, (_LOUPE, size[1]), photo, m, told.lines, now)]
        else:
            over = _beside(paper, told.other, told.its_lines)
            below = max(size[1] - over.sheet[1] // paper.sharpness, _LOWEST)
            loupe = (over.width // over.scale, below)
            column = [over, _loupe(paper, loupe, photo, m, told.lines, now)]
        return Drawing(paper.join((panel, column)), told.words)

    def pulled(i: int, at: Array) -> Values:
        return {"point": i, f"u{i}": float(at[0]), f"v{i}": float(at[1])}

    def pull_of(i: int) -> Drag:
        return lambda _, at: pulled(i, at)

    drags = {f"point {i}": pull_of(i) for i in range(1, len(at) + 1)}
    drags["loupe"] = lambda values, at: pulled(int(values["point"]), at)
    about = f"A picture with {len(at)} points to be pulled, a loupe over one of them, and lines."
    return Model("pull_points", about, tuple(settings), draw, drags)


class _Told(NamedTuple):
    """What the reader's function says: a sentence, lines, and perhaps a picture with lines."""

    words: str
    lines: list[Array]
    other: Drawn | None = None
    its_lines: Sequence[Array] = ()


def _told(tell: Tell, picture: npt.NDArray[Any], m: Array) -> _Told:
    """Ask what the points mean, and look whether the answer is of the right kind."""
    with np.errstate(divide="ignore", invalid="ignore"):  # a hand may pull anywhere
        answer = tell(picture, m.copy())
    match answer:
        case (str(words), lines):
            return _Told(words, _lines(lines))
        case (str(words), lines, beside, *more) if len(more) < 2:
            other = in_bytes(beside, "the picture that tell returns")
            return _Told(words, _lines(lines), other, [at for its in more for at in _lines(its)])
    raise CvnotesError(
        "tell: expected a function that returns a sentence, a list of lines and, if it likes, a "
        f"picture and lines upon it; got {type(answer).__name__}"
    )


def _lines(given: Any) -> list[Array]:
    lines = [np.asarray(line, dtype=np.float64) for line in given]
    if any(line.ndim != 2 or line.shape[1] != 2 for line in lines):
        shapes = ", ".join(str(line.shape) for line in lines)
        raise CvnotesError(f"tell: expected lines of shape (k, 2), got {shapes}")
    return lines


def _told_or_why(tell: Tell, picture: npt.NDArray[Any], m: Array) -> _Told:
    """Ask again; where the reader's function stops, its error is the sentence."""
    try:
        return _told(tell, picture, m)
    except Exception as reason:
        return _Told(f"No answer for these points: {type(reason).__name__}: {reason}", [])


def _fit(size: Sequence[int], room: tuple[int, int]) -> tuple[int, int]:
    scale = min(room[0] / size[0], room[1] / size[1])
    return max(round(scale * size[0]), 1), max(round(scale * size[1]), 1)


def _draw_points(panel: Panel, m: Array, lines: list[Array]) -> None:
    for line in lines:
        panel.line(line, ESTIMATED, 2)
    panel.mark(m, "estimated", 5)
    middle, marked = m.mean(axis=0), [*lines, *np.stack([m, m], axis=1)]
    for i, place in enumerate(m, 1):
        panel.grip(f"point {i}", f"point {i}", place, _STEP / panel.pixel)
        if len(m) > 1:
            inside = np.array([panel.x, panel.y]).T + 10 * panel.pixel * np.array([[1], [-1]])
            ring = np.clip(place + 22 * panel.pixel * circle(25), *inside)
            at = _clearest(ring, place - middle, marked, panel.pixel)
            panel.text(at, f"{i}", ESTIMATED, anchor="mm", size=14)


def _clearest(places: Array, away: Array, marked: list[Array], pixel: float) -> Array:
    """Choose a place for a word that is clear of lines and points, the outermost of such."""
    ends = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in marked])
    ends = ends[np.isfinite(ends).all(axis=(1, 2))]
    start, way = ends[:, 0], ends[:, 1] - ends[:, 0]
    part = ((places[:, None] - start) * way).sum(axis=2) / (way**2).sum(axis=1).clip(1e-12)
    feet = start + part.clip(0, 1)[..., None] * way
    off = np.linalg.norm(places[:, None] - feet, axis=2).min(axis=1)
    outside = places @ away / max(float(np.linalg.norm(away)), 1e-9)
    return np.asarray(places[np.argmax(off.clip(max=16 * pixel) + 0.1 * outside)])


def _beside(paper: Paper, other: Drawn, lines: Sequence[Array]) -> Panel:
    """Draw the picture that the reader's function returns, and its lines."""
    size = (other.shape[1], other.shape[0])
    panel = paper.picture_panel(_fit(size, _OTHER), size, "what the function returns")
    panel.image(other)
    for line in lines:
        panel.line(line, ESTIMATED, 1.5)
    return panel


def _loupe(
    paper: Paper, size: tuple[int, int], photo: Drawn, m: Array, lines: list[Array], now: int
) -> Panel:
    """Draw the pixels around a point, enlarged; beyond the picture is white."""
    # As many whole pixels as make them square, but for a few per cent.
    short = max(min(10, round(21 * min(size) / max(size))), photo.shape[1] // 160)
    long = round((short + 0.5) * max(size) / min(size) - 0.5)
    reach, tall = (short, long) if size[0] < size[1] else (long, short)
    left, top = np.rint(m[now - 1]).astype(int) - [reach, tall]
    wide, high = 2 * reach + 1, 2 * tall + 1
    sheet = np.full((high, wide, *photo.shape[2:]), 255, np.uint8)
    seen = photo[max(top, 0) : top + high, max(left, 0) : left + wide]
    sheet[max(-top, 0) :, max(-left, 0) :][: seen.shape[0], : seen.shape[1]] = seen
    panel = paper.picture_panel(size, (wide, high), f"point {now}, enlarged", (left, top))
    panel.image(sheet, smooth=False)
    for line in lines:
        panel.line(line, ESTIMATED, 1)
    panel.grip("loupe", f"point {now}, finely", m[now - 1], _STEP / panel.pixel, "ideal", 9)
    return panel
