"""The pictures of a calibration, for its report."""

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from numpy.lib.stride_tricks import sliding_window_view

from cvnotes.base import Array
from cvnotes.base.digits import round_number
from cvnotes.base.writing import printable
from cvnotes.calibration import prediction_std
from cvnotes.camera import Camera, intrinsics, look_at, move
from cvnotes.commands.drawing import ESTIMATED, INK, LENS, WORLD, Drawing

if TYPE_CHECKING:
    from cvnotes.calibration import Calibration, NextView
    from cvnotes.photographs import Detection
    from cvnotes.photographs.detection import Board

_WIDE = 720  # of a drawing, in its own unit
_ACROSS = 33  # places at which the deviation is computed
_BANDS = ["#fff7e0", "#fee6ad", "#fdc876", "#fb9d4f", "#ee6a3c", "#cc3727", "#8e1420"]
_UNKNOWN = "#9a9a9a"
_LEAST = 1e-6  # px: what is known better is rounding
_MOST_LINES = 1000  # that can be told apart
_BELOW = 48  # for a scale bar, and its length
_ROOM = 16  # around what is drawn
_NUMBER = 28  # between numbers, which a telephone shows larger
_FROM = (0.75, -0.5, -0.45)  # where the boards in space are looked at from, in the CRF


def uncertainty(
    result: "Calibration", proposal: "NextView | None" = None
) -> tuple[Drawing, dict[str, str]]:
    """Draw how far off a pixel may be, 1 σ, the corners that were seen, and the next view.

    Also gives what its colours mean.
    """
    from PIL import Image

    sheet, zoom = _picture(result, "How far off a pixel may be, in each part of the picture")
    size, middle = (round(zoom * result.size[0]), round(zoom * result.size[1])), []
    for side in result.size:
        n = max(round(_ACROSS * side / max(result.size)), 2)
        middle.append((np.arange(n) + 0.5) * side / n - 0.5)
    m = np.stack(np.meshgrid(*middle), axis=-1)
    std = prediction_std(result, m, of="views", turning=True)
    if not np.isfinite(std).any():  # as the ± of the table, which then are from noise alone
        std = prediction_std(result, m, turning=True)
    known = np.isfinite(std)
    level = np.log10(np.where(known, std, np.nan).clip(_LEAST))
    # beyond the border of what is known, as just before it: what is drawn ends halfway
    beside = np.pad(level, 1, constant_values=np.nan)
    beside = np.fmax.reduce(sliding_window_view(beside, (3, 3)), axis=(2, 3))
    level = np.nan_to_num(np.where(known, level, beside))
    least = np.quantile(level[known], 0.1) if known.any() else 0.0
    edges = np.outer(10 ** (np.floor(least) + np.arange(3)), [1, 2, 5]).ravel()
    edges = edges[np.log10(edges) > least][: len(_BANDS) - 1]  # (in the middle nothing turns)
    fine, shown = (
        np.asarray(Image.fromarray(x.astype(np.float32)).resize(size, Image.Resampling.BILINEAR))
        for x in (level, known)
    )
    band = np.searchsorted(np.log10(edges), fine).astype(np.uint8)
    band[shown < 0.5] = len(_BANDS)
    colours = [*_BANDS, _UNKNOWN]
    sheet.areas(band, colours, size)
    sheet.dots((np.concatenate(result.image_points) + 0.5) * zoom, "#0009", 2.5)
    if proposal is not None:
        outline = (np.concatenate([proposal.outline, proposal.outline[:1]]) + 0.5) * zoom
        sheet.lines(outline[None], "#fff", 6)
        sheet.lines(outline[None], LENS, 3)
    names = [f"{a:g} to {b:g} px" for a, b in pairwise(edges)]
    names = [f"up to {edges[0]:g} px", *names, f"more than {edges[-1]:g} px", "not known"]
    return sheet, {names[i]: colours[i] for i in np.unique(band)}


def residuals(result: "Calibration") -> tuple[Drawing, str]:
    """Draw each residual where it is, magnified, beside a bar; gives the words for it, too.

    Lines that point all over the place are noise; lines that agree with their neighbours are
    something that the model does not describe.
    """
    m, r = np.concatenate(result.image_points), np.concatenate(result.residuals)
    known = np.isfinite(r).all(-1)
    places, r, word = m[known] - r[known], r[known], "Residuals"
    if len(r) > _MOST_LINES:  # of so many, what they have in common in a place is to be seen
        places, r = _cell_means(m[known], r, result.size)
        word = "Mean residuals of places"
    longer = float(np.percentile(np.hypot(*r.T), 95)) if len(r) else 0.0
    magnify = round_number(0.04 * result.size[0] / longer) if longer > 0 else 1.0
    sheet, zoom = _picture(result, "Residuals", below=_BELOW)
    width, height = zoom * np.array(result.size)
    start, bar = (places + 0.5) * zoom, round_number(0.12 * width / (zoom * magnify))
    end = start + zoom * magnify * r
    frame = [(0, 0), (width, 0), (width, height), (0, height), (0, 0)]
    sheet.lines([frame], INK, 0.6)
    sheet.lines(np.stack([start, end], axis=1), ESTIMATED)
    sheet.dots(end, ESTIMATED)
    middle, half, y = width / 2, zoom * magnify * bar / 2, height + 12
    sheet.lines([[(middle - half, y), (middle + half, y)]], INK, 3)
    sheet.text((middle, y + 22), f"{bar:g} px")
    return sheet, f"{word}, {magnify:,g} times as long as they are."


def boards(result: "Calibration", board: "Board") -> tuple[Drawing, str]:
    """Draw the boards around the camera, with the numbers of their photographs; and say it."""
    (columns, rows), side = board.corners, board.square
    x, y = np.array([[-1, columns, columns, -1], [-1, -1, rows, rows]]) * side
    corners = move(result.poses, np.stack([x, y, 0 * x], axis=-1))  # (views, 4, 3)
    middle = corners.mean(1)
    far = np.linalg.norm(middle, axis=-1)
    width, height = result.size
    border = np.array([[0, 0, 0], [0, 0, 1], [width, 0, 1], [width, height, 1], [0, height, 1]])
    picture = np.linalg.solve(result.A, border.T).T  # as if there were no lens: for any
    picture *= 0.3 * np.median(far) / np.linalg.norm(picture, axis=1).max()
    target = np.append(middle, np.zeros((1, 3)), axis=0).mean(0)
    eye = target + 3 * far.max() * np.array(_FROM)
    onlooker = Camera(intrinsics(1, 1, 0, 0), look_at(eye, target))
    m = onlooker.project(np.concatenate([corners.reshape(-1, 3), picture]))
    low, spread = m.min(0), np.ptp(m, axis=0)
    zoom = min((_WIDE - 2 * _ROOM) / spread[0], (0.7 * _WIDE - 2 * _ROOM) / spread[1])
    m = (m - low - spread / 2) * zoom + np.array([_WIDE, zoom * spread[1] + 2 * _ROOM]) / 2
    sheet = Drawing((_WIDE, zoom * spread[1] + 2 * _ROOM), "The boards in space around the camera")
    seen, camera = m[:-5].reshape(-1, 4, 2), m[-5:]
    for i in np.argsort(-np.linalg.norm(middle - eye, axis=1)):  # the farthest first
        sheet.lines(seen[i, None], ESTIMATED, fill=ESTIMATED)
    sheet.lines(camera[[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]]], WORLD, 2, fill=WORLD)
    numbered = _spread(seen)
    for i, at in numbered.items():
        sheet.text(at, str(i + 1))
    words = f"The boards, {far.min() / 10:.0f} to {far.max() / 10:.0f} cm from the camera"
    return sheet, words + ("." if len(numbered) == len(seen) else ", as many numbered as fit.")


def _spread(seen: Array) -> dict[int, Array]:
    """Return where on each board (n, 4, 2) its number may stand, of those that find room.

    Those with the least room choose first.
    """
    part = np.array([0.12, 0.5, 0.88])
    top, bottom = (a[:, None] + (b - a)[:, None] * part[:, None]
                   for a, b in ((seen[:, 0], seen[:, 1]), (seen[:, 3], seen[:, 2])))  # fmt: skip
    places = (top[:, :, None] + (bottom - top)[:, :, None] * part[:, None]).reshape(len(seen), 9, 2)
    chosen: dict[int, Array] = {}
    for i in np.argsort(np.ptp(seen, axis=1).min(1)).tolist():
        taken = np.array([*chosen.values(), (np.inf, np.inf)])
        room = np.linalg.norm(places[i][:, None] - taken, axis=-1).min(1)
        if (free := np.flatnonzero(room > _NUMBER)).size:
            chosen[i] = places[i][free[0]]
    return chosen


def photograph(photo: "Detection", board: "Board") -> Drawing:
    """Draw a photograph small, with the corners found in it: rows joined, a ring at the origin."""
    height, width = photo.thumbnail.shape
    sheet = Drawing((width, height), f"Corners in {printable(photo.path.name)}")
    sheet.photograph(photo.thumbnail, (width, height))
    if photo.corners is not None:
        m = photo.on_thumbnail(photo.corners).reshape(*board.corners[::-1], 2) + 0.5
        sheet.lines(m, ESTIMATED)
        sheet.dots(m.reshape(-1, 2), ESTIMATED)
        sheet.lines([m[0, :3], m[:3, 0]], WORLD, 2.5)
        sheet.dots(m[0, :1], WORLD, 8)
    elif photo.found is not None:
        sheet.dots(photo.on_thumbnail(photo.found) + 0.5, LENS, 5)
    return sheet


def partners(pictures: Sequence[npt.NDArray[Any]], label: str, axis: int = 0) -> Drawing:
    """Draw two pictures beside each other, or one above the other, with rows through both."""
    wide = _WIDE / 2 if axis == 0 else _WIDE
    sizes = [(wide, wide * picture.shape[0] / picture.shape[1]) for picture in pictures]
    across, along = (sum if i == axis else max for i in (0, 1))
    whole = across(w for w, _ in sizes), along(h for _, h in sizes)
    sheet = Drawing(whole, label)
    for picture, size, at in zip(pictures, sizes, (0.0, sizes[0][axis]), strict=True):
        sheet.photograph(picture, size, (at, 0) if axis == 0 else (0, at))
    places = np.linspace(0, sizes[0][1 - axis], 11)[1:-1]
    ends = np.stack(np.broadcast_arrays([0, whole[axis]], places[:, None]), axis=-1)
    sheet.lines(ends if axis == 0 else ends[..., ::-1], ESTIMATED)
    return sheet


def _picture(result: "Calibration", label: str, *, below: int = 0) -> tuple[Drawing, float]:
    """Return a drawing as large as the camera's picture times a zoom, and room below it."""
    zoom = _WIDE / max(result.size)
    return Drawing((zoom * result.size[0], zoom * result.size[1] + below), label), zoom


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
