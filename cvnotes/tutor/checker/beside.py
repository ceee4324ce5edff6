"""A wrong answer beside a right one: few digits, and a star at each number that differs."""

from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.tutor.checker.literals import as_code, readable

# Digits of a number; more only where the difference would not show.
_DIGITS = (4, 6, 9, 12, 17)
# Longer answers are named; of more rows those that differ are shown, and of these the first.
_LONGEST, _ROWS = 60, 8
_WIDEST = 92
STAR = "*"


def beside(yours: Any, wanted: Any, name: str = "report") -> list[str]:
    r"""Write two answers beside each other; as code, one below the other, where they do not fit.

    Parameters
    ----------
    yours, wanted : array_like
        A wrong answer and a right one.
    name : str
        What has them as ``.yours`` and ``.wanted``: those that are too long are only named.

    Examples
    --------
    >>> print("\n".join(beside([[1.0, 2 / 3], [3.0, 4.0]], [[1.0, 0.7], [3.0, 4.0]])))
    yours        wanted
    1  *0.6667   1  0.7
    3        4   3    4
    """
    a, b = np.asarray(yours), np.asarray(wanted)
    tables = _tables(a, b) if a.shape == b.shape and a.ndim < 3 else None
    if tables is None:
        return [
            *f"yours = {as_code(readable(yours), f'{name}.yours')}".splitlines(),
            *f"wanted = {as_code(readable(wanted), f'{name}.wanted')}".splitlines(),
        ]
    left, right, more = tables
    width = max(map(len, left))
    return [*(f"{x.ljust(width)}   {y}" for x, y in zip(left, right, strict=True)), *more]


def _tables(
    mine: npt.NDArray[Any], right: npt.NDArray[Any]
) -> tuple[list[str], list[str], list[str]] | None:
    """Return the lines of both, and what is left out; None where they are too long or too wide."""
    if not 0 < mine.size <= _LONGEST:
        return None
    rows = (mine.shape[0], -1) if mine.ndim == 2 else (mine.size, 1)
    mine, right = mine.reshape(rows), right.reshape(rows)
    apart = _apart(mine, right)
    a, b = _numbers(mine, _DIGITS[-1]), _numbers(right, _DIGITS[-1])
    for digits in _DIGITS:
        a, b = _numbers(mine, digits), _numbers(right, digits)
        if (a != b)[apart].all():
            break
    a = np.where(apart, np.char.add(STAR, a), a)
    off = np.flatnonzero(apart.any(1))
    shown = off[:_ROWS] if len(a) > _ROWS else np.arange(len(a))
    left, wanted = ["yours", *_aligned(a[shown])], ["wanted", *_aligned(b[shown])]
    more = []
    if len(a) > _ROWS:
        numbers = ["row", *(f"{i:>3}" for i in shown)]
        left = [f"{i}  {line}" for i, line in zip(numbers, left, strict=True)]
        more = [f"… {len(off)} of {len(a)} rows differ"]
    wide = max(map(len, left)) + max(map(len, wanted)) > _WIDEST
    return None if wide else (left, wanted, more)


def _apart(mine: npt.NDArray[Any], right: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
    """Return which numbers differ, by more than the last digits of the largest one."""
    mine, right = mine.astype(float), right.astype(float)
    size = float(np.abs(right[np.isfinite(right)]).max(initial=0.0))
    same = (np.abs(mine - right) <= 1e-6 * size) | (mine == right)
    same |= np.isnan(mine) & np.isnan(right)
    return np.asarray(~same if not same.all() else mine != right)


def _numbers(x: npt.NDArray[Any], digits: int) -> npt.NDArray[np.str_]:
    noise = 1e-14 * float(np.abs(x[np.isfinite(x)]).max(initial=0.0)) if x.dtype != bool else 0.0
    said = [_number(value, digits, noise) for value in x.ravel().tolist()]
    return np.array(said).reshape(x.shape)


def _number(value: float, digits: int, noise: float) -> str:
    if isinstance(value, bool) or not np.isfinite(value):
        return str(value)
    value = 0.0 if abs(value) <= noise else value
    text = f"{value:.{digits}g}"
    return f"{value:.0f}" if "e+" in text and abs(value) < 1e9 else text


def _aligned(x: npt.NDArray[np.str_]) -> list[str]:
    widths = np.char.str_len(x).max(axis=0)
    rows = (
        "  ".join(str(cell).rjust(width) for cell, width in zip(row, widths, strict=True))
        for row in x
    )
    return list(rows)
