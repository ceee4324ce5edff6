"""What a student's function gave, as plain numbers and words.

A returned object may do anything when it is compared, printed or copied. So it is looked at once,
in the process that ran the function, and only numbers and clean words travel on.
"""

import base64
import json
from dataclasses import asdict, dataclass
from decimal import Decimal
from numbers import Real
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError
from cvnotes.base.guards import is_masked

# More values than this answer no exercise.
MAX_VALUES = 2_000_000
MAX_PRINTED = 2_000

KINDS = (
    "numbers",
    "none",
    "unfinished",  # a stub
    "raised",
    "text",
    "other",
    "result",  # the result of a function was handed over in place of the function
    "late",
    "died",
    "memory",
)


@dataclass(frozen=True, eq=False)
class Outcome:
    """What came of one call.

    Attributes
    ----------
    kind : str
        One of `KINDS`; "numbers" is the only one that can be right.
    value : ndarray or None
        The numbers, as float64.
    dtype : str
        What they were made of before, for example "int64"; "float32" too where their digits say so.
    words : str
        What was raised, returned or happened instead, in a few words.
    changed : tuple of int
        Which arguments were different after the call.
    shares : bool
        Whether the answer is a view of an argument.
    printed : str
        The beginning of what was printed.
    """

    kind: str
    value: Array | None = None
    dtype: str = ""
    words: str = ""
    changed: tuple[int, ...] = ()
    shares: bool = False
    printed: str = ""


def clean(text: Any, limit: int = 200) -> str:
    r"""Make one printable line of any text, at most `limit` characters long.

    Examples
    --------
    >>> clean("two\nlines\x07")
    'two lines'
    """
    head = str(text)[: 4 * limit].encode("utf-8", "replace").decode("utf-8")
    line = " ".join("".join(c if c.isprintable() else " " for c in head).split())
    return line if len(line) <= limit else line[: limit - 1] + "…"


def outcome_of(answer: Any) -> Outcome:
    """Look at what a function returned; may raise whatever the answer raises when looked at.

    Examples
    --------
    >>> outcome_of([1, 2]).value
    array([1., 2.])
    >>> outcome_of(None).kind, outcome_of(...).kind, outcome_of("H").kind
    ('none', 'unfinished', 'text')
    """
    if answer is None:
        return Outcome("none")
    if answer is ... or answer is NotImplemented:
        return Outcome("unfinished")
    if isinstance(answer, str | bytes):
        return Outcome("text", words=clean(repr(answer[:60]), 60))
    if isinstance(answer, np.ndarray) and is_masked(answer) and np.ma.is_masked(answer):
        return Outcome("other", words="a masked array with masked entries")
    kind = type(answer).__name__
    try:
        array = np.asarray(answer)
    except ValueError:
        return Outcome("other", words=f"a {kind} whose parts have different lengths")
    array = _real(array)
    if array.dtype.kind not in "biuf":
        return Outcome("other", words=_what(answer, array, kind))
    if array.size > MAX_VALUES:
        return Outcome("other", words=f"an array of shape {array.shape}, far too large")
    return Outcome("numbers", np.array(array, dtype=np.float64), dtype=_precision(array))


@np.errstate(all="ignore")
def _precision(array: npt.NDArray[Any]) -> str:
    """Return of which type numbers are, or were: a list of mixed ones hides single precision.

    All of them are in single precision then, and one at least so long that nobody rounded to it.
    """
    numbers = array[np.isfinite(array)]
    if array.dtype != np.float64 or (numbers != numbers.astype(np.float32)).any():
        return str(array.dtype)
    return "float32" if (numbers != _first_bits(numbers)).any() else "float64"


def _first_bits(array: npt.NDArray[Any], bits: int = 20) -> npt.NDArray[Any]:
    """Round numbers to their first bits: here to less than is forgiven in double precision."""
    mantissa, exponent = np.frexp(array)
    return np.asarray(np.ldexp(np.rint(np.ldexp(mantissa, bits)), exponent - bits))


def _real(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Take real numbers for what they are, also as fractions or with an imaginary part of 0."""
    if array.dtype.kind == "c" and not (np.abs(array.imag) > 1e-12 * np.abs(array.real)).any():
        return np.asarray(array.real)
    if array.dtype.kind == "O" and 0 < array.size <= MAX_VALUES:
        known = all(isinstance(x, Real | Decimal) for x in array.ravel())
        return array.astype(np.float64) if known else array
    return array


def encode(outcome: Outcome) -> bytes:
    """Write an outcome as one line of JSON."""
    fields = asdict(outcome)
    if outcome.value is not None:
        data = np.ascontiguousarray(outcome.value, dtype="<f8")
        fields["value"] = base64.b64encode(data.tobytes()).decode()
        fields["shape"] = outcome.value.shape
    return json.dumps(fields).encode() + b"\n"


def decode(line: bytes | str) -> Outcome:
    """Read what `encode` wrote, believing nothing.

    Raises
    ------
    CvnotesError
        The line is not an outcome.

    Examples
    --------
    >>> decode(encode(Outcome("numbers", np.eye(2)))).value
    array([[1., 0.],
           [0., 1.]])
    """
    try:
        fields = json.loads(line)
        kind = fields["kind"]
        value = _array(fields["value"], fields["shape"]) if kind == "numbers" else None
        changed = tuple(int(i) for i in fields["changed"])
        # What was raised, and the line in which it happened.
        dtype, words = clean(fields["dtype"]), clean(fields["words"], 400)
        printed = str(fields["printed"])[:MAX_PRINTED]
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise CvnotesError(f"not an outcome: {clean(error)}") from None
    if kind not in KINDS:
        raise CvnotesError(f"not an outcome: of kind {clean(kind)!r}")
    return Outcome(kind, value, dtype, words, changed, bool(fields.get("shares")), printed)


def _array(data: str, shape: list[int]) -> Array:
    flat: npt.NDArray[Any] = np.frombuffer(base64.b64decode(data, validate=True), dtype="<f8")
    if flat.size > MAX_VALUES:
        raise ValueError("too many values")
    return np.array(flat.reshape([int(n) for n in shape]), dtype=np.float64)


def _what(answer: Any, array: npt.NDArray[Any], kind: str) -> str:
    """Describe what was returned in place of numbers."""
    article = "an" if kind[:1].lower() in "aeiou" or kind == "ndarray" else "a"
    if callable(answer):
        return f"{article} {kind} that was not called: are the brackets missing?"
    if array.dtype.kind == "c":
        return "complex numbers"
    if array.dtype.kind in "US":
        return f"{article} {kind} of text"
    if array.ndim:
        return f"{article} {kind} of things that are not all numbers"
    return f"{article} {clean(kind, 40)}"
