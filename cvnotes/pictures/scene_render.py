"""From the rays through a pixel to the light on it, and to its depth."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, InputTypeError, chunks, target_size, whole
from cvnotes.camera import Camera, move
from cvnotes.camera.model import is_camera
from cvnotes.pictures.all_round import through_a_cube
from cvnotes.pictures.antialiasing import (
    TILE,
    changing,
    crossed,
    in_tiles,
    out_of_tiles,
    pixel_centres,
    tile_order,
    within_pixel,
)
from cvnotes.pictures.meshes import Scene
from cvnotes.pictures.raycast import first_hits
from cvnotes.pictures.surfaces import Surfaces

_RAYS = 131_072  # at a time, of pixels that are looked at closely


def render_scene(scene: Scene, camera: Camera, *, samples: int = 16) -> npt.NDArray[np.uint8]:
    """Take a picture of a scene, with the shadows that its parts cast on each other.

    For noise, blur or JPEG hand `radiance` to `cvnotes.pictures.exposure.expose`.

    Parameters
    ----------
    scene : Scene
        Triangles in the WRF.
    camera : Camera
        The pixel that shows a vertex is ``camera.project(scene.vertices)``.
    samples : int
        Rays through each pixel in which something changes. In chapter 0's pictures corners are
        found to 0.010 px with 16 of them and to 0.007 px with 64. A fisheye's picture, up to 180°
        and beyond, is put together from six such pictures, the sides of a cube.

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
    >>> from cvnotes.pictures.meshes import box
    >>> from cvnotes.camera import look_at
    >>> pose = look_at([3, -2, -5], [0, 0, 0])
    >>> camera = Camera(intrinsics(80, 80, 31.5, 23.5), pose, size=(64, 48))
    >>> render_scene(box((-1, 1), (-1, 1), (-1, 1)), camera).shape
    (48, 64, 3)
    """
    light = radiance(scene, camera, samples=samples)
    return np.asarray(np.rint(light.clip(0, 255)), dtype=np.uint8)


def radiance(scene: Scene, camera: Camera, *, samples: int = 16) -> Array:
    """Return the mean light on each pixel, on the scale of grey levels, unrounded.

    Parameters are those of `render_scene`.

    Returns
    -------
    ndarray, shape (height, width, 3)
        Red, green, blue; 255 is white, lamps are brighter.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.pictures.meshes import box
    >>> lamp = box((-1, 1), (-1, 1), (3, 4), (2.0, 2.0, 2.0))
    >>> bool(radiance(lamp, Camera(intrinsics(80, 80, 32, 24), size=(64, 48))).max() > 255)
    True
    """
    samples = _guard(scene, camera, samples)
    if camera.lens.wide:
        return through_a_cube(camera, lambda side: radiance(scene, side, samples=samples))
    # 1. one ray through the middle of each pixel
    surfaces = Surfaces.seen_by(camera, scene)
    middle = pixel_centres(camera.size)
    xy = camera.ideal(middle)
    colour, left, place = surfaces.colours_along(in_tiles(xy))
    planes = np.stack([out_of_tiles(x, camera.size) for x in (*(255 * colour), *place)])
    # 2. many, where a colour or a square changes, a shadow ends or an edge passes
    busy = changing(np.moveaxis(planes, 0, -1))
    busy |= crossed(camera, move(camera.G, scene.vertices)[scene.edges], xy)
    picture: Array = out_of_tiles(left, camera.size)[..., None] * np.stack([*planes[:3]], axis=-1)
    picture[busy] = 255 * _supersampled(surfaces, camera, middle[busy], samples)
    return picture


def depth_map(scene: Scene, camera: Camera) -> Array:
    """Return the depth z in the CRF of what each pixel's middle shows.

    Returns
    -------
    ndarray, shape (height, width)
        In the unit of the scene; NaN where there is nothing, or where the lens model ends.

    Notes
    -----
    This is z, not the distance along the ray, and of one point in each pixel: at an edge it is the
    depth of one side, and no mean of both.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.pictures.meshes import quads
    >>> wall = quads([[-9, -9, 5], [9, -9, 5], [9, 9, 5], [-9, 9, 5]], [[0, 1, 2, 3]], (1, 1, 1))
    >>> float(depth_map(wall, Camera(intrinsics(80, 80, 32, 24), size=(64, 48)))[0, 0])
    5.0
    """
    _guard(scene, camera)
    xy = in_tiles(camera.ideal(pixel_centres(camera.size)))
    hits = first_hits(move(camera.G, scene.vertices)[scene.triangles], xy)
    return out_of_tiles(hits.depth, camera.size)


def _guard(scene: Scene, camera: Camera, samples: int = 1) -> int:
    if not isinstance(scene, Scene):
        raise InputTypeError(
            f"scene: expected a Scene, got {type(scene).__name__}; "
            "cvnotes.pictures.scenes.target_scene makes one of a target"
        )
    is_camera(camera, "camera")
    target_size(camera.size)
    return whole(samples, "samples")


def _supersampled(surfaces: Surfaces, camera: Camera, m: Array, samples: int) -> Array:
    """Return the mean colours (n, 3) that `samples` rays in each of the pixels m (n, 2) see."""
    out, order, offsets = np.empty((len(m), 3)), tile_order(m), within_pixel(samples)
    for part in chunks(len(m), max(TILE, _RAYS // samples)):
        some = order[part]
        some = np.resize(some, -(-len(some) // TILE) * TILE)  # whole groups; a few twice
        xy = camera.ideal(m[some, None] + offsets).reshape(-1, TILE * samples, 2)
        colour, left, _ = surfaces.colours_along(xy)
        out[some] = (left * colour).reshape(3, -1, samples).mean(axis=2).T
    return out
