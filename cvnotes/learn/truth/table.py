"""The table of a verification: estimates, truths, errors and verdicts, in text and HTML."""

from dataclasses import dataclass
from html import escape
from math import floor, isnan, log10

from cvnotes.base import text_table
from cvnotes.base.digits import decimals, fixed

_HEADER = ("", "estimate", "truth", "error", "expected", "")


@dataclass(frozen=True)
class Row:
    """One number held against the truth.

    `allowed` is the largest error that holds. `std` is the predicted standard deviation where
    that is what decides, else NaN.
    """

    name: str
    estimate: float
    truth: float
    allowed: float
    std: float = float("nan")
    unit: str = ""

    @property
    def error(self) -> float:
        """Estimate minus truth; 0 where neither exists (NaN)."""
        if isnan(self.estimate) and isnan(self.truth):
            return 0.0
        return self.estimate - self.truth

    @property
    def holds(self) -> bool:
        """Whether the error is as small as it should be; never with a NaN on one side only."""
        return bool(abs(self.error) <= self.allowed)

    def cells(self) -> tuple[str, ...]:
        """Return the row as text: name, estimate, truth, error, expected error, verdict."""
        digits = _digits(self)
        name = f"{self.name} ({self.unit})" if self.unit else self.name
        expected = f"± {self.std:.2g}" if not isnan(self.std) else f"≤ {self.allowed:.2g}"
        return (
            name,
            _number(self.estimate, digits),
            _number(self.truth, digits),
            self._error(digits),
            expected,
            "✓ holds" if self.holds else "✗ off",
        )

    def _error(self, digits: int) -> str:
        """Write the error, but no digits of mere rounding, which differ between computers."""
        if isnan(self.error):
            return "missing"
        if not self.holds:
            return f"{self.error:+.3g}"
        if self.allowed <= 1e-6 * max(abs(self.truth), 1.0) or isnan(self.truth):
            return "rounding"
        return fixed(self.error, digits, sign="+")


@dataclass(frozen=True)
class Verification:
    """Estimates held against the truth, row by row."""

    rows: tuple[Row, ...]

    @property
    def holds(self) -> bool:
        """Whether every row holds."""
        return all(row.holds for row in self.rows)

    def __bool__(self) -> bool:
        return self.holds

    @property
    def summary(self) -> str:
        """The verdict in words."""
        off = [row.name for row in self.rows if not row.holds]
        if not off:
            return "verified: every estimate is as near to the truth as it should be"
        return f"{len(off)} of {len(self.rows)} off: {', '.join(off[:6])}" + " …" * (len(off) > 6)

    def __repr__(self) -> str:
        return f"{self.summary}\n{text_table([_HEADER, *(row.cells() for row in self.rows)])}"

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{escape(cell)}</th>" for cell in _HEADER)
        body = "".join(
            "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row.cells()) + "</tr>"
            for row in self.rows
        )
        caption = escape(self.summary)
        return f"<table><caption>{caption}</caption><tr>{head}</tr>{body}</table>"


def _digits(row: Row) -> int:
    """Decimals that show the expected error; of a tolerance at most five significant digits."""
    spread = row.allowed if isnan(row.std) else row.std
    size = max(abs(row.truth) or 1.0, spread) if not isnan(row.truth) else 1.0
    if size == float("inf"):
        return 0
    shown = decimals(spread) if spread > 0 else 12
    most = 4 if isnan(row.std) else 6
    return max(0, min(shown, most - floor(log10(size))))


def _number(x: float, digits: int) -> str:
    return "none" if isnan(x) else fixed(x, digits)
