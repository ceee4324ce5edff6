"""Estimate against truth: one table for all chapters, which raises when something is off."""

from math import isnan
from typing import Any

import numpy as np

from cvnotes.base import Array, CvnotesError, ShapeError
from cvnotes.camera import Camera
from cvnotes.learn.truth.parameters import named_values
from cvnotes.learn.truth.table import Row, Verification

# An error of more standard deviations than this is no chance: it happens once in 16,000 times.
SIGMAS = 4.0
# More entries than this are not listed one by one.
_LISTED = 12


class NotVerified(CvnotesError):
    """An estimate is farther from the truth than it should be; the message is the table."""


def verify(
    estimated: Any,
    truth: Any,
    *,
    tolerance: float | None = None,
    std: Any = None,
    name: str = "",
    unit: str = "",
    up_to_scale: bool = False,
) -> Verification:
    """Hold estimates against the truth, and raise if one is farther off than it should be.

    Parameters
    ----------
    estimated, truth : number, array, mapping, Lens, Camera or Calibration
        Both alike, or a Calibration and the Camera that it should have found. Of two mappings
        the names in `estimated` are compared.
    tolerance : float, optional
        Largest error that holds; 1e-9 unless there are standard deviations.
    std : number, array or mapping, optional
        Predicted standard deviations: errors up to four of them hold. A Calibration brings its
        own.
    name, unit : str
        What the numbers are called, and their unit.
    up_to_scale : bool
        Scale both to length 1 first, with the sign that makes them agree.

    Returns
    -------
    Verification
        A table with what was found, what is true, and what error was to be expected.

    Raises
    ------
    NotVerified
        Something is off; the table is the message.
    ShapeError
        Estimate and truth do not belong together.

    Examples
    --------
    >>> verify([800.02, 325.0], [800, 325], tolerance=0.1, name="A", unit="px")
    verified: every estimate is as near to the truth as it should be
                estimate   truth  error  expected
    A[0] (px)     800.02  800.00  +0.02     ≤ 0.1  ✓ holds
    A[1] (px)     325.00  325.00  +0.00     ≤ 0.1  ✓ holds
    >>> verify({"k1": -0.2}, {"k1": -0.25, "k2": 0.1}, tolerance=0.01)
    Traceback (most recent call last):
        ...
    cvnotes.learn.truth.verification.NotVerified: 1 of 1 off: k1
        estimate   truth  error  expected
    k1    -0.200  -0.250  +0.05    ≤ 0.01  ✗ off
    """
    if std is None and tolerance is None:
        std = getattr(estimated, "std", None) if isinstance(truth, Camera) else None
    found = named_values(estimated, name)
    true = named_values(truth, name, wanted=list(found))
    spread = {} if std is None else named_values(std, name, wanted=list(found))
    rows: list[Row] = []
    for key, value in found.items():
        target = true[key][0]
        sd = spread[key][0] if key in spread else None
        rows += _rows(key, value[0], target, tolerance, sd, unit or value[1], up_to_scale)
    result = Verification(tuple(rows))
    if not result:
        raise NotVerified(repr(result))
    return result


def _rows(
    name: str,
    found: Array,
    true: Array,
    tolerance: float | None,
    std: Array | None,
    unit: str,
    up_to_scale: bool,
) -> list[Row]:
    """Compare two arrays entry by entry, or the worst entry of long ones."""
    if found.shape != true.shape:
        raise ShapeError(f"{name or 'estimated'} has shape {found.shape}, the truth {true.shape}")
    if up_to_scale:
        found, true = _alike(found, true)
    sd = np.broadcast_to(np.nan if std is None else std, true.shape)
    limit = 1e-9 if tolerance is None else float(tolerance)
    rows = [
        Row(
            name + (f"[{', '.join(map(str, index))}]" if index else ""),
            float(found[index]),
            float(true[index]),
            limit if isnan(sd[index]) else SIGMAS * float(sd[index]),
            float(sd[index]),
            unit,
        )
        for index in np.ndindex(true.shape)
    ]
    if len(rows) <= _LISTED:
        return rows
    worst = max(rows, key=lambda row: (not row.holds, abs(row.error) / row.allowed))
    # Among errors of mere rounding none is the worst on every computer.
    named = f"{name} (worst of {len(rows)})".strip()
    if worst.holds and worst.allowed <= 1e-6 * max(abs(worst.truth), 1.0):
        worst, named = rows[0], f"{name} (all {len(rows)})".strip()
    return [Row(named, worst.estimate, worst.truth, worst.allowed, worst.std, unit)]


def _alike(found: Array, true: Array) -> tuple[Array, Array]:
    """Scale both to length 1, with one sign."""
    lengths = float(np.linalg.norm(found)), float(np.linalg.norm(true))
    if not min(lengths) > 0:
        raise CvnotesError("an array of zeros, or with NaN, has no scale to compare up to")
    found, true = found / lengths[0], true / lengths[1]
    return found * (1.0 if np.vdot(found, true) >= 0 else -1.0), true
