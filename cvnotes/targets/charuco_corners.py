"""The corners of a ChArUco board, each known by its number, measured."""

import numpy as np

from cvnotes.base import Array, CornersNotFound, DegenerateError, Image
from cvnotes.targets.charuco import CharucoBoard
from cvnotes.targets.lattice import completed
from cvnotes.targets.markers import Numbered
from cvnotes.targets.subpixel import fit_edges

_FEWEST = 4  # corners that make a homography, and a view
_MOVED = 0.15  # squares that the edge fit may move a corner


def measured_numbered(picture: Image, seen: Numbered, board: CharucoBoard) -> Array:
    """Measure the inner corners of a ChArUco board of which markers were read.

    The model of two blurred edges is fitted to the pixels beside the edges of the squares, which
    the markers leave clear. Returns (n, 2), NaN for corners that cannot be seen.

    Raises
    ------
    CornersNotFound
        Fewer than four corners can be seen; the message says which markers are there instead.
    """
    if len(seen.m) < _FEWEST:
        raise _not_found(picture, board, len(seen.m), seen)
    columns, rows = board.corners
    # (whole numbers: whether their sum is even tells dark squares from light ones)
    W, at = np.rint(board.points / board.square), seen.numbers
    m = np.full((len(W), 2), np.nan)
    try:
        lattice = _continued(W, seen, (rows, columns))
        fit = fit_edges.inside(picture, lattice, grid=board.corners, clear=board.clear, only=at)
    except DegenerateError:
        raise _not_found(picture, board, 0, seen) from None
    sides = np.linalg.norm(np.gradient(lattice.reshape(rows, columns, 2), axis=1), axis=-1).ravel()
    near = np.linalg.norm(fit.m - seen.m, axis=-1) < _MOVED * sides[at]
    # The origin's square is dark, or of a board in the legacy pattern light.
    parity = np.sign(fit.contrast) * (-1.0) ** W[at].sum(1)
    good = near & (parity == (-1 if parity.sum() < 0 else 1))
    if good.sum() < _FEWEST:
        raise _not_found(picture, board, int(good.sum()), seen)
    m[at[good]] = fit.m[good]
    return m


def _continued(W: Array, seen: Numbered, shape: tuple[int, int]) -> Array:
    """Continue a board (n, 2) where it is not seen, so that each corner has neighbours.

    A homography would do where the lens is straight, and leads beyond the horizon where it is not.
    """
    plane = W + [0, 0, 1]  # x, y, 1
    affine = plane @ np.linalg.lstsq(plane[seen.numbers], seen.m, rcond=None)[0]
    beside = np.full(affine.shape, np.nan)
    beside[seen.numbers] = seen.m - affine[seen.numbers]
    return affine + completed(beside.reshape(*shape, 2)).reshape(-1, 2)


def _not_found(
    picture: Image, board: CharucoBoard, corners: int, seen: Numbered
) -> CornersNotFound:
    """Describe how far it went, and what probably went wrong."""
    (columns, rows), (height, width) = board.corners, picture.shape
    start = (
        f"no ChArUco board of {columns}×{rows} inner corners with markers {board.dictionary} "
        f"found in a picture of {width}×{height} pixels"
    )
    there, question = _guess(board, corners, seen)
    brief = f"{start}: {there}"
    count = (seen.squares[0] - 1, seen.squares[1] - 1) if seen.squares else None
    return CornersNotFound(
        f"{brief}; {question}", brief=brief, question=question, count=count, markers=seen.other
    )


def _guess(board: CharucoBoard, corners: int, seen: Numbered) -> tuple[str, str]:
    """Return what is there, and what may have gone wrong."""
    markers = seen.markers
    if seen.squares:
        columns, rows = seen.squares
        question = "are the inner corners counted right, and which number is that of columns?"
        if seen.squares == board.corners:
            question = f"count the inner corners, {columns - 1}×{rows - 1}, and not the squares"
        return f"its markers stand as on a board of {columns}×{rows} squares", question
    if len(markers) and markers.max() >= board.n_markers:
        return (
            f"it has markers 0 to {board.n_markers - 1}, and {int(markers.max())} is there",
            "are the inner corners counted right?",
        )
    if len(markers):
        return (
            f"{len(markers)} markers can be read, but only {corners} corners between them",
            "is more of the board to be seen, and are the counts right?",
        )
    if seen.other:
        return f"there are markers of {seen.other}", "was the board made with these?"
    return "not one marker can be read", "is it in the picture, sharp and large enough?"
