"""Pictures from known cameras: every estimate can then be held against the truth.

A pixel is the mean of the scene over its square area, seen through the lens and its blur, and
not a sample of it: `faces` finds the curves between flat colours, `pixel_means` integrates them
exactly, `exposure` makes 8-bit numbers of the result.
"""

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    MOST,
    Array,
    CvnotesError,
    ShapeError,
    blur_width,
    generator,
    number,
    numbers,
    target_size,
)
from cvnotes.camera import Camera
from cvnotes.pictures.exposure import Image, expose, gaussian_blur
from cvnotes.pictures.faces import Target, edges_in_picture
from cvnotes.pictures.pixel_means import edge_means, polygon_means
from cvnotes.pictures.placing import target_and_camera


def render(
    target: Target,
    camera: Camera,
    *,
    blur: float = 0.0,
    motion: tuple[float, float] = (0.0, 0.0),
    noise: float = 0.0,
    light: tuple[float, float] = (0.0, 0.0),
    vignetting: float = 0.0,
    gain: float = 1.0,
    jpeg: int | None = None,
    background: npt.ArrayLike = 110.0,
    margin: float = 1.0,
    rng: np.random.Generator | None = None,
) -> Image:
    """Photograph a target with a known camera.

    Parameters
    ----------
    target : Target
        Anything with ``faces``: chessboards and their poses. The nearest face counts.
    camera : Camera
        Who photographs; its G carries the target's frame into the camera's.
    blur : float
        Standard deviation in pixels of the optical blur (a real lens gives about 0.7).
    motion : (du, dv)
        How far in pixels the picture moves while the shutter is open.
    noise : float
        Standard deviation of the sensor's noise in grey levels; needs `rng`.
    light : (right, down)
        Lighting gradient: by which fraction it is brighter at the right and at the lower border
        than in the middle of the picture (and darker at the opposite ones).
    vignetting : float
        Fraction of the light that is lost in the pixel farthest from the principal point; the
        loss grows with the square of the distance.
    gain : float
        Factor on the light; what exceeds 255 is clipped.
    jpeg : int, optional
        Quality, 1 to 100, of a JPEG compression.
    background : float or (height, width)
        What is behind the target, and where the lens shows nothing: a grey level, or a picture
        (see `clutter`).
    margin : float
        White paper around the outer squares, in squares.
    rng : numpy.random.Generator, optional
        Where the noise comes from.

    Returns
    -------
    ndarray of uint8, shape (height, width)
        The picture. Paper has grey level 220, ink 30, before all effects.

    Notes
    -----
    Grey levels are exact to 0.01 before they are rounded; a corner lies where
    ``camera.project`` says to 0.0002 px. Pixel centres are integers. There is no depth of field, no
    rolling shutter and no mosaic of colours, and paper is as bright from the side as from above.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.targets import Chessboard
    >>> camera = Camera(intrinsics(800, 800, 320, 240)).moved(
    ...     [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 400], [0, 0, 0, 1]])
    >>> render(Chessboard((9, 6), 25.0), camera)[238:243, 318:323]  # the first corner
    array([[ 30,  30, 125, 220, 220],
           [ 30,  30, 125, 220, 220],
           [125, 125, 125, 125, 125],
           [220, 220, 125,  30,  30],
           [220, 220, 125,  30,  30]], dtype=uint8)
    """
    target_and_camera(target, camera)
    sigma = blur_width(blur, "blur")
    white = number(margin, "margin", at_least=0, at_most=MOST)
    behind = _background(background, target_size(camera.size))
    picture = _paint(target, camera, behind, white, sigma)
    _shade(picture, camera, light, vignetting)
    return expose(picture, motion=motion, noise=noise, gain=gain, jpeg=jpeg, rng=rng)


def clutter(size: tuple[int, int], *, rng: np.random.Generator) -> Array:
    """Make an untidy background for `render`: 40 flat things with straight edges, overlapping.

    Parameters
    ----------
    size : (width, height)
        Size of the picture.
    rng : numpy.random.Generator
        Where the things come from.

    Returns
    -------
    ndarray, shape (height, width)
        Grey levels from 20 to 200.

    Examples
    --------
    >>> clutter((64, 48), rng=np.random.default_rng(0)).shape
    (48, 64)
    """
    width, height = size = target_size(size)
    generator(rng)
    picture = np.full((height, width), 110.0)
    for _ in range(40):
        # Corners in order of their angle as seen from the middle, so that no sides cross.
        angle = np.sort(2 * np.pi * (np.arange(5) + rng.random(5)) / 5)[:, None]
        radius = max(size) * rng.uniform(0.02, 0.2) * rng.uniform(0.5, 1.0, (5, 1))
        outline = rng.random(2) * size + radius * np.hstack([np.cos(angle), np.sin(angle)])
        level = rng.uniform(20, 200)
        picture += polygon_means(outline, size) * (level - picture)
    return picture


def _background(background: npt.ArrayLike, size: tuple[int, int]) -> Array:
    """Guard the background: a grey level (), or a picture (height, width)."""
    given = numbers(background, "background")
    if given.shape not in [(), size[::-1]]:
        raise ShapeError(
            f"background: expected a grey level, or a picture {size[::-1]}, as large as the "
            f"camera's, got shape {given.shape}"
        )
    return given


def _paint(target: Target, camera: Camera, behind: Array, margin: float, blur: float) -> Array:
    """Put the target before its background: (height, width), sharp but for `blur`."""
    start, end, jump = edges_in_picture(target, camera, margin, step=max(1.0, blur / 2))
    if behind.ndim == 0:
        # Where all that is behind is flat, the jump from there to the target is known.
        jump = jump[:, :1] - jump[:, 1:] * behind
        painted = edge_means(start, end, jump, camera.size, blur=blur)[0]
        painted += behind
        return np.asarray(painted)
    if blur:
        behind = gaussian_blur.inside(behind, blur)
    grey, covered = edge_means(start, end, jump, camera.size, blur=blur)
    painted = (1 - covered) * behind
    painted += grey
    return np.asarray(painted)


def _shade(picture: Array, camera: Camera, light: npt.ArrayLike, vignetting: float) -> None:
    """Light a picture (height, width) unevenly."""
    gradient, loss = numbers(light, "light"), number(vignetting, "vignetting", at_least=0)
    if gradient.shape != (2,) or np.abs(gradient).sum() > 1:
        raise CvnotesError(
            f"light: expected (right, down), together at most 1, got {gradient.tolist()}"
        )
    if loss > 1:
        raise CvnotesError(f"vignetting = {loss:g} but no more than all light (1) can be lost")
    (width, height), (u0, v0) = camera.size, camera.A[:2, 2]
    u, v = np.arange(width), np.arange(height)[:, None]
    if gradient.any():
        across, down = (2 * u + 1) / width - 1, (2 * v + 1) / height - 1  # ±1 at the borders
        picture *= 1 + gradient[0] * across + gradient[1] * down
    if loss:
        r2 = (u - u0) ** 2 + (v - v0) ** 2
        picture *= 1 - loss * r2 / r2.max()
