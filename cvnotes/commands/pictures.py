"""The pictures that `cvnotes calibrate` leaves beside its numbers."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from cvnotes.base import Array, chunks
from cvnotes.base.digits import round_number
from cvnotes.base.text import shortened
from cvnotes.base.writing import printable
from cvnotes.calibration.coverage import covered_cells
from cvnotes.commands.canvas import (
    ESTIMATED,
    FAINT,
    INK,
    LENS,
    MUTED,
    PALE,
    WORLD,
    Canvas,
    ticks,
    wrapped,
)
from cvnotes.commands.console import progress

if TYPE_CHECKING:
    from cvnotes.calibration import Calibration, NextView
    from cvnotes.photographs import CalibratedPhotographs, Detection
    from cvnotes.photographs.detection import Board

_COLUMNS, _ROWS = 4, 10  # of a sheet
_TILE = 320  # px wide
_HEAD = 24  # px for a title
_LETTERS = 28  # of a name
_WIDE, _NARROWEST = 900, 480  # px, of a picture of its own
_BAR = 18  # px that a bar and its name need
_MOST_LINES = 1000  # that can be told apart


def pictures(found: "CalibratedPhotographs") -> dict[str, bytes]:
    """Draw all pictures of what came out; gives PNG by file name."""
    result, photographs = found.calibration, found.photographs
    drawn = {
        "view_rms.png": _view_rms(result, photographs.named()[0]),
        "coverage.png": _coverage(result),
        "residuals.png": _residuals(result),
        **corner_sheets(photographs.looked_at, photographs.board),
    }
    if found.next_view is not None:
        drawn["next_view.png"] = _next_view(result, found.next_view, photographs.board)
    sheets = progress(drawn.items(), total=len(drawn), unit="pictures")
    return {name: sheet.png() for name, sheet in sheets}


def corner_sheets(looked_at: "Sequence[Detection]", board: "Board") -> dict[str, Canvas]:
    """Draw all photographs small with the corners found in them, on as many sheets as it takes."""
    sheets = [looked_at[part] for part in chunks(len(looked_at), _COLUMNS * _ROWS)]
    if len(sheets) == 1:
        return {"corners.png": _sheet(sheets[0], board)}
    return {f"corners-{i}.png": _sheet(sheet, board) for i, sheet in enumerate(sheets, start=1)}


def _sheet(photographs: "Sequence[Detection]", board: "Board") -> Canvas:
    width, height = photographs[0].size
    tile = (_TILE, max(round(_TILE * height / width), 1))
    # Three tiles at least, so that a title has its place.
    columns = min(_COLUMNS, max(len(photographs), 3))
    rows = -(-len(photographs) // columns)
    sheet = Canvas(columns * (_TILE + 4), rows * (tile[1] + _HEAD))
    for k, photo in enumerate(photographs):
        x, y = k % columns * (_TILE + 4) + 2, k // columns * (tile[1] + _HEAD) + _HEAD
        sheet.photograph(photo.thumbnail, (x, y), tile)
        zoom, name = _TILE / photo.size[0], shortened(printable(photo.path.name), _LETTERS)
        place = np.array([x, y])
        if photo.corners is not None:
            columns_rows = (*board.corners[::-1], 2)
            _draw_lattice(sheet, ((photo.corners + 0.5) * zoom + place).reshape(columns_rows))
        elif photo.found is not None:
            sheet.dots((photo.found + 0.5) * zoom + place, LENS, 2.5)
        title = name if photo.corners is not None else f"{name}: not used"
        colour = MUTED if photo.corners is not None else ESTIMATED
        sheet.text((x + _TILE / 2, y - 7), title, colour, size=12)
    return sheet


def _draw_lattice(sheet: Canvas, lattice: Array) -> None:
    """Join each row; the ring is the origin, the thick lines lead along x and y."""
    for row in lattice:
        sheet.line(row, ESTIMATED)
    sheet.dots(lattice, ESTIMATED, 1.5)
    for axis, name in ((lattice[0, :3], "x"), (lattice[:3, 0], "y")):
        if np.isfinite(axis).all():
            sheet.line(axis, WORLD, 2)
            end = axis[-1] + 0.4 * (axis[-1] - axis[-2])
            sheet.text((float(end[0]), float(end[1])), name, WORLD, anchor="mm", halo=True)
    if np.isfinite(lattice[0, 0]).all():
        sheet.ring(lattice[0, 0], 5, WORLD)


def _view_rms(result: "Calibration", names: Sequence[str]) -> Canvas:
    """Draw the RMS of each view as a bar, beside that of all."""
    names = [shortened(name, _LETTERS) for name in names]
    # Where a lens folds there is no residual, and no bar.
    rms, all_rms = np.nan_to_num(result.view_rms), float(np.nan_to_num(result.rms))
    height = 420
    wide = min(max(_WIDE, 150 + _BAR * len(rms)), 4 * _WIDE)
    step = -(-_BAR * len(rms) // (wide - 150))  # every name, as long as they are legible
    longest = max(map(len, names))
    # A digit or a letter of this size is about 6 px wide.
    flat = 6.5 * longest < step * (wide - 150) / len(rms)
    left, right, top = 62, wide - 88, 18
    bottom = height - (40 if flat else min(24 + 7 * longest, 200))
    high = 1.05 * max(float(rms.max()), all_rms, 1e-12)
    sheet, across, up = Canvas(wide, height), (right - left) / len(rms), (bottom - top) / high
    for tick in ticks(0, high):
        y = bottom - tick * up
        sheet.line([(left, y), (right, y)], FAINT)
        sheet.text((left - 6, y), f"{tick:.4g}", MUTED, anchor="rm", size=12)
    for i, value in enumerate(rms.tolist()):
        x = left + (i + 0.5) * across
        sheet.rectangle(
            (x - 0.35 * across, bottom - value * up), (x + 0.35 * across, bottom), fill=ESTIMATED
        )
        if i % step == 0 and flat:
            sheet.text((x, bottom + 16), names[i], size=12)
        elif i % step == 0:
            sheet.upright((x, bottom + 5), names[i], size=11)
    y = bottom - all_rms * up
    sheet.line([(left, y), (right, y)], INK)
    sheet.text((right + 5, y), f"all: {result.rms:.3f}", MUTED, anchor="lm")
    sheet.text((left - 52, top - 5), "RMS (px per point)", anchor="ls", size=12)
    return sheet


def _coverage(result: "Calibration") -> Canvas:
    """Draw where corners were seen: the lens is known there, and guessed in grey cells."""
    cells = covered_cells(result.image_points, result.size)
    drawn = _picture(result.size, f"Corners in {cells.sum()} of {cells.size} cells of the picture")
    side = drawn.zoom * np.array(result.size) / cells.shape
    for cell in np.argwhere(~cells):
        low = cell * side + drawn.corner
        drawn.sheet.rectangle(low, low + side, fill=FAINT, line=PALE)
    drawn.sheet.dots(drawn.place(np.concatenate(result.image_points)), ESTIMATED, 1.7)
    drawn.frame()
    return drawn.sheet


def _next_view(result: "Calibration", proposal: "NextView", board: "Board") -> Canvas:
    """Draw the board as it should be seen next, over all corners that were seen so far."""
    drawn = _picture(result.size, f"Next: {proposal.words}")
    sheet, place = drawn.sheet, drawn.place
    sheet.dots(place(np.concatenate(result.image_points)), MUTED, 1.2)
    sheet.line(place(np.concatenate([proposal.outline, proposal.outline[:1]])), LENS, 3)
    m = result.camera.moved(proposal.G).project(board.points)
    _draw_lattice(sheet, place(m).reshape(*board.corners[::-1], 2))
    drawn.frame()
    return sheet


_EDGE = 6  # px around a picture
_TITLE = 14  # size of a title's letters, px
_LINE = 20  # px from one line of a title to the next


class _Picture(NamedTuple):
    """A sheet with a frame for what is drawn on a picture."""

    sheet: Canvas
    zoom: float  # px per pixel of the picture
    corner: Array  # where the picture's upper left corner is
    size: Array  # of the frame

    def place(self, m: Array) -> Array:
        """Return where pixels (n, 2) of the picture are on the sheet."""
        return np.asarray((m + 0.5) * self.zoom + self.corner)

    def frame(self) -> None:
        self.sheet.rectangle(self.corner, self.corner + self.size, line=MUTED)


def _picture(size: tuple[int, int], title: str, *, beside: int = 0, tall: int = 0) -> _Picture:
    """Return a sheet for something drawn on a picture, with so much room beside it, so tall."""
    zoom = min((_WIDE - 2 * _EDGE) / size[0], 900 / size[1])
    frame = zoom * np.array(size)
    width = max(round(frame[0]) + 2 * _EDGE, _NARROWEST)
    lines = wrapped(title, width - 2 * _EDGE, _TITLE)
    corner = np.array([(width - frame[0]) / 2, _HEAD + _LINE * (len(lines) - 1) + _EDGE])
    height = max(round(corner[1] + frame[1]) + _EDGE, tall)
    sheet = Canvas(width + beside, height)
    for i, line in enumerate(lines):
        sheet.text((width / 2, _HEAD - 6 + _LINE * i), line, size=_TITLE)
    return _Picture(sheet, zoom, corner, frame)


def _residuals(result: "Calibration") -> Canvas:
    """Draw each residual where it is, magnified, and all of them around 0.

    Lines that point all over the place are noise; lines that agree with their neighbours are
    something that the model does not describe. Noise gives a round cloud.
    """
    m, r = np.concatenate(result.image_points), np.concatenate(result.residuals)
    known = np.isfinite(r).all(-1)
    m, r = m[known], r[known]
    places, mean, word = m - r, r, "Residuals"
    if len(r) > _MOST_LINES:  # of so many, what they have in common in a place is to be seen
        places, mean = _cell_means(places, r, result.size)
        word = "Mean residuals of places"
    longer = float(np.percentile(np.hypot(*mean.T), 95)) if len(mean) else 0.0
    magnify = round_number(0.04 * result.size[0] / longer) if longer > 0 else 1.0
    title = f"{word}, {magnify:,g} times as long (RMS {result.rms:.3f} px per point)"
    drawn = _picture(result.size, title, beside=_CLOUD, tall=_CLOUD + _HEAD)
    start = drawn.place(places)
    end = start + drawn.zoom * magnify * mean
    drawn.sheet.segments(start, end, ESTIMATED)
    drawn.sheet.dots(end, ESTIMATED, 1.5)
    drawn.frame()
    _cloud(drawn, r, result.rms / np.sqrt(2))
    return drawn.sheet


def _cell_means(m: Array, r: Array, size: tuple[int, int]) -> tuple[Array, Array]:
    """Average positions and residuals over the cells of a grid, 32 across; without empty cells."""
    side = size[0] / 32
    cell = np.floor((m + 0.5) / side).astype(int)
    _, index, count = np.unique(cell, axis=0, return_inverse=True, return_counts=True)
    sums = np.zeros((2, len(count), 2))
    np.add.at(sums[0], index.ravel(), m)
    np.add.at(sums[1], index.ravel(), r)
    places, mean = sums / count[:, None]
    return places, mean


_CLOUD = 420  # px wide


def _cloud(drawn: _Picture, r: Array, sigma: float) -> None:
    """Draw residuals around 0 beside a picture, with a circle of one standard deviation."""
    reach = 1.08 * max(float(np.abs(r).max(initial=0.0)), 1e-9)
    sheet, half = drawn.sheet, 170
    middle = drawn.corner + [drawn.size[0] + _CLOUD / 2 + 15, half]
    sheet.rectangle(middle - half, middle + half, line=MUTED)
    for tick in ticks(-reach, reach, 5):
        x, y = middle + tick / reach * half
        sheet.line([(x, middle[1] - half), (x, middle[1] + half)], FAINT)
        sheet.line([(middle[0] - half, y), (middle[0] + half, y)], FAINT)
        sheet.text((x, middle[1] + half + 15), f"{tick:.3g}", MUTED, size=11)
        sheet.text((middle[0] - half - 4, y), f"{tick:.3g}", MUTED, size=11, anchor="rm")
    sheet.dots(middle + r / reach * half, ESTIMATED, 1.5)
    if np.isfinite(sigma):
        sheet.ring(middle, sigma / reach * half, INK)
    x, y = (float(at) for at in middle)
    sheet.text((x, y + half + 36), "observed - predicted (px)", size=12)
    sheet.text((x, y + half + 53), f"circle: one standard deviation, {sigma:.3f} px", size=12)
