"""The pictures that `cvnotes calibrate` leaves beside its numbers."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cvnotes.base import chunks
from cvnotes.commands.examined import Examined
from cvnotes.files.writing import printable
from cvnotes.show import (
    ESTIMATED,
    draw_corners,
    draw_coverage,
    draw_image,
    draw_residual_scatter,
    draw_residuals,
    draw_view_rms,
    panels,
)
from cvnotes.show.picture import encode, figure_of
from cvnotes.targets import Chessboard

if TYPE_CHECKING:
    from cvnotes.calibration import Calibration

_COLUMNS, _ROWS = 4, 10  # of a sheet
_TILE = 240  # px wide on the page, drawn at twice that


def pictures(
    result: "Calibration", examined: Sequence[Examined], board: Chessboard, names: Sequence[str]
) -> dict[str, bytes]:
    """Draw all pictures; gives PNG by file name.

    Parameters
    ----------
    result : Calibration
        What came out.
    examined : sequence of Examined
        All photographs looked at, also those without the board.
    board : Chessboard
        The board.
    names : sequence of str
        Names of those that were used.
    """
    drawn = {"view_rms.png": draw_view_rms(result, names=names, ax=panels(width=900, height=420))}
    drawn["coverage.png"] = draw_coverage(result.image_points, result.size)
    left, right = panels(2, width=1120, height=480, width_ratios=(1.4, 1))
    drawn["residuals.png"] = draw_residuals(result, ax=left)
    draw_residual_scatter(result, ax=right)
    drawn |= corner_sheets(examined, board)
    return {name: encode(figure_of(ax), jpeg=False)[0] for name, ax in drawn.items()}


def corner_sheets(examined: Sequence[Examined], board: Chessboard) -> dict[str, Any]:
    """Draw all photographs small with the corners found in them, on as many sheets as it takes."""
    sheets = [examined[part] for part in chunks(len(examined), _COLUMNS * _ROWS)]
    if len(sheets) == 1:
        return {"corners.png": _sheet(sheets[0], board)}
    return {f"corners-{i}.png": _sheet(sheet, board) for i, sheet in enumerate(sheets, start=1)}


def _sheet(examined: Sequence[Examined], board: Chessboard) -> Any:
    """Draw one sheet; gives the first of its axes."""
    columns = min(_COLUMNS, len(examined))
    rows = -(-len(examined) // columns)
    width, height = examined[0].size
    high = round(_TILE * height / width) + 25
    tiles = np.ravel(panels(columns, rows, width=_TILE * columns, height=high * rows))
    for ax in tiles:
        ax.set_axis_off()
    for ax, photo in zip(tiles, examined, strict=False):
        name = _shortened(printable(photo.path.name))
        if photo.thumbnail_corners is None:
            draw_image(photo.thumbnail, ax=ax)
            ax.set_title(f"{name}: not found", fontsize=8, color=ESTIMATED)
        else:
            draw_corners(photo.thumbnail, photo.thumbnail_corners, board, ax=ax)
            ax.set_title(name, fontsize=8)
    return tiles[0]


def _shortened(name: str) -> str:
    return name if len(name) <= 28 else f"{name[:14]}…{name[-13:]}"
