"""Cameras, lenses and calibrations as named numbers, for tables."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from cvnotes.base import Array, CvnotesError, InputTypeError
from cvnotes.calibration import Calibration
from cvnotes.camera import AnyLens, Camera, vector_from_rotation
from cvnotes.camera.model import SENSOR

# A value and its unit.
Named = dict[str, tuple[Array, str]]


def named_values(x: Any, name: str = "", wanted: list[str] | None = None) -> Named:
    """Return the numbers in x by name, each as an array with its unit.

    Parameters
    ----------
    x : number, array, mapping, Lens, Camera or Calibration
        Where the numbers come from.
    name : str
        What a number or array without names is called.
    wanted : list of str, optional
        Names that must be there; lens coefficients that are not are 0.

    Raises
    ------
    CvnotesError
        A wanted name is missing.

    Examples
    --------
    >>> from cvnotes.camera import Lens
    >>> named_values(Lens(k=(-0.25,)), wanted=["k1", "k2"])["k2"]
    (array(0.), '')
    """
    if isinstance(x, Calibration):
        values = _of_mapping(x.parameters)
    elif isinstance(x, Camera):
        values = of_camera(x)
    elif isinstance(x, AnyLens):
        values = _of_mapping(x.parameters)
    elif isinstance(x, Mapping):
        values = _of_mapping(x)
    else:
        values = {name: (_array(x, name), "")}
    # (what a lens or a camera does not name is zero; a mapping without a name has forgotten it)
    for key in wanted or ():
        if key not in values and key[:1] in ("k", "p", "s") and isinstance(x, AnyLens | Camera):
            values[key] = (np.zeros(()), "")
        if key not in values:
            raise CvnotesError(f"{key!r} is estimated, but the truth has only {', '.join(values)}")
    return values


def of_camera(camera: Camera) -> Named:
    """Return a camera's intrinsics, lens, rotation vector and centre.

    Examples
    --------
    >>> list(of_camera(Camera(np.diag([800.0, 805, 1]))))[:6]
    ['alpha_u', 'alpha_v', 'skew', 'u0', 'v0', 'rotation']
    """
    values = _of_mapping(camera.parameters)
    values["rotation"] = (vector_from_rotation(camera.R), "rad")
    values["centre"] = (camera.centre, "")
    return values


def _of_mapping(x: Mapping[Any, Any]) -> Named:
    return {str(k): (_array(v, str(k)), "px" if k in SENSOR else "") for k, v in x.items()}


def _array(x: Any, name: str) -> Array:
    """Return numbers as an array; NaN stays, as a point may have no image."""
    array = np.asarray(x)
    if array.dtype.kind not in "biuf":
        raise InputTypeError(f"{name or 'verify'}: expected numbers, got {type(x).__name__}")
    return array.astype(np.float64)
