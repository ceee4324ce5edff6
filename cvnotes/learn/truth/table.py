"""The table of a verification: estimates, truths, errors and verdicts, in text and HTML."""

from dataclasses import dataclass
from html import escape
from math import floor, log10

from cvnotes.base import text_table
from cvnotes.base.digits import decimals, fixed
from cvnotes.camera.model import SENSOR

_HEADER = ("", "estimate", "truth", "error", "expected", "")
# An error of more standard deviations than this is no chance: it happens once in 16,000 times.
_SIGMAS = 4.0


@dataclass(frozen=True)
class Row:
    """One number held against the truth, with its predicted standard deviation."""

    name: str
    estimate: float
    truth: float
    std: float

    @property
    def error(self) -> float:
        """Estimate minus truth."""
        return self.estimate - self.truth

    @property
    def holds(self) -> bool:
        """Whether the error is as small as it should be."""
        return abs(self.error) <= _SIGMAS * self.std

    def cells(self) -> tuple[str, ...]:
        """Return the row as text: name, estimate, truth, error, expected error, verdict."""
        # Decimals that show the expected error, of at most seven significant digits.
        most = 6 - floor(log10(max(abs(self.truth) or 1.0, self.std)))
        digits = max(0, min(decimals(self.std), most))
        return (
            f"{self.name} (px)" if self.name in SENSOR else self.name,
            fixed(self.estimate, digits),
            fixed(self.truth, digits),
            fixed(self.error, digits, sign="+") if self.holds else f"{self.error:+.3g}",
            f"± {self.std:.2g}",
            "✓ holds" if self.holds else "✗ off",
        )


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
