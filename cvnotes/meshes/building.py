"""Scenes built of faces and boxes, and put together."""

import numpy as np
import numpy.typing as npt

from cvnotes.errors import CvnotesError, ShapeError, numbers, points
from cvnotes.meshes.scene import Scene

_BOX_FACES = ((0, 1, 3, 2), (5, 4, 6, 7), (4, 0, 2, 6), (1, 5, 7, 3), (4, 5, 1, 0), (2, 3, 7, 6))


def quads(
    vertices: npt.ArrayLike,
    loops: npt.ArrayLike,
    colours: npt.ArrayLike,
    tile: npt.ArrayLike = np.inf,
) -> Scene:
    """Build flat faces of four corners each.

    Parameters
    ----------
    vertices : array_like, shape (n, 3)
        Points in the WRF.
    loops : array_like of int, shape (q, 4)
        The corners of each face, in order around it; its texture begins in the first one.
    colours : array_like, shape (3,), (2, 3), (q, 1, 3) or (q, 2, 3)
        One colour or two for a checker; the same for all faces or for each its own.
    tile : float or array_like, shape (q,)
        Side of the checker's squares; infinite for plain faces.

    Examples
    --------
    >>> quads([[0, 0, 5], [2, 0, 5], [2, 1, 5], [0, 1, 5]], [[0, 1, 2, 3]], (0.5, 0.5, 0.5))
    Scene(4 vertices, 2 triangles)
    """
    vertices, colours = points(vertices, "vertices", 3), points(colours, "colours", 3)
    loops = numbers(loops, "loops").astype(np.int64)
    if loops.ndim != 2 or loops.shape[1] != 4:
        raise ShapeError(f"loops: expected four corners a face (q, 4), got {loops.shape}")
    if vertices.ndim != 2 or not ((loops >= 0) & (loops < len(vertices))).all():
        raise ShapeError(f"loops: some corners are none of the vertices {vertices.shape}")
    if colours.shape not in ((3,), (2, 3), (len(loops), 1, 3), (len(loops), 2, 3)):
        raise ShapeError(f"colours: expected (3,), (2, 3) or (q, 2, 3), got {colours.shape}")
    a, b, d = (vertices[loops[:, i]] for i in (0, 1, 3))
    across, down = (np.linalg.norm(p - a, axis=-1) / tile for p in (b, d))
    zero = np.zeros(len(loops))
    u, v = np.stack([zero, across, across, zero], -1), np.stack([zero, zero, down, down], -1)
    halves = np.array([[0, 1, 2], [0, 2, 3]])
    uv = np.stack([u, v], -1)[:, halves].reshape(-1, 3, 2)
    each = np.broadcast_to(colours, (len(loops), 2, 3))
    return Scene(
        vertices,
        loops[:, halves].reshape(-1, 3),
        np.repeat(each, 2, axis=0),
        uv,
        np.full((len(uv), 2), np.inf),
    )


def box(
    x: tuple[float, float],
    y: tuple[float, float],
    z: tuple[float, float],
    colours: npt.ArrayLike = (0.8, 0.8, 0.8),
    tile: npt.ArrayLike = np.inf,
) -> Scene:
    """Build a box along the axes, from its lowest to its highest x, y and z.

    Faces are in the order front (low z), back, left (low x), right, top (low y), bottom;
    vertices count in binary, x fastest.

    Examples
    --------
    >>> box((0, 1), (0, 2), (0, 3)).vertices[[0, 1, 7]]
    array([[0., 0., 0.],
           [1., 0., 0.],
           [1., 2., 3.]])
    """
    bounds = numbers([x, y, z], "x, y, z")
    if bounds.shape != (3, 2) or (bounds[:, 0] >= bounds[:, 1]).any():
        raise CvnotesError(f"a box has x, y and z as (low, high), got {x}, {y}, {z}")
    vertices = [[bx, by, bz] for bz in bounds[2] for by in bounds[1] for bx in bounds[0]]
    return quads(vertices, _BOX_FACES, colours, tile)


def join(*scenes: Scene) -> Scene:
    """Put scenes together; the surroundings are the first one's.

    Examples
    --------
    >>> crate = box((0, 1), (0, 1), (0, 1))
    >>> join(crate, crate.moved(np.eye(4)))
    Scene(16 vertices, 24 triangles)
    """
    if not scenes:
        raise CvnotesError("join needs at least one scene")
    starts = np.cumsum([0] + [len(scene.vertices) for scene in scenes[:-1]])
    triangles = [scene.triangles + start for scene, start in zip(scenes, starts, strict=True)]
    parts = {
        name: np.concatenate([getattr(scene, name) for scene in scenes])
        for name in ("vertices", "colours", "uv", "extent")
    }
    return Scene(triangles=np.concatenate(triangles), around=scenes[0].around, **parts)
