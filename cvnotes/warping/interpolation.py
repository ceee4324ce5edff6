"""A picture made ready to be looked up at many positions at once."""

from functools import cached_property
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, Image, checked_fill, checked_image, positions

Method = Literal["bilinear", "nearest"]
Border = Literal["constant", "replicate", "reflect"]
Real = npt.NDArray[Any]  # float32 or float64


def bilinear(I1: Real, I2: Real, I3: Real, I4: Real, du: Real, dv: Real) -> Real:
    """Interpolate between the four pixels around a position.

    Parameters
    ----------
    I1, I2, I3, I4 : ndarray
        The picture at (u_k, v_k), (u_k + 1, v_k), (u_k, v_k + 1) and (u_k + 1, v_k + 1).
    du, dv : ndarray
        Fractions u − u_k and v − v_k, from 0 to 1.

    Notes
    -----
    Along u first, then along v:

        I_a = (I2 − I1) Δu + I1,    I_b = (I4 − I3) Δu + I3,    I = (I_b − I_a) Δv + I_a,

    which is (1−Δu)(1−Δv) I1 + Δu(1−Δv) I2 + (1−Δu)Δv I3 + ΔuΔv I4. The notes' expanded form has
    the sign of I1 wrong in its last factor, I4 − I3 − I2 + I1 (erratum E42).

    References
    ----------
    .. [1] Notes 2b.5, "Forward/Backward Mapping".

    Examples
    --------
    >>> bilinear(*np.array([10.0, 20.0, 30.0, 80.0, 0.5, 0.5]))  # the mean of the four
    array(35.)
    """
    I_a = (I2 - I1) * du + I1
    I_b = (I4 - I3) * du + I3
    return np.asarray((I_b - I_a) * dv + I_a)


def interpolate(
    image: npt.ArrayLike,
    m: npt.ArrayLike,
    *,
    method: Method = "bilinear",
    border: Border = "constant",
    fill: npt.ArrayLike = 0,
) -> Image:
    """Look a picture up at positions that need not be pixels.

    Parameters
    ----------
    image : ndarray, shape (height, width) or (height, width, channels)
        uint8, uint16, float32 or float64.
    m : array_like, shape (..., 2)
        Positions (u, v) in pixels; NaN where there is nothing to show.
    method : {"bilinear", "nearest"}
        Between four pixels, or the closest one; half-way to the right and downwards.
    border : {"constant", "replicate", "reflect"}
        What lies outside: `fill`, the outermost pixel, or the picture mirrored at the outermost
        pixel centres.
    fill : number, or one per channel
        What lies outside of a constant border, and what NaN shows under every border.

    Returns
    -------
    ndarray, shape (...) or (..., channels), of the image's dtype
        Integers are rounded to the nearest, halves upwards.

    Notes
    -----
    Nearest rounds both coordinates, bilinear takes the floor of both; the notes' mixture of floor
    and round (erratum E40) does neither.

    References
    ----------
    .. [1] Notes 2b.5, "Forward/Backward Mapping".

    Examples
    --------
    >>> image = np.array([[10.0, 20.0], [30.0, 80.0]])
    >>> interpolate(image, [[0.5, 0.5], [0.25, 0.0], [7.0, 7.0]])
    array([35. , 12.5,  0. ])
    >>> interpolate(image, [[0.5, 0.5], [0.4, 0.0]], method="nearest")
    array([80., 10.])
    """
    sampler = Sampler(image, method, border, fill)
    xy = positions(m, "m")
    values = np.empty((xy.size // 2, sampler.fill.size), sampler.dtype)
    sampler.look_up(xy.reshape(-1, 2).T.copy(), values)
    return values.reshape(xy.shape[:-1] + sampler.channels)


class Sampler:
    """A picture made ready to be looked up at many positions; see `interpolate`."""

    def __init__(
        self, image: npt.ArrayLike, method: Method, border: Border, fill: npt.ArrayLike
    ) -> None:
        picture = checked_image(image)
        if method not in ("bilinear", "nearest"):
            raise CvnotesError(f'method: expected "bilinear" or "nearest", got {method!r}')
        if border not in ("constant", "replicate", "reflect"):
            raise CvnotesError(
                f'border: expected "constant", "replicate" or "reflect", got {border!r}'
            )
        self.method, self.border, self.dtype = method, border, picture.dtype
        self.height, self.width = picture.shape[:2]
        self.channels = picture.shape[2:]
        self.fill = checked_fill(fill, picture)
        self.stride = self.width + 3
        self.strides = np.array([1.0, self.stride])
        self.limits = np.array([[self.width], [self.height]], dtype=np.float64)
        self.picture = picture

    @cached_property
    def planes(self) -> list[npt.NDArray[Any]]:
        """Each channel framed with `fill`, so that no position needs a test of its own."""
        framed = np.empty((self.fill.size, self.height + 3, self.stride), self.dtype)
        framed[:] = self.fill[:, None, None]
        pixels = self.picture.reshape(self.height, self.width, -1)
        framed[:, 1:-2, 1:-2] = np.moveaxis(pixels, -1, 0)
        return [plane.reshape(-1) for plane in framed]

    @cached_property
    def all_finite(self) -> bool:
        """Whether every pixel, and what fills, is a number."""
        return self.dtype.kind != "f" or all(np.isfinite(plane).all() for plane in self.planes)

    @np.errstate(invalid="ignore")  # NaN and infinite pixels are passed on, not complained about
    def look_up(self, m: Array, values: Image) -> None:
        """Write the picture at m (2, n) into values (n, channels); m is written over."""
        nowhere = None
        if self.border != "constant":
            nowhere = ~np.isfinite(m).all(axis=0)
            m = np.where(np.isfinite(m), m, 0)
            m = np.stack(
                [_fold(m[0], self.width, self.border), _fold(m[1], self.height, self.border)]
            )
        nearest = self.method == "nearest"
        m = self._inside(np.floor(m + 0.5) if nearest else m)
        m_k = np.floor(m)
        pixel = self._index(m_k)
        m -= m_k
        fractions = m.astype(np.float32 if self.dtype == np.uint8 else np.float64, copy=False)
        for k, plane in enumerate(self.planes):
            values[:, k] = (
                plane.take(pixel) if nearest else self._bilinear(plane, pixel, *fractions)
            )
        if nowhere is not None:
            values[nowhere] = self.fill

    def _bilinear(
        self, plane: npt.NDArray[Any], index: npt.NDArray[np.intp], du: Real, dv: Real
    ) -> npt.NDArray[Any]:
        I1, I2, I3, I4 = (
            plane[below + right :].take(index).astype(du.dtype, copy=False)
            for below in (0, self.stride)
            for right in (0, 1)
        )
        if not self.all_finite:  # 0 · NaN is not 0
            I2, I4 = np.where(du == 0, I1, I2), np.where(du == 0, I3, I4)
            I3, I4 = np.where(dv == 0, I1, I3), np.where(dv == 0, I2, I4)
        I_a, I_b = _between(I1, I2, du), _between(I3, I4, du)
        value = _between(I_a, I_b, dv)
        if self.dtype.kind == "u":
            value += 0.5
        return value.astype(self.dtype, copy=False)

    def _inside(self, m: Array) -> Array:
        """Keep positions between −1 and width or height, where the frame begins; NaN at −1."""
        np.fmax(m, -1.0, out=m)
        return np.minimum(m, self.limits, out=m)

    def _index(self, m_k: Array) -> npt.NDArray[np.intp]:
        """Place whole pixels in the framed picture, whose frame begins at (−1, −1)."""
        index = self.strides @ m_k
        index += self.stride + 1
        return np.asarray(index, dtype=np.intp)


def _between(a: Real, b: Real, t: Real) -> Real:
    """Return a + (b − a) t, written over b: the steps of `bilinear`."""
    b -= a
    b *= t
    b += a
    return b


def _fold(x: Array, n: int, border: Border) -> Array:
    """Bring positions outside back into the picture, 0 to n − 1."""
    if border == "replicate" or n == 1:
        return np.clip(x, 0, n - 1)
    return np.asarray((n - 1) - np.abs(np.abs(x) % (2 * n - 2) - (n - 1)))
