"""Scenes of triangles: as arrays with what is around them, and built of boxes and walls."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, ShapeError, number, numbers, points, real
from cvnotes.camera import move

Triangles = npt.NDArray[np.intp]
Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Surroundings:
    """What is around a scene: background, haze and light.

    Parameters
    ----------
    horizon, zenith : (red, green, blue)
        Colours of the background, at eye height and below, and straight up; 0 to 1.
    haze : float
        Distance over which things keep 1/e of their own colour; the rest is the horizon's.
    light : (x, y, z)
        Where the light comes from, as a direction in the WRF; y points down. Boxes cast shadows,
        and so does a sheet unless its corners run clockwise as the light sees them.
    ambient : float
        Brightness of a face that is turned away from the light, 0 to 1.
    occlusion : float
        From how far, in the scene's unit, a face dims another one on which it stands (ambient
        occlusion); 0 dims nothing. Faces are then rectangles of two triangles each, as those of
        `box` and `quads` are.
    """

    horizon: Colour = (0.60, 0.63, 0.67)
    zenith: Colour = (0.32, 0.36, 0.42)
    haze: float = np.inf
    light: tuple[float, float, float] = (0.5, -0.4, -0.8)
    ambient: float = 0.55
    occlusion: float = 0.0

    def __post_init__(self) -> None:
        for name in ("horizon", "zenith", "light"):
            value = numbers(getattr(self, name), name)
            if value.shape != (3,):
                raise ShapeError(f"{name}: expected three numbers, got shape {value.shape}")
            object.__setattr__(self, name, tuple(value.tolist()))
        if not any(self.light):
            raise CvnotesError("light: (0, 0, 0) is no direction")
        if not self.haze > 0:
            raise CvnotesError(f"haze: expected a positive distance, got {self.haze:g}")
        number(self.occlusion, "occlusion", at_least=0)


@dataclass(frozen=True, eq=False)
class Scene:
    """Triangles with colours, in the WRF (y downwards, as in the camera's frame).

    Parameters
    ----------
    vertices : array_like, shape (n, 3)
        Points in the WRF.
    triangles : array_like of int, shape (m, 3)
        Each triangle's vertices.
    colours : array_like, shape (m, 2, 3)
        The two colours of each triangle's checker (red, green, blue; 0 to 1, lamps more).
    uv : array_like, shape (m, 3, 2)
        Where each triangle's corners lie in the checker, in squares.
    extent : array_like, shape (m, 2)
        The checker covers 0 to extent along u and v; around it lies the second colour.
    around : Surroundings
        Background and light.

    Examples
    --------
    >>> from cvnotes.pictures.meshes import box
    >>> box((-1, 1), (0, 2), (4, 5)).vertices.shape
    (8, 3)
    """

    vertices: Array
    triangles: Triangles
    colours: Array
    uv: Array
    extent: Array
    around: Surroundings = field(default_factory=Surroundings)

    def __post_init__(self) -> None:
        vertices = points(self.vertices, "vertices", 3)
        triangles = points(self.triangles, "triangles", 3).astype(np.intp)
        m, n = len(triangles), len(vertices)
        if m == 0:
            raise CvnotesError("a scene needs at least one triangle")
        if triangles.min() < 0 or triangles.max() >= n:
            raise CvnotesError(f"triangles: numbers from 0 to {n - 1} point to a vertex, no others")
        arrays = {"vertices": vertices, "triangles": triangles}
        for name, shape in (("colours", (m, 2, 3)), ("uv", (m, 3, 2)), ("extent", (m, 2))):
            given = np.array(getattr(self, name), dtype=np.float64)
            if given.shape != shape:
                raise ShapeError(f"{name}: expected shape {shape}, got {given.shape}")
            if np.isnan(given).any() or (name != "extent" and np.isinf(given).any()):
                raise CvnotesError(f"{name} contains NaN or infinite values")
            arrays[name] = given
        for name, array in arrays.items():
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def corners(self) -> Array:
        """Corners (m, 3, 3) of the triangles in the WRF."""
        corners: Array = self.vertices[self.triangles]
        return corners

    @property
    def faces(self) -> Array:
        """Corners (k, 4, 3) of the faces in the WRF, if each is of two triangles."""
        one, other = self.triangles[::2], self.triangles[1::2]
        if len(one) != len(other) or (one[:, [0, 2]] != other[:, :2]).any():
            raise CvnotesError("faces: expected two triangles each, as those of `box` and `quads`")
        return np.asarray(self.corners.reshape(-1, 6, 3)[:, [0, 1, 2, 5]])

    @cached_property
    def normals(self) -> Array:
        """Unit normals (m, 3) of the triangles; zero for those without an area."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        n = np.cross(b - a, c - a)
        length = np.linalg.norm(n, axis=-1, keepdims=True)
        return np.asarray(np.divide(n, length, out=np.zeros_like(n), where=length > 0))

    @cached_property
    def edges(self) -> Triangles:
        """Vertices (k, 2) of the edges; those between triangles in one plane are left out."""
        pairs = np.sort(self.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        edges, which, count = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
        owner = np.repeat(np.arange(len(self.triangles)), 3)
        total = np.zeros((len(edges), 3))
        np.add.at(total, which.ravel(), self.normals[owner])
        flat = (count == 2) & (np.linalg.norm(total, axis=-1) > 2 - 1e-9)
        return np.asarray(edges[~flat])

    def moved(self, world_from_scene: npt.ArrayLike) -> "Scene":
        """Return the same scene elsewhere: every vertex moved by a rigid motion (4, 4)."""
        return replace(self, vertices=move(world_from_scene, self.vertices))

    def lit_from(self, direction: tuple[float, float, float]) -> "Scene":
        """Return the same scene in a light from another direction (3,) of the WRF."""
        return replace(self, around=replace(self.around, light=direction))

    def __repr__(self) -> str:
        return f"Scene({len(self.vertices)} vertices, {len(self.triangles)} triangles)"


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
    loops = numbers(loops, "loops").astype(np.intp)
    if loops.ndim != 2 or loops.shape[1] != 4:
        raise ShapeError(f"loops: expected four corners a face (q, 4), got {loops.shape}")
    if vertices.ndim != 2 or not ((loops >= 0) & (loops < len(vertices))).all():
        raise ShapeError(f"loops: some corners are none of the vertices {vertices.shape}")
    if colours.shape not in ((3,), (2, 3), (len(loops), 1, 3), (len(loops), 2, 3)):
        raise ShapeError(f"colours: expected (3,), (2, 3) or (q, 2, 3), got {colours.shape}")
    a, b, d = (vertices[loops[:, i]] for i in (0, 1, 3))
    side = real(tile, "tile").astype(np.float64)
    if side.shape not in ((), (len(loops),)) or not (side > 1e-50).all():
        raise CvnotesError(f"tile: expected a positive length, or one a face, got {tile!r}")
    across, down = (np.linalg.norm(p - a, axis=-1) / side for p in (b, d))
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


def from_above(scene: Scene, cut: float) -> tuple[Array, Array]:
    """Return a plan of a scene of boxes: outlines (n, 4, 2), x and z, and their colours (n, 3).

    It has what is level between the ground and the height y = cut, the highest last.
    """
    heights = scene.faces[..., 1].mean(axis=1)
    level = (np.ptp(scene.faces[..., 1], axis=1) == 0) & (cut < heights) & (heights < heights.max())
    order = np.argsort(-heights, kind="stable")
    some = order[level[order]]
    return scene.faces[some][..., [0, 2]], scene.colours[2 * some, 0]


def outlined(corners: Array) -> Array:
    """Divide the edges of polygons (..., k, 3) into short pieces that a lens may bend."""
    edges = np.roll(corners, -1, axis=-2) - corners
    pieces = corners[..., None, :] + np.arange(16)[:, None] / 16 * edges[..., None, :]
    *many, k, dimension = corners.shape
    return np.asarray(pieces.reshape(*many, 16 * k, dimension))
