"""Values as code that can be read and copied."""

from typing import Any

import numpy as np

# Longer arrays are not printed; `Report.counterexample` holds them.
_LONGEST = 60
# Wider ones get a line for each row.
_WIDEST = 72


def as_code(value: Any, name: str = "") -> str:
    """Write a value as code that makes it again; long arrays only by their name.

    Examples
    --------
    >>> as_code(np.array([[1.0, np.inf]]))
    'np.array([[1.0, np.inf]])'
    >>> print(as_code(np.diag([800.0, 804.0, 1.0]) @ np.full((3, 3), 0.125) + np.eye(3)))
    np.array([
        [101.0, 100.0, 100.0],
        [100.5, 101.5, 100.5],
        [0.125, 0.125, 1.125],
    ])
    """
    if not isinstance(value, np.ndarray):
        return repr(value)
    if value.ndim == 0:
        return repr(value.item())
    if value.size == 0:
        return f"np.empty({value.shape})"
    if value.size > _LONGEST:
        return f"{name}  # {value.shape}"
    numbers = np.vectorize(_literal, otypes=[object])(value.astype(object))
    line = f"np.array({_listed(numbers)})"
    if value.ndim == 1 or len(line) <= _WIDEST:
        return line
    if value.ndim == 2:
        widths = np.vectorize(len)(numbers).max(axis=0)
        numbers = np.vectorize(str.rjust, otypes=[object])(numbers, widths)
    return "\n".join(["np.array([", *(f"    {_listed(row)}," for row in numbers), "])"])


def _literal(x: Any) -> str:
    if isinstance(x, int):  # or a truth value
        return repr(x)
    text = repr(x + 0.0)
    return f"np.{text}".replace("np.-", "-np.") if not np.isfinite(x) else text


def _listed(x: Any) -> str:
    """Write nested lists of what is written already."""
    return x if isinstance(x, str) else f"[{', '.join(map(_listed, x))}]"


def readable(x: Any) -> Any:
    """Leave six significant digits, and no rounding noise: results are to be read.

    Examples
    --------
    >>> readable([1 / 3, 1e-17])
    array([0.333333, 0.      ])
    """
    if np.asarray(x).dtype == bool:
        return x
    rounded = np.array([float(f"{value:.6g}") for value in np.ravel(x)]).reshape(np.shape(x))
    noise = 1e-14 * np.abs(rounded[np.isfinite(rounded)]).max(initial=0.0)
    return np.where(np.abs(rounded) <= noise, 0.0, rounded)
