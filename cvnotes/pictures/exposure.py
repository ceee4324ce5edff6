"""From light to numbers: what a sensor makes of a picture.

In the order in which it happens: the optics blur, the camera moves while the shutter is open,
the amplifier multiplies, noise is added, the value is rounded to 8 bits and clipped, the file
format compresses.
"""

import io
from functools import partial

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    MOST_BLUR,
    Array,
    CvnotesError,
    ShapeError,
    blur_width,
    generator,
    guarded,
    number,
    numbers,
    whole,
)

Image = npt.NDArray[np.uint8]


def _picture(x: npt.ArrayLike, name: str) -> Array:
    light = numbers(x, name)
    if light.ndim not in (2, 3) or light.shape[2:] not in ((), (3,)) or light.size == 0:
        raise ShapeError(
            f"{name}: expected a picture (height, width) or (height, width, 3) with at least one "
            f"pixel, got {light.shape}"
        )
    return light


def _path(x: npt.ArrayLike, name: str) -> Array:
    path = numbers(x, name)
    if path.shape != (2,):
        raise ShapeError(f"{name}: expected (du, dv) in pixels, got shape {path.shape}")
    if np.abs(path).max() > MOST_BLUR:
        raise CvnotesError(f"{name}: expected at most {MOST_BLUR} pixels, got {x!r}")
    return path


def _noise_from_somewhere(noise: float = 0.0, rng: object = None, **_: object) -> None:
    if noise and rng is None:
        raise CvnotesError("noise needs an rng; pass rng=numpy.random.default_rng(seed)")


_positive = partial(number, at_least=0)
_quality = partial(whole, at_most=100)


def _eight_bits(x: npt.ArrayLike, name: str) -> Image:
    picture = np.asarray(_picture(x, name))
    if not (picture == np.clip(np.rint(picture), 0, 255)).all():
        raise CvnotesError(f"{name}: expected grey levels of 8 bits, whole numbers from 0 to 255")
    return picture.astype(np.uint8)


@guarded(
    radiance=_picture,
    blur=blur_width,
    motion=_path,
    noise=_positive,
    gain=_positive,
    rng=lambda x, name: None if x is None else generator(x, name),
    jpeg=lambda x, name: None if x is None else _quality(x, name),
    also=_noise_from_somewhere,
)
def expose(
    radiance: Array,
    *,
    blur: float = 0.0,
    motion: tuple[float, float] = (0.0, 0.0),
    noise: float = 0.0,
    gain: float = 1.0,
    jpeg: int | None = None,
    rng: np.random.Generator | None = None,
) -> Image:
    """Turn the light that falls on each pixel into an 8-bit picture.

    Parameters
    ----------
    radiance : array_like, shape (height, width) or (height, width, 3)
        Mean light on each pixel on the scale of the grey levels, 0 to 255; more is clipped.
    blur : float
        Standard deviation in pixels of a Gaussian blur.
    motion : (du, dv)
        How far in pixels the picture moves, evenly, while the shutter is open; the picture shows
        things where they were in the middle of that time.
    noise : float
        Standard deviation in grey levels, the same for every pixel and independent.
    gain : float
        Factor on the light, applied before the noise.
    jpeg : int, optional
        Quality, 1 to 100, of a JPEG compression; none by default.
    rng : numpy.random.Generator, optional
        Where the noise comes from; needed if there is any.

    Returns
    -------
    ndarray of uint8, same shape
        The picture. The same seed gives the same picture on every machine, but with `jpeg` only
        up to a grey level or so, for decoders are free to round differently.

    Notes
    -----
    Beyond its border the picture is taken to go on as its last pixels. The blur works on what
    the pixels have already averaged, and shifts a sharp edge by up to 0.02 px (at 0.7 px blur);
    `render` blurs before it averages, and shifts nothing.

    Examples
    --------
    >>> expose([[0.0, 99.5, 100.4, 300.0]])
    array([[  0, 100, 100, 255]], dtype=uint8)
    """
    light = radiance  # a copy already
    if blur:
        light = gaussian_blur.inside(light, blur)
    if np.any(motion):
        light = _smeared(light, np.asarray(motion))
    light *= gain
    if noise and rng is not None:
        light += rng.normal(0.0, noise, light.shape)
    image = np.rint(light).clip(0, 255).astype(np.uint8, order="C")
    return image if jpeg is None else compress.inside(image, jpeg)


@guarded(light=_picture, sigma=blur_width)
def gaussian_blur(light: Array, sigma: float) -> Array:
    """Blur a picture (height, width, …) by a Gaussian of `sigma` pixels.

    Examples
    --------
    >>> gaussian_blur(np.array([[0.0, 0.0, 1.0, 0.0, 0.0]]), 0.5).round(3)
    array([[0.   , 0.106, 0.787, 0.106, 0.   ]])
    """
    from scipy.ndimage import gaussian_filter1d

    for axis in (0, 1) if sigma else ():
        light = gaussian_filter1d(light, sigma, axis=axis, mode="nearest", truncate=5.0)
    return light


def _smeared(light: Array, motion: Array) -> Array:
    """Smear a picture (height, width, …) along the straight way (du, dv), half to either side."""
    from scipy.ndimage import correlate

    # The mean over the way of bilinear interpolation, as weights of the neighbours.
    n = max(1, 64 * int(np.ceil(np.abs(motion).max())))
    way = ((np.arange(n) + 0.5) / n - 0.5)[:, None] * motion
    reach = np.ceil(np.abs(motion) / 2).astype(int)
    hats = [
        np.maximum(1 - np.abs(np.arange(-r, r + 1) - s[:, None]), 0)
        for r, s in zip(reach, way.T, strict=True)
    ]
    weights = np.einsum("nv,nu->vu", hats[1], hats[0]) / n
    kernel = weights.reshape(weights.shape + (1,) * (light.ndim - 2))
    return np.asarray(correlate(light, kernel, mode="nearest"))


@guarded(image=_eight_bits, quality=_quality)
def compress(image: Image, quality: int) -> Image:
    """Write a picture (height, width) or (height, width, 3) as JPEG and read it again.

    Examples
    --------
    >>> compress(np.full((8, 8), 128, np.uint8), 90)[0, 0]
    np.uint8(128)
    """
    from PIL import Image as PillowImage

    file = io.BytesIO()
    PillowImage.fromarray(image).save(file, "JPEG", quality=quality)
    return np.asarray(PillowImage.open(file))
