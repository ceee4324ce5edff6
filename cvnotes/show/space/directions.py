"""Where a scene is seen from."""

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
