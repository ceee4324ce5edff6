"""Where a scene is seen from, and the sheet that it is seen on."""

from collections.abc import Callable

import numpy as np

from cvnotes.base import Array


def towards(view: tuple[float, float]) -> Array:
    """Return the direction to the viewer in the WRF, of an elevation and azimuth in degrees.

    Examples
    --------
    >>> towards((90, 0)).round()
    array([ 0., -1.,  0.])
    """
    elevation, azimuth = np.deg2rad(view)
    level = np.cos(elevation)
    return np.array([level * np.cos(azimuth), -np.sin(elevation), level * np.sin(azimuth)])


def onto(axes: Array) -> Callable[[Array], Array]:
    """Return what projects points (..., 3) onto a sheet (..., 2), all parallel, by its axes (2, 3).

    Examples
    --------
    >>> onto(np.eye(3)[:2])(np.array([4.0, 5, 6]))
    array([4., 5.])
    """
    return lambda W: np.asarray(W @ axes.T)


def sheet(view: tuple[float, float]) -> Array:
    """Return what points to the right and what points down (2, 3), seen from there.

    Examples
    --------
    >>> sheet((0, -90)).round() + 0.0
    array([[1., 0., 0.],
           [0., 1., 0.]])
    """
    azimuth = np.deg2rad(view[1])
    right = np.array([-np.sin(azimuth), 0.0, np.cos(azimuth)])
    return np.stack([right, np.cross(right, towards(view))])
