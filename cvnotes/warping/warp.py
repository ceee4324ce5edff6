"""The two ways to move a picture by a map: forward, and backward (notes 2b.5)."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    CvnotesError,
    Image,
    ShapeError,
    checked_fill,
    checked_image,
    number,
    points,
    target_size,
)
from cvnotes.warping.interpolation import Border, Method, Sampler
from cvnotes.warping.maps import plane_map
from cvnotes.warping.pixel_map import Mapping, tiles


class ForwardWarp(NamedTuple):
    """A picture moved forward, and how many source pixels each of its pixels received."""

    image: Image
    hits: npt.NDArray[np.intp]

    @property
    def holes(self) -> int:
        """Number of target pixels that received nothing."""
        return int(np.count_nonzero(self.hits == 0))

    @property
    def folds(self) -> int:
        """Number of target pixels that received more than one source pixel."""
        return int(np.count_nonzero(self.hits > 1))


def forward_warp(
    image: npt.ArrayLike,
    mapping: Mapping,
    size: tuple[int, int] | None = None,
    *,
    fill: npt.ArrayLike = 0,
) -> ForwardWarp:
    """Send every pixel of the source to the closest pixel of the target.

    Parameters
    ----------
    image : ndarray, shape (height, width) or (height, width, channels)
        The source; uint8, uint16, float32 or float64.
    mapping : PixelMap, callable or array of shape (height, width, 2)
        Source pixels (u, v) ↦ target pixels (u', v'); NaN for those that are not to be sent.
    size : (width, height), optional
        Size of the target; by default that of the source.
    fill : number, or one per channel
        What holes show.

    Returns
    -------
    ForwardWarp
        ``image``, and ``hits``: how many source pixels each target pixel received. 0 is a hole,
        2 or more a fold; where several arrive, the last in reading order stays.

    Notes
    -----
    (u'_k, v'_k) = (⌊u' + ½⌋, ⌊v' + ½⌋). Holes appear wherever the map stretches, folds wherever
    it shrinks, so hardly a map gives none: this is why `backward_warp` exists.

    References
    ----------
    .. [1] Notes 2b.5, "Forward/Backward Mapping".

    Examples
    --------
    >>> from cvnotes.warping import zoom_map
    >>> moved = forward_warp(np.ones((2, 2)), zoom_map(2), (4, 4))
    >>> moved.holes, moved.folds
    (12, 0)
    """
    source = checked_image(image)
    height, width = source.shape[:2]
    new_width, new_height = (width, height) if size is None else target_size(size)
    target = np.empty((new_height * new_width, *source.shape[2:]), source.dtype)
    target[:] = checked_fill(fill, source).reshape(source.shape[2:])
    hits = np.zeros(new_height * new_width, np.intp)
    rows = source.reshape(-1, *source.shape[2:])
    for part, m in tiles(mapping, (width, height)):
        u, v = np.floor(m + 0.5)
        arrives = (u >= 0) & (u < new_width) & (v >= 0) & (v < new_height)
        where = (v[arrives] * new_width + u[arrives]).astype(np.intp)
        target[where] = rows[part][arrives]
        np.add.at(hits, where, 1)
    shape = (new_height, new_width)
    return ForwardWarp(target.reshape(*shape, *source.shape[2:]), hits.reshape(shape))


def backward_warp(
    image: npt.ArrayLike,
    mapping: Mapping,
    *,
    size: tuple[int, int] | None = None,
    method: Method = "bilinear",
    border: Border = "constant",
    fill: npt.ArrayLike = 0,
) -> Image:
    """Fetch every pixel of the target from where it comes from in the source.

    Parameters
    ----------
    image : ndarray, shape (height, width) or (height, width, channels)
        The source; uint8, uint16, float32 or float64.
    mapping : PixelMap, callable or array of shape (height', width', 2)
        Target pixels (u', v') ↦ source pixels (u, v), a function of pixels (..., 2) or a table of
        them; NaN where there is nothing to show.
    size : (width', height'), optional
        Size of the target; by default that of the table, or else that of the source.
    method, border, fill
        As in `interpolate`.

    Returns
    -------
    ndarray, shape (height', width') or (height', width', channels), of the image's dtype
        Integers are rounded to the nearest, halves upwards.

    Notes
    -----
    I'(u', v') = I(g_u(u', v'), g_v(u', v')): every target pixel is asked for once, so there are
    neither holes nor folds. Where the map shrinks the picture, pixels between those asked for are
    passed over, and fine patterns turn coarse: blur first.

    References
    ----------
    .. [1] Notes 2b.5, "Forward/Backward Mapping".

    Examples
    --------
    >>> from cvnotes.warping import rotation_map
    >>> image = np.array([[1.0, 2.0], [3.0, 4.0]])
    >>> backward_warp(image, rotation_map(-np.pi / 2, centre=(0.5, 0.5)))
    array([[3., 1.],
           [4., 2.]])
    """
    sampler = Sampler(image, method, border, fill)
    if size is None and not callable(mapping):
        shape = np.shape(mapping)
        if len(shape) != 3:
            raise ShapeError(f"map: expected shape (height, width, 2), got {shape}")
        size = (shape[1], shape[0])
    width, height = target_size((sampler.width, sampler.height) if size is None else size)
    target = np.empty((height * width, sampler.fill.size), sampler.dtype)
    for part, m in tiles(mapping, (width, height)):
        sampler.look_up(m, target[part])
    return target.reshape(height, width, *sampler.channels)


def rectify_plane(
    image: npt.ArrayLike, H: npt.ArrayLike, region: npt.ArrayLike, pixel: float, **how: Any
) -> Image:
    """Remove the perspective from the picture of a plane, as if it were seen from straight above.

    Parameters
    ----------
    image : ndarray, shape (height, width) or (height, width, channels)
        The picture.
    H : array_like, shape (3, 3)
        Homography picture ← plane, from at least four points (`cvnotes.homography.dlt`).
    region : ((X0, Y0), (X1, Y1))
        Opposite corners of the part of the plane that is to be shown.
    pixel : float
        Side of a pixel of the new picture, in the plane's unit.
    **how
        ``method``, ``border`` and ``fill`` of `backward_warp`.

    References
    ----------
    .. [1] Notes 2b.5, "Removal of perspective deformation".

    Examples
    --------
    >>> H = [[1, 0, 100], [0, 1, 50], [0, 0, 1]]
    >>> rectify_plane(np.zeros((480, 640)), H, ((0, 0), (90, 60)), pixel=0.5).shape
    (120, 180)
    """
    (X0, Y0), (X1, Y1) = _region(region)
    pixel = number(pixel, "pixel")
    mapping = plane_map(H, (X0, Y0), pixel)
    width, height = (round(min(side / pixel, 1e9)) for side in (X1 - X0, Y1 - Y0))
    size = (width, height)
    return backward_warp(image, mapping, size=size, **how)


def _region(region: npt.ArrayLike) -> Any:
    corners = points(region, "region", 2)
    if corners.shape != (2, 2):
        raise ShapeError(f"region: expected ((X0, Y0), (X1, Y1)), got shape {corners.shape}")
    if not (corners[0] < corners[1]).all():
        raise CvnotesError("region: expected X0 < X1 and Y0 < Y1")
    return corners.tolist()
