"""The edges between flat colours that a camera sees of a target, as curves in the picture.

Everything is worked out on the plane z = 1, where straight lines of the target are straight
still. There each line is cut wherever another one meets it, and every cut piece is asked what it
separates: what is hidden separates nothing. Only then do the pieces go through the lens, by the
formulas that project a point, so that a corner is drawn where `Camera.project` says it is.
"""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, FisheyeLens, px_from_xy
from cvnotes.pictures.faces import Face, Mask, Target, faces_before_camera, folds, nearest_grey
from cvnotes.pictures.pixel_means import Indices, subdivide

_BESIDE = 1e-11  # how far from an edge, on z = 1, the colours on either side of it are read
_GRAZING = 1e3  # ideal radius of a ray 0.06° before 90°: what lies flat there is not seen


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
        By how much the two sides of each piece differ, as in `coverage.edge_means`: in grey level
        (0 where the target is not), and in whether the target is there (0 or 1).

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.camera import look_at
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
    xy, piece = subdivide(a, b, length)
    if len(angle):
        phi, rim_piece = subdivide(angle[:, :1], angle[:, 1:], length / radius)
        xy = np.concatenate([xy, _on_rim(phi[:, 0], centre, radius)])
        piece = np.concatenate([piece, len(a) + rim_piece])
        jump = np.concatenate([jump, rim_jump])
    m = px_from_xy(camera.A, camera.lens.distort(xy))
    first = np.flatnonzero(piece[1:] == piece[:-1])
    return m.take(first, axis=0), m.take(first + 1, axis=0), jump.take(piece[first], axis=0)


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
    """Tell which pieces of lines lie, as the camera sees it, on an earlier line."""
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
    if isinstance(camera.lens, FisheyeLens):
        limit = min(limit, _GRAZING)
    return float(min(1.1 * reach, limit)) if np.isfinite(reach) else limit
