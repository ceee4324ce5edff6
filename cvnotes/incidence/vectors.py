"""The guard of homogeneous vectors, and when a product counts as zero."""

import numpy as np
import numpy.typing as npt

from cvnotes.errors import Array, CvnotesError, DegenerateError, ShapeError, numbers

_ROUNDING = 2e-15  # relative size of what is left of a product that should be 0


def vectors(x: npt.ArrayLike, name: str, what: str, d: int | None = None) -> Array:
    """Guard homogeneous vectors; factors that would make products overflow are taken out."""
    x = numbers(x, name, largest=np.inf)
    wanted = "(..., 3) or (..., 4)" if d is None else f"(..., {d})"
    if x.ndim == 0 or x.shape[-1] not in ((3, 4) if d is None else (d,)):
        raise ShapeError(f"{name}: expected homogeneous coordinates {wanted}, got {x.shape}")
    largest = np.abs(x).max(axis=-1, keepdims=True, initial=0.0)
    if (largest == 0).any():
        raise CvnotesError(f"{name}: the zero vector is not a {what}")
    exponent = np.frexp(largest)[1]
    return np.asarray(np.ldexp(x, np.where(np.abs(exponent) > 200, -exponent, 0)))


def refuse_zero(product: Array, size: Array, why: str) -> None:
    """Refuse products (..., d) that are nothing but rounding beside their factors' size."""
    if (np.linalg.norm(product, axis=-1) <= _ROUNDING * size).any():
        raise DegenerateError(why)
