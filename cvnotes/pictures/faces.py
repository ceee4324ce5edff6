"""The printed faces of a target, held before a camera, and the edges that it sees of them.

All is said with planes through the camera. A line of a board spans one, whose normal is the cross
product of the line's ends; on which side of it a direction d = (x, y, 1) lies is the sign of one
scalar product, and counting the lines that d has passed gives the field it meets. A board's own
plane n·M = 1 gives the depth: M = z d, hence 1/z = n·d.

On the plane z = 1 straight lines of the target are straight still. There each line is cut wherever
another one meets it, and every cut piece is asked what it separates: what is hidden separates
nothing. Only then do the pieces go through the lens, by the formulas that project a point, so that
a corner is drawn where `Camera.project` says it is.
"""

from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, InputTypeError, rigid_motion
from cvnotes.camera import Camera, px_from_xy
from cvnotes.pictures.pixel_means import Indices, subdivide

Mask = npt.NDArray[np.bool_]

PAPER, INK = 220.0, 30.0  # grey levels of a printed face in even light
_THIN = 1e-5  # a face thinner than this, on z = 1, is not seen; closer planes count as one
_BESIDE = 1e-11  # how far from an edge, on z = 1, the colours on either side of it are read
_GRAZING = 1e3  # ideal radius of a ray 0.06° before 90°: what lies flat there is not seen


class Target(Protocol):
    """What can be photographed: chessboards, each with its pose in the target's frame."""

    @property
    def faces(self) -> tuple[tuple[Array, Any], ...]:
        """Pairs (``world_from_board`` (4, 4), board)."""


def is_target(target: Any) -> None:
    """Refuse what has no faces."""
    if not hasattr(target, "faces"):
        given = type(target).__name__
        raise InputTypeError(f"target: expected a Chessboard or the like, got {given}")


@dataclass(frozen=True)
class Face:
    """A printed board before a camera, in the CRF.

    Parameters
    ----------
    plane : ndarray, shape (3,)
        The n of n·M = 1.
    lines : ndarray, shape (n, 2, 3)
        Both ends of each line: first those that follow each other along the board's x axis.
    passed : ndarray, shape (n, 3)
        For each line the normal with normal·d > 0 in the directions that have passed it.
    grey : ndarray, shape (rows, columns)
        Grey levels of the fields between the lines.
    """

    plane: Array
    lines: Array
    passed: Array
    grey: Array

    def grey_along(self, d: Array) -> tuple[Mask, Array]:
        """Return which directions (m, 3) meet the face, and the grey levels (m,) they find."""
        beyond = d @ self.passed.T > 0
        rows, columns = self.grey.shape
        i, j = beyond[:, : columns + 1].sum(axis=1) - 1, beyond[:, columns + 1 :].sum(axis=1) - 1
        hit = (d @ self.plane > 0) & (i >= 0) & (i < columns) & (j >= 0) & (j < rows)
        return hit, self.grey[j * hit, i * hit]


def faces_before_camera(target: Target, cam_from_world: Array, margin: float) -> list[Face]:
    """Carry the faces of a target into a camera's frame, the nearest plane first.

    Each board has `margin` squares of white paper around it; from behind it is plain paper. Faces
    seen edge on are left out.

    Examples
    --------
    >>> from cvnotes.camera import look_at
    >>> from cvnotes.targets import Chessboard
    >>> (face,) = faces_before_camera(Chessboard((4, 3)), look_at([0, 0, -500], [0, 0, 0]), 1.0)
    >>> face.grey
    array([[220., 220., 220., 220., 220., 220., 220.],
           [220.,  30., 220.,  30., 220.,  30., 220.],
           [220., 220.,  30., 220.,  30., 220., 220.],
           [220.,  30., 220.,  30., 220.,  30., 220.],
           [220., 220.,  30., 220.,  30., 220., 220.],
           [220., 220., 220., 220., 220., 220., 220.]])
    """
    held = []
    for world_from_board, board in target.faces:
        G = cam_from_world @ rigid_motion(world_from_board, "world_from_board")
        distance = float(G[:3, 2] @ G[:3, 3])  # of the board's plane, < 0 from behind
        x, y, grey = _print(board, margin, plain=distance < 0)
        across = [[[X, y[0], 0], [X, y[-1], 0]] for X in x]
        down = [[[x[0], Y, 0], [x[-1], Y, 0]] for Y in y]
        lines = np.array(across + down) @ G[:3, :3].T + G[:3, 3]
        extent = np.linalg.norm(lines[0, 0] - lines[-1, 1])
        if abs(distance) * extent <= _THIN * (lines**2).sum(axis=-1).max():
            continue
        # det(p0, p1, M) has the sign of distance·(X0 − X) for one family, (Y − Y0) for the other.
        sign = np.sign(distance) * np.repeat([-1, 1], [len(x), len(y)])
        passed = sign[:, None] * np.cross(lines[:, 0], lines[:, 1])
        held.append((abs(distance), Face(G[:3, 2] / distance, lines, passed, grey)))
    held.sort(key=lambda pair: pair[0])
    return _aligned([face for _, face in held])


def nearest_grey(faces: list[Face], xy: Array) -> Array:
    """Return the grey level of what is nearest at points `xy` of the plane z = 1, and 1: (m, 2).

    Rows are (0, 0) where nothing is.

    Examples
    --------
    >>> from cvnotes.camera import look_at
    >>> from cvnotes.targets import Chessboard
    >>> cam_from_world = look_at([0, 0, -500], [0, 0, 0])
    >>> faces = faces_before_camera(Chessboard((4, 3)), cam_from_world, 1.0)
    >>> nearest_grey(faces, np.array([[-0.01, -0.01], [0.01, -0.01], [-0.2, 0.0]]))
    array([[ 30.,   1.],
           [220.,   1.],
           [  0.,   0.]])
    """
    d = np.column_stack([xy, np.ones(len(xy))])
    front, seen = np.zeros((len(xy), 3)), np.zeros((len(xy), 2))
    for face in faces:
        hit, grey = face.grey_along(d)
        # One difference instead of two depths, so that `folds` agrees to the last digit.
        nearer = hit & (((face.plane - front) * d).sum(axis=1) > 0)
        front[nearer], seen[nearer, 0], seen[nearer, 1] = face.plane, grey[nearer], 1
    return seen


def folds(faces: list[Face]) -> list[Array]:
    """Return the lines (1, 2, 3) in which the planes of two faces meet, as long as the first.

    Examples
    --------
    >>> from cvnotes.camera import look_at
    >>> from cvnotes.targets import TwoPlanes
    >>> cam_from_world = look_at([300, 0, -400], [0, 0, 0])
    >>> (fold,) = folds(faces_before_camera(TwoPlanes(), cam_from_world, 1.0))
    >>> abs(fold[0, 1] - fold[0, 0]).round()  # the common edge, 9 fields of 25 mm, is upright
    array([  0., 225.,   0.])
    """
    found = []
    for first, second in combinations(faces, 2):
        normals = np.stack([first.plane, second.plane])
        along = np.cross(*normals)
        length = np.linalg.norm(along)
        if length <= _THIN * np.prod(np.linalg.norm(normals, axis=1)):
            continue  # parallel
        along = along / length
        foot = np.linalg.solve(np.vstack([normals, along]), [1, 1, 0])
        reach = first.lines @ along
        found.append(np.array([[foot + reach.min() * along, foot + reach.max() * along]]))
    return found


def _print(board: Any, margin: float, plain: bool) -> tuple[Array, Array, Array]:
    """Describe where the lines of a printed board lie, and how grey the fields between them are."""
    x, y, dark = board.printed
    grey = np.where(dark & (not plain), INK, PAPER)
    if margin > 0:
        grey = np.pad(grey, 1, constant_values=PAPER)
        white = margin * board.square
        x, y = (np.concatenate([[z[0] - white], z, [z[-1] + white]]) for z in (x, y))
    return x, y, grey


def _aligned(faces: list[Face]) -> list[Face]:
    """Put faces whose planes nearly agree into one plane, where the earlier one is in front."""
    for i, j in combinations(range(len(faces)), 2):
        plane = faces[i].plane
        if np.linalg.norm(faces[j].plane - plane) <= _THIN * np.linalg.norm(plane):
            faces[j] = replace(faces[j], plane=plane)
    return faces


def edges_in_picture(
    target: Target, camera: Camera, margin: float = 1.0, *, step: float = 1.0
) -> tuple[Array, Array, Array]:
    """Return the edges between the colours of a target, as a camera sees them.

    Parameters
    ----------
    target : Target
        Chessboards in space, printed on paper; from behind they are plain paper. Where several
        are seen in one direction the nearest one counts. They may cut through each other.
    camera : Camera
        Who looks. What its lens cannot see is left out.
    margin : float
        Width of the white paper around the outer squares, in squares.
    step : float
        Length in pixels of the straight pieces that stand for the curves.

    Returns
    -------
    start, end : ndarray, shape (n, 2)
        Pieces of edge in pixels, also outside of the picture.
    jump : ndarray, shape (n, 2)
        By how much the two sides of each piece differ, as in `pixel_means.edge_means`: in grey
        level (0 where the target is not), and in whether the target is there (0 or 1).

    Examples
    --------
    >>> from cvnotes.camera import intrinsics, look_at
    >>> from cvnotes.targets import Chessboard
    >>> camera = Camera(intrinsics(800, 800, 320, 240), look_at([100, 60, -600], [100, 60, 0]))
    >>> start, end, jump = edges_in_picture(Chessboard((9, 6), 25.0), camera, step=10.0)
    >>> np.unique(np.abs(jump), axis=0)  # ink beside paper, paper beside nothing
    array([[190.,   0.],
           [220.,   1.]])
    """
    faces = faces_before_camera(target, camera.G, margin)
    if not faces:
        return np.empty((0, 2)), np.empty((0, 2)), np.empty((0, 2))
    lines = np.concatenate([face.lines for face in faces] + folds(faces))
    centre, radius = np.array(camera.lens.centre), _visible_radius(camera)
    a, b, jump = _separating(faces, *_cut(lines, centre, radius))
    angle, rim_jump = _rim(faces, lines, centre, radius)
    # Straight pieces first, then those along the rim, whose coordinate is the angle.
    length = step / max(camera.A[0, 0], camera.A[1, 1])
    # Near 90° millions of such pieces on z = 1 would be one pixel of a wide lens.
    wide = camera.lens.wide
    xy, piece = (_by_angle if wide else subdivide)(a, b, length)
    if len(angle):
        shown = min(radius, np.pi / 2) if wide else radius
        phi, rim_piece = subdivide(angle[:, :1], angle[:, 1:], length / shown)
        xy = np.concatenate([xy, _on_rim(phi[:, 0], centre, radius)])
        piece = np.concatenate([piece, len(a) + rim_piece])
        jump = np.concatenate([jump, rim_jump])
    m = px_from_xy(camera.A, camera.lens.distort(xy))
    first = np.flatnonzero(piece[1:] == piece[:-1])
    return m.take(first, axis=0), m.take(first + 1, axis=0), jump.take(piece[first], axis=0)


def _by_angle(start: Array, end: Array, length: float) -> tuple[Array, Indices]:
    """Lay points along pieces (n, 2) of z = 1 as `subdivide` does, but evenly in angle.

    On a circle about the line of sight a fisheye shows an angle up to π/2 times as large.
    """
    p, q = (np.column_stack([x, np.ones(len(x))]) for x in (start, end))
    p, q = (x / np.linalg.norm(x, axis=1, keepdims=True) for x in (p, q))
    w = np.arctan2(np.linalg.norm(np.cross(p, q), axis=1), (p * q).sum(1)).clip(1e-12)
    t, piece = subdivide(np.zeros((len(w), 1)), w[:, None], length * 2 / np.pi)
    ray = np.sin(w[piece, None] - t) * p[piece] + np.sin(t) * q[piece]
    return ray[:, :2] / ray[:, 2:], piece


def _separating(faces: list[Face], a: Array, b: Array) -> tuple[Array, Array, Array]:
    """Keep the pieces from a to b that separate something, with what they separate."""
    along = b - a
    right = along[:, ::-1] * [1, -1]
    right = _BESIDE * right / np.linalg.norm(along, axis=1, keepdims=True)
    middle = (a + b) / 2
    jump = nearest_grey(faces, middle + right) - nearest_grey(faces, middle - right)
    keep = jump.any(axis=1)
    return a[keep], b[keep], jump[keep]


def _cut(lines: Array, centre: Array, radius: float) -> tuple[Array, Array]:
    """Cut lines (n, 2, 3) where they meet each other or the rim; both ends (m, 2) on z = 1."""
    p, d = lines[:, 0], lines[:, 1] - lines[:, 0]
    normals = np.cross(lines[:, 0], lines[:, 1])  # each with the camera spans a plane
    q, e = p[:, :2] - centre * p[:, 2:], d[:, :2] - centre * d[:, 2:]
    # The rim: ‖q + t e‖² = radius² (z + t dz)², a quadratic in t.
    c2 = (e * e).sum(1) - (radius * d[:, 2]) ** 2
    c1 = (q * e).sum(1) - radius**2 * p[:, 2] * d[:, 2]
    c0 = (q * q).sum(1) - (radius * p[:, 2]) ** 2
    root = np.sqrt(np.maximum(c1 * c1 - c2 * c0, 0))
    with np.errstate(divide="ignore", invalid="ignore"):  # parallel lines never meet
        t = np.column_stack([p @ normals.T / -(d @ normals.T), (-c1 - root) / c2, (root - c1) / c2])
    np.fill_diagonal(t, 0)
    t = np.sort(np.column_stack([np.zeros(len(p)), np.nan_to_num(t).clip(0, 1), np.ones(len(p))]))
    line, k = np.nonzero(np.diff(t) > 1e-12)
    ends = p[line, None] + np.stack([t[line, k], t[line, k + 1]], -1)[..., None] * d[line, None]
    middle = ends.mean(axis=1)
    offset = np.linalg.norm(middle[:, :2] - centre * middle[:, 2:], axis=1)
    seen = (offset < radius * middle[:, 2]) & ~_repeated(lines, normals, line, middle)
    a, b = np.moveaxis(ends[seen, :, :2] / ends[seen, :, 2:], 1, 0)
    return a, b


def _repeated(lines: Array, normals: Array, line: Indices, middle: Array) -> Mask:
    """Return which pieces of lines lie, as the camera sees it, on an earlier line."""
    repeated = np.zeros(len(line), dtype=bool)
    unit = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    same = np.linalg.norm(np.cross(unit[:, None], unit), axis=-1) < 0.1 * _BESIDE
    for i, j in np.argwhere(np.triu(same, 1)):
        m = middle[line == j]
        p, d = lines[i, 0], lines[i, 1] - lines[i, 0]
        t = -(np.cross(p, m) @ unit[i]) / (np.cross(d, m) @ unit[i])  # p + t d ∥ m
        repeated[line == j] |= (t > 0) & (t < 1)
    return repeated


def _rim(faces: list[Face], lines: Array, centre: Array, radius: float) -> tuple[Array, Array]:
    """Return the arcs (n, 2), in angles, along which the lens's reach ends on something visible."""
    nx, ny, nz = np.cross(lines[:, 0], lines[:, 1]).T
    # n·(centre + radius (cos φ, sin φ), 1) = 0
    cosine = -(nz + nx * centre[0] + ny * centre[1]) / (
        radius * np.maximum(np.hypot(nx, ny), 1e-300)
    )
    meets = np.abs(cosine) <= 1
    towards, half = np.arctan2(ny, nx)[meets], np.arccos(cosine[meets])
    phi = np.sort(np.mod(np.concatenate([[0], towards - half, towards + half]), 2 * np.pi))
    phi = np.append(phi, 2 * np.pi)
    inside = nearest_grey(faces, _on_rim((phi[1:] + phi[:-1]) / 2, centre, radius * (1 - _BESIDE)))
    keep = inside[:, 1] > 0
    return np.column_stack([phi[:-1], phi[1:]])[keep], -inside[keep]


def _on_rim(phi: Array, centre: Array, radius: float) -> Array:
    return centre + radius * np.stack([np.cos(phi), np.sin(phi)], axis=-1)


def _visible_radius(camera: Camera) -> float:
    """Return the ideal radius about the lens's centre that holds all that the picture can show."""
    (w, h), n = camera.size, 16
    u, v = np.linspace(-0.5, w - 0.5, n), np.linspace(-0.5, h - 0.5, n)
    border = [
        np.stack(np.broadcast_arrays(*side), -1)
        for side in ((u, v[0]), (u, v[-1]), (u[0], v), (u[-1], v))
    ]
    reach = np.linalg.norm(camera.ideal(np.concatenate(border)) - camera.lens.centre, axis=1).max()
    limit = (1 - 1e-9) * camera.lens.max_radius
    if camera.lens.wide:
        limit = min(limit, _GRAZING)
    return float(min(1.1 * reach, limit)) if np.isfinite(reach) else limit
