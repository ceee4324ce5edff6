"""Single things: a calibration target on its plates, and what others have modelled."""

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.meshes import Scene, box, join, quads
from cvnotes.targets import Chessboard, ThreePlanes, TwoPlanes

_PRINT = ((0.06, 0.06, 0.07), (0.98, 0.98, 0.97))
_PLATE = (0.62, 0.64, 0.66)
_THICK = 3.0


def target_scene(
    target: Chessboard | TwoPlanes | ThreePlanes,
    world_from_target: npt.ArrayLike | None = None,
    *,
    margin: float = 1.0,
) -> Scene:
    """Build a calibration target: boards printed on paper, on plates 3 mm thick.

    Parameters
    ----------
    target : Chessboard, TwoPlanes or ThreePlanes
        Its corners are ``target.points``, in the target's frame.
    world_from_target : array_like, shape (4, 4), optional
        Where it stands; by default in the origin.
    margin : float
        White paper around the squares, in squares.

    Examples
    --------
    >>> target_scene(TwoPlanes())
    Scene(24 vertices, 24 triangles)
    """
    boards = [_board(board, margin).moved(G) for G, board in target.faces]
    return join(*boards).moved(np.eye(4) if world_from_target is None else world_from_target)


def from_trimesh(mesh: Any) -> Scene:
    """Take the triangles and face colours of a ``trimesh.Trimesh``.

    Examples
    --------
    >>> import trimesh
    >>> from_trimesh(trimesh.creation.icosphere(subdivisions=1, radius=50.0))
    Scene(42 vertices, 80 triangles)
    """
    m = len(mesh.faces)
    colours = np.asarray(mesh.visual.face_colors, dtype=float)[:, None, :3] / 255
    return Scene(
        mesh.vertices,
        mesh.faces,
        np.broadcast_to(colours, (m, 2, 3)),
        np.zeros((m, 3, 2)),
        np.full((m, 2), np.inf),
    )


def _board(board: Chessboard, margin: float) -> Scene:
    """Build one board in its own frame: the print, and the plate behind it."""
    columns, rows = board.squares
    low, high = -1 - margin, np.array([columns, rows]) - 1 + margin
    square = board.square
    (x0, y0), (x1, y1) = (low * square, low * square), high * square
    plate = box((x0, x1), (y0, y1), (0, _THICK), _PLATE)
    behind = replace(  # all faces but the front
        plate,
        **{name: getattr(plate, name)[2:] for name in ("triangles", "colours", "uv", "extent")},
    )
    paper = quads(
        [[x0, y0, 0], [x1, y0, 0], [x1, y1, 0], [x0, y1, 0]], [[0, 1, 2, 3]], _PRINT, square
    )
    paper = replace(paper, uv=paper.uv - margin, extent=np.full((2, 2), (columns, rows)))
    return join(paper, behind)
