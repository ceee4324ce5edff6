"""Guards of arguments: arrays of real and finite numbers, and what a camera is made of."""

import sys
from contextlib import nullcontext
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base.errors import CvnotesError, DegenerateError, InputTypeError, ShapeError

Array = npt.NDArray[np.float64]

# Cubes of larger numbers overflow; of a matrix, which stands for all its multiples, sums of three
# squares still do not.
LARGEST, LARGEST_ENTRY = 1e100, 7e153


def real(x: Any, name: str) -> npt.NDArray[Any]:
    """Return `x` as an array of real numbers of any kind, uncopied, NaN and infinity among them.

    Examples
    --------
    >>> real([3, np.nan], "m")
    array([ 3., nan])
    """
    if x is None:
        raise InputTypeError(f"{name}: expected numbers, got None (a missing return?)")
    if is_masked(x):
        raise InputTypeError(f"{name}: masked arrays are not read; pass the unmasked rows only")
    try:
        given = np.asarray(x)
    except Exception as error:
        raise InputTypeError(f"{name}: expected a numeric array; {error}") from error
    if given.dtype.kind not in "iuf":
        raise InputTypeError(
            f"{name}: expected a numeric array, got {type(x).__name__} of {given.dtype}"
        )
    return given


def numbers(x: Any, name: str, *, largest: float = LARGEST) -> Array:
    """Copy `x` to a float64 array of finite numbers, or say what is wrong with it.

    Raises
    ------
    InputTypeError
        `x` is None, text, complex, ragged, masked or otherwise no array of real numbers.
    CvnotesError
        `x` holds NaN, infinite values, or values beyond `largest`, which products would turn into
        infinite ones.

    Examples
    --------
    >>> numbers([1, 2], "m")
    array([1., 2.])
    """
    given = real(x, name)
    with np.errstate(over="ignore") if given.dtype.itemsize > 8 else nullcontext():
        array = given.astype(np.float64)
    if not _moderate(array, largest):
        _refuse_extremes(array, name, largest)
    return array


# From here on OpenBLAS spreads a product over threads, which then keep their cores busy for 20 ms.
_LONG = 10_000


def _moderate(array: Array, largest: float) -> bool:
    """Return at once, in nearly all cases, whether no number is too large, and none NaN."""
    if array.size < _LONG:
        return bool(np.vdot(array, array) < largest * largest)
    return bool(max(array.max(), -array.min()) <= largest)


def number(x: Any, name: str, *, at_least: float = -np.inf, at_most: float = np.inf) -> float:
    """Guard one finite number from `at_least` to `at_most`.

    Examples
    --------
    >>> number(2, "blur", at_least=0)
    2.0
    """
    value = numbers(x, name)
    if value.ndim:
        raise ShapeError(f"{name}: expected one number, got an array of shape {value.shape}")
    if value < at_least:
        raise CvnotesError(f"{name} = {value:g} but must be at least {at_least:g}")
    if value > at_most:
        raise CvnotesError(f"{name} = {value:g} but must be at most {at_most:g}")
    return float(value)


# What is asked for by number, and how far light may be smeared, in pixels: more is a slip, and
# would take gigabytes or minutes (edges blurred by 100 px take 3 s, by 224 px they took 18).
MOST, MOST_BLUR = 10_000, 100


def blur_width(x: Any, name: str) -> float:
    """Guard the standard deviation of a blur in pixels; one that nobody would see is none.

    Examples
    --------
    >>> blur_width(0.7, "blur"), blur_width(1e-300, "blur")
    (0.7, 0.0)
    """
    value = number(x, name, at_least=0, at_most=MOST_BLUR)
    return value if value > 1e-6 else 0.0


def whole(x: Any, name: str, *, at_least: int = 1, at_most: int = MOST) -> int:
    """Guard a whole number: of views, of lines, of pixels along a window.

    Examples
    --------
    >>> whole(5.0, "window")
    5
    >>> whole(1e5, "window")
    Traceback (most recent call last):
    cvnotes.base.errors.CvnotesError: window: expected a whole number from 1 to 10000, got 100000.0
    """
    value = number(x, name)
    if not at_least <= value <= at_most or value != int(value):
        wanted = f"expected a whole number from {at_least} to {at_most}"
        raise CvnotesError(f"{name}: {wanted}, got {x!r}")
    return int(value)


def flag(x: Any, name: str) -> bool:
    """Guard what is true or false.

    Examples
    --------
    >>> flag(True, "skew")
    True
    """
    if not isinstance(x, bool | np.bool_):
        raise InputTypeError(f"{name}: expected True or False, got {x!r:.80}")
    return bool(x)


def points(x: Any, name: str, *dims: int) -> Array:
    """Guard points as rows: shape (..., d) with d one of `dims`.

    Examples
    --------
    >>> points([100, 50], "m", 2)
    array([100.,  50.])
    """
    array = numbers(x, name)
    if array.ndim == 0 or array.shape[-1] not in dims:
        wanted = " or ".join(f"(..., {d})" for d in dims)
        hint = ""
        if array.ndim == 2 and array.shape[0] in dims:
            hint = "; points are rows here, so transpose it"
        raise ShapeError(f"{name}: expected shape {wanted}, got {array.shape}{hint}")
    return array


def paired(a: Array, b: Array, names: tuple[str, str], *, at_least: int) -> None:
    """Refuse two sets of points (..., n, d) that do not match one to one."""
    if a.ndim < 2 or b.ndim < 2:
        short = names[0] if a.ndim < 2 else names[1]
        raise ShapeError(f"{short}: expected several points (..., n, d), got a single one")
    if a.shape[-2] != b.shape[-2]:
        raise ShapeError(
            f"{names[0]} has {a.shape[-2]} points but {names[1]} has {b.shape[-2]}; "
            "each point needs its partner in the same row"
        )
    if a.shape[-2] < at_least:
        raise DegenerateError(f"need at least {at_least} points, got {a.shape[-2]}")


def equally_many(names: str, *stacks: tuple[int, ...]) -> tuple[int, ...]:
    """Return the leading axes that several arrays share, or refuse axes that do not fit.

    Examples
    --------
    >>> equally_many("R and T", (5, 1), (7,))
    (5, 7)
    """
    try:
        return np.broadcast_shapes(*stacks)
    except ValueError:
        shapes = ", ".join(str(stack) for stack in stacks)
        raise ShapeError(f"{names} are not equally many: {shapes}") from None


def matrix(x: Any, name: str, *shape: int) -> Array:
    """Guard one matrix, or a stack of them, of the given shape.

    Examples
    --------
    >>> matrix([[1, 0], [0, 1]], "H", 2, 2).shape
    (2, 2)
    """
    array = numbers(x, name, largest=LARGEST_ENTRY)
    if array.shape[-len(shape) :] != shape:
        raise ShapeError(f"{name}: expected shape {shape}, got {array.shape}")
    return array


def is_masked(x: Any) -> bool:
    """Return whether x is a masked array, or a list of such, whose masks NumPy would drop."""
    # Whoever has one has loaded what makes them; everybody else starts sooner without it.
    masked = getattr(sys.modules.get("numpy.ma"), "MaskedArray", ())
    if isinstance(x, list | tuple):
        return any(isinstance(item, masked) for item in x)
    return isinstance(x, masked)


def _refuse_extremes(array: Array, name: str, largest: float) -> None:
    """Refuse NaN, infinite values, and values beyond `largest`."""
    peak = float(np.abs(array).max(initial=0.0))
    if not np.isfinite(peak):
        at = np.argwhere(~np.isfinite(array))[0].tolist()
        first = f" (the first at {at})" if at else ""
        raise CvnotesError(f"{name} contains NaN or infinite values{first}; leave those out")
    if peak > largest:
        raise CvnotesError(
            f"{name} contains values of {peak:.2g}, which cannot be computed with: beyond "
            f"{largest:g} products overflow; choose another unit (or were they never assigned?)"
        )


# Four times what a photograph may have; more is a slip, and would hardly fit into the memory.
MOST_PIXELS = 2**28


def rotation(x: Any, name: str = "R") -> Array:
    """Guard a rotation (..., 3, 3): orthonormal to 1e-6 and with determinant +1."""
    R = matrix(x, name, 3, 3)
    deviation = float(np.abs(R @ R.mT - np.eye(3)).max(initial=0.0))
    if deviation > 1e-6:
        raise CvnotesError(
            f"{name} is not orthonormal (R Rᵀ deviates from I by {deviation:.2g}); "
            "cvnotes.camera.nearest_rotation gives the closest rotation"
        )
    if (np.linalg.det(R) < 0).any():
        raise CvnotesError(f"{name} has det = -1: a reflection, not a rotation")
    return R


def rigid_motion(x: Any, name: str = "G") -> Array:
    """Guard a rigid motion (..., 4, 4) = [R T; 0 1]."""
    G = matrix(x, name, 4, 4)
    if not (G[..., 3, :] == [0, 0, 0, 1]).all():
        raise CvnotesError(f"{name}: the last row of a rigid motion is (0, 0, 0, 1)")
    rotation(G[..., :3, :3], f"the rotation in {name}")
    return G


def intrinsic_matrix(x: Any, name: str = "A") -> Array:
    """Guard an intrinsic matrix: upper triangular, α_u and α_v positive, last entry 1."""
    A = matrix(x, name, 3, 3)
    if A.ndim != 2:
        raise ShapeError(f"{name}: expected one (3, 3) matrix, got {A.shape}")
    for i, j in ((1, 0), (2, 0), (2, 1)):
        if A[i, j] != 0:
            raise CvnotesError(
                f"{name}[{i}, {j}] = {A[i, j]:g} but an intrinsic matrix is upper triangular "
                "(transposed?)"
            )
    if A[2, 2] != 1:
        raise CvnotesError(f"{name}[2, 2] = {A[2, 2]:g} but must be 1; divide {name} by it")
    for i, letter in ((0, "alpha_u"), (1, "alpha_v")):
        if A[i, i] < 1 / LARGEST:
            small = " and not so small" if A[i, i] > 0 else ""
            raise CvnotesError(
                f"{name}[{i}, {i}] = {letter} = {A[i, i]:g} but must be positive{small}"
            )
    return A


def image_size(x: Any, name: str = "size") -> tuple[int, int]:
    """Guard a size in pixels, (width, height), two positive integers.

    Examples
    --------
    >>> image_size([640, 480])
    (640, 480)
    """
    wanted = f"{name}: expected (width, height), two positive whole numbers, got {x!r}"
    if not isinstance(x, list | tuple | np.ndarray) or is_masked(x):
        raise CvnotesError(wanted)
    try:
        width, height = x
        whole = (int(width), int(height))
        exact = whole == (width, height) and not isinstance(width, str | bytes | bool)
    except (TypeError, ValueError, OverflowError):
        raise CvnotesError(wanted) from None
    if not exact or min(whole) < 1 or max(whole) >= 2**31:
        raise CvnotesError(wanted)
    return whole


def target_size(x: Any, name: str = "size") -> tuple[int, int]:
    """Guard the size of a picture that is to be made, and that has to fit into the memory.

    Examples
    --------
    >>> target_size([640, 480])
    (640, 480)
    """
    width, height = image_size(x, name)
    if width * height > MOST_PIXELS:
        raise CvnotesError(f"{name}: a picture of {width} × {height} pixels would be too large")
    return width, height


def generator(x: Any, name: str = "rng") -> "np.random.Generator":
    """Guard a source of random numbers.

    Examples
    --------
    >>> generator(7)
    Traceback (most recent call last):
    cvnotes.base.errors.InputTypeError: rng: expected a numpy.random.Generator, got int
    """
    if not isinstance(x, np.random.Generator):
        raise InputTypeError(f"{name}: expected a numpy.random.Generator, got {type(x).__name__}")
    return x
