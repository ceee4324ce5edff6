"""Pictures of scenes, as a known camera takes them, and how deep they are.

Every pixel is the mean over its square of what the rays through it meet. A ray in the middle is
enough where nothing happens; where colours change, or an edge passes, many rays are cast. All
rays go through the lens exactly.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.camera import Camera
from cvnotes.errors import Array, CvnotesError, InputTypeError, target_size
from cvnotes.meshes import Scene, Surroundings
from cvnotes.raycast import Indices, edge_functions, first_hits
from cvnotes.rigid import move
from cvnotes.sampling import (
    TILE,
    Mask,
    changing,
    crossed,
    in_tiles,
    out_of_tiles,
    pixel_centres,
    tile_order,
    within_pixel,
)

_PIXELS = 2048  # looked at closely at a time


def render_scene(
    scene: Scene, camera: Camera, *, samples: int = 64, engine: str = "auto"
) -> npt.NDArray[np.uint8]:
    """Take a picture of a scene.

    For noise, blur or JPEG hand `radiance` to `cvnotes.sensor.expose`.

    Parameters
    ----------
    scene : Scene
        Triangles in the WRF.
    camera : Camera
        The pixel that shows a vertex is ``camera.project(scene.vertices)``.
    samples : int
        Rays through each pixel in which something changes.
    engine : {"auto", "own", "embree"}
        See `cvnotes.raycast.first_hits`.

    Returns
    -------
    ndarray of uint8, shape (height, width, 3)
        Red, green, blue. Pixels beyond the lens's validity are black.

    References
    ----------
    .. [1] Notes 2b.3, "Image Formation Flow", read from the pixel to the world.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.meshes import box
    >>> from cvnotes.rigid import look_at
    >>> pose = look_at([3, -2, -5], [0, 0, 0])
    >>> camera = Camera(intrinsics(80, 80, 31.5, 23.5), pose, size=(64, 48))
    >>> render_scene(box((-1, 1), (-1, 1), (-1, 1)), camera).shape
    (48, 64, 3)
    """
    light = radiance(scene, camera, samples=samples, engine=engine)
    return np.asarray(np.rint(light.clip(0, 255)), dtype=np.uint8)


def radiance(scene: Scene, camera: Camera, *, samples: int = 64, engine: str = "auto") -> Array:
    """Give the mean light on each pixel, on the scale of grey levels, unrounded.

    Parameters are those of `render_scene`.

    Returns
    -------
    ndarray, shape (height, width, 3)
        Red, green, blue; 255 is white, lamps are brighter.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.meshes import box
    >>> lamp = box((-1, 1), (-1, 1), (3, 4), (2.0, 2.0, 2.0))
    >>> bool(radiance(lamp, Camera(intrinsics(80, 80, 32, 24), size=(64, 48))).max() > 255)
    True
    """
    _guard(scene, camera, samples)
    # 1. one ray through the middle of each pixel
    surfaces = _Surfaces.seen_by(camera, scene)
    middle = pixel_centres(camera.size)
    xy = camera.ideal(middle)
    colour, square = surfaces.look(in_tiles(xy), engine)
    signature = np.moveaxis(np.concatenate([255 * colour, square]), 0, -1)
    # 2. many, where a colour or a square changes or an edge passes
    busy = changing(out_of_tiles(signature, camera.size))
    busy |= crossed(camera, move(camera.G, scene.vertices)[scene.edges], xy)
    picture = out_of_tiles(np.moveaxis(colour, 0, -1), camera.size)
    picture[busy] = _look_closely(surfaces, camera, middle[busy], samples, engine)
    return 255 * picture


def depth_map(scene: Scene, camera: Camera, *, engine: str = "auto") -> Array:
    """Give the depth z in the CRF of what each pixel's middle shows.

    Returns
    -------
    ndarray, shape (height, width)
        In the unit of the scene; NaN where there is nothing, or where the lens model ends.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.meshes import quads
    >>> wall = quads([[-9, -9, 5], [9, -9, 5], [9, 9, 5], [-9, 9, 5]], [[0, 1, 2, 3]], (1, 1, 1))
    >>> float(depth_map(wall, Camera(intrinsics(80, 80, 32, 24), size=(64, 48)))[0, 0])
    5.0
    """
    _guard(scene, camera)
    xy = in_tiles(camera.ideal(pixel_centres(camera.size)))
    hits = first_hits(move(camera.G, scene.vertices)[scene.triangles], xy, engine=engine)
    return out_of_tiles(hits.depth, camera.size)


def _guard(scene: Scene, camera: Camera, samples: int = 1) -> None:
    if not isinstance(scene, Scene):
        raise InputTypeError(
            f"scene: expected a Scene, got {type(scene).__name__}; "
            "cvnotes.scenes.target_scene makes one of a target"
        )
    if not isinstance(camera, Camera):
        raise InputTypeError(f"camera: expected a Camera, got {type(camera).__name__}")
    target_size(camera.size)
    if not isinstance(samples, int) or samples < 1:
        raise CvnotesError(f"samples: expected a whole number of rays, at least 1, got {samples!r}")


class _Surfaces(NamedTuple):
    """A scene in a camera's frame, with the light already on it."""

    corners: Array  # (m, 3, 3) in the CRF
    forms: Array  # (9, m): coefficients of u w, v w and w along a ray (x, y, 1)
    checkered: Mask  # (m,)
    palette: Array  # (3, 2 m): both colours of each triangle
    extent: Array  # (2, m)
    around: Surroundings
    down: Array  # (3,) the world's y axis in the CRF

    @classmethod
    def seen_by(cls, camera: Camera, scene: Scene) -> "_Surfaces":
        corners = move(camera.G, scene.vertices)[scene.triangles]
        n, _ = edge_functions(corners)
        # The barycentric weights are e_i / Σ e_i; u and v are mixed by them.
        uv1 = np.concatenate([scene.uv, np.ones_like(scene.uv[..., :1])], axis=-1)
        forms = (uv1.swapaxes(1, 2) @ n).reshape(-1, 9).T.copy()
        colours = scene.colours * _shade(scene, camera)[:, None, None]
        return cls(
            corners,
            forms,
            (scene.colours[:, 0] != scene.colours[:, 1]).any(axis=1),
            colours.reshape(-1, 3).T.copy(),
            scene.extent.T.copy(),
            scene.around,
            camera.R[:, 1],
        )

    def look(self, xy: Array, engine: str) -> tuple[Array, Array]:
        """Give the colours (3, groups, k) that rays (groups, k, 2) see, and the squares (2, …)."""
        triangle, depth = first_hits(self.corners, xy, engine=engine)
        x, y = np.moveaxis(xy, -1, 0).copy()
        none = triangle < 0
        square = self._squares(triangle, x, y)
        odd = (square.sum(axis=0) % 2).astype(np.int64)
        colour = np.take(self.palette, np.where(none, 0, 2 * triangle + odd), axis=1)
        if np.isfinite(self.around.haze):
            clear = np.exp(-depth * np.sqrt(1 + x * x + y * y) / self.around.haze)
            horizon = np.array(self.around.horizon)[:, None, None]
            colour = horizon + clear * (colour - horizon)
        colour[:, none] = self._sky(x[none], y[none])
        return colour, square

    def _squares(self, triangle: Indices, x: Array, y: Array) -> Array:
        """Give the square (i, j) of the checker, as (2, …): (0, 0) where there is none.

        Around the checker it is (−1, 0), which is odd: the second colour.
        """
        square = np.zeros((2, *x.shape))
        on = (triangle >= 0) & self.checkered[triangle]
        t, x, y = triangle[on], x[on], y[on]
        f = self.forms[:, t]
        w = f[6] * x + f[7] * y + f[8]
        u, v = (f[0] * x + f[1] * y + f[2]) / w, (f[3] * x + f[4] * y + f[5]) / w
        columns, rows = self.extent[:, t]
        around = ((u < 0) | (u >= columns)) & np.isfinite(columns)
        around |= ((v < 0) | (v >= rows)) & np.isfinite(rows)
        square[:, on] = np.where(around, [[-1], [0]], np.floor([u, v]))
        return square

    def _sky(self, x: Array, y: Array) -> Array:
        """Give the background (3, n) along rays: from the horizon up to the zenith."""
        down = x * self.down[0] + y * self.down[1] + self.down[2]
        height = np.clip(-down / np.sqrt(1 + x * x + y * y), 0, 1)
        horizon, zenith = (np.array(c)[:, None] for c in (self.around.horizon, self.around.zenith))
        # Beyond the lens's validity there is no ray, and no light.
        return np.where(np.isnan(x), 0, (1 - height) * horizon + height * zenith)


def _shade(scene: Scene, camera: Camera) -> Array:
    """Give the brightness (m,) of the side of each triangle that the camera sees.

    Lambert's cosine law, softened: it falls to the ambient light only on the far side.
    """
    light, ambient = np.array(scene.around.light), scene.around.ambient
    towards = np.einsum("ij,ij->i", camera.centre - scene.corners[:, 0], scene.normals)
    cosine = scene.normals @ (light / np.linalg.norm(light)) * np.where(towards < 0, -1, 1)
    return np.asarray(ambient + (1 - ambient) * (1 + cosine) / 2)


def _look_closely(
    surfaces: _Surfaces, camera: Camera, m: Array, samples: int, engine: str
) -> Array:
    """Give the mean colours (n, 3) that `samples` rays in each of the pixels m (n, 2) see."""
    out, order, offsets = np.empty((len(m), 3)), tile_order(m), within_pixel(samples)
    for start in range(0, len(m), _PIXELS):
        some = order[start : start + _PIXELS]
        some = np.resize(some, -(-len(some) // TILE) * TILE)  # whole groups; a few twice
        xy = camera.ideal(m[some, None] + offsets).reshape(-1, TILE * samples, 2)
        colour, _ = surfaces.look(xy, engine)
        out[some] = colour.reshape(3, -1, samples).mean(axis=2).T
    return out
