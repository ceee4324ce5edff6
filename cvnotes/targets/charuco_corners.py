"""From a picture to the corners of a ChArUco board, each known by its number."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CornersNotFound, DegenerateError, Image
from cvnotes.homography import dlt
from cvnotes.projective import apply
from cvnotes.targets.charuco import CharucoBoard
from cvnotes.targets.edge_corners import fit_edges
from cvnotes.targets.opencv_finders import DICTIONARIES, Grey8, find_charuco

_FEWEST = 4  # corners that make a homography, and a view
_MOVED = 0.15  # squares that the edge fit may move a corner


def find_numbered(picture: Image, grey: Grey8, board: CharucoBoard) -> Array:
    """Find the inner corners of a ChArUco board; (n, 2), NaN for those that cannot be seen.

    OpenCV reads the markers and says which corners are where. Then the model of two blurred edges
    is fitted to the pixels beside the edges of the squares, which the markers leave clear.

    Raises
    ------
    CornersNotFound
        Fewer than four corners can be seen; the message says which markers are there instead.
    """
    found, ids, markers = find_charuco(grey, board.squares, 1 - 2 * board.clear, board.dictionary)
    if len(found) < _FEWEST:
        raise CornersNotFound(_lesson(grey, board, len(found), markers))
    columns, rows = board.corners
    W = board.points[:, :2] / board.square
    m = np.full((len(W), 2), np.nan)
    try:
        # Where it is not seen the board is continued, so that each corner has neighbours.
        lattice = apply(dlt(W[ids], found), W)
        lattice[ids] = found
        fit = fit_edges(picture, lattice, grid=board.corners, clear=board.clear)
    except DegenerateError:
        raise CornersNotFound(_lesson(grey, board, 0, markers)) from None
    sides = np.linalg.norm(np.gradient(lattice.reshape(rows, columns, 2), axis=1), axis=-1).ravel()
    moved = np.linalg.norm(fit.m - lattice, axis=-1)
    alternate = np.sign(fit.contrast) == -((-1.0) ** (W.sum(1)))  # the origin's square is dark
    good = [i for i in ids if moved[i] < _MOVED * sides[i] and alternate[i]]
    if len(good) < _FEWEST:
        raise CornersNotFound(_lesson(grey, board, len(good), markers))
    m[good] = fit.m[good]
    return m


def _lesson(grey: Grey8, board: CharucoBoard, corners: int, markers: npt.NDArray[np.intp]) -> str:
    """Say how far it went, and what probably went wrong."""
    columns, rows = board.corners
    start = (
        f"no ChArUco board of {columns}×{rows} inner corners with markers {board.dictionary} "
        f"found in a picture of {grey.shape[1]}×{grey.shape[0]} pixels"
    )
    if len(markers) and markers.max() >= board.n_markers:
        return (
            f"{start}: it has markers 0 to {board.n_markers - 1}, and {int(markers.max())} is "
            "there; are the inner corners counted right?"
        )
    if len(markers):
        return (
            f"{start}: {len(markers)} markers can be read, but only {corners} corners between "
            "them; is more of the board to be seen, and are the counts right?"
        )
    other = _other_dictionary(grey, board)
    if other:
        return f"{start}: there are markers of {other}; was the board made with these?"
    return f"{start}: not one marker can be read; is it in the picture, sharp and large enough?"


def _other_dictionary(grey: Grey8, board: CharucoBoard) -> str:
    """Name the dictionary that most of the markers in a picture belong to, if it is another."""
    read = {}
    for name in DICTIONARIES:
        if name.endswith("_1000"):  # the smaller ones are parts of it
            read[name] = len(find_charuco(grey, board.squares, 1 - 2 * board.clear, name)[2])
    best = max(read, key=lambda name: read[name])
    return best.split("_")[0] if read[best] >= _FEWEST else ""
