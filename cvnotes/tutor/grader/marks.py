"""What grading gives: a verdict for each answer, a mark for each notebook. Plain data only.

They travel between processes and machines, and are lines of a file for ``--resume``.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from cvnotes.tutor.checker.report import OPEN, RIGHT, Report


@dataclass(frozen=True)
class Verdict:
    """What was found about one answer: a `Report` without its arrays.

    Attributes
    ----------
    verdict, message, misconception, holds, fails, remarks
        As in `cvnotes.tutor.checker.report.Report`.
    compared, example : tuple of str
        The answer beside a right one, and the counterexample as code, line by line.
    code : str
        A fingerprint of the functions that were handed in; empty for a stub or a value.
    note : str
        What the teacher is to know about it.
    """

    verdict: str
    message: str = ""
    misconception: str | None = None
    holds: tuple[str, ...] = ()
    fails: str = ""
    remarks: tuple[str, ...] = ()
    compared: tuple[str, ...] = ()
    example: tuple[str, ...] = ()
    code: str = ""
    note: str = ""

    @property
    def passed(self) -> bool:
        """Whether the answer is right."""
        return self.verdict == RIGHT

    @property
    def is_open(self) -> bool:
        """Whether nobody tried yet."""
        return self.verdict == OPEN


def verdict_of(report: Report, note: str = "") -> Verdict:
    """Put a report into plain data.

    Examples
    --------
    >>> verdict_of(Report("lift", "right", "Well done.")).passed
    True
    """
    same = ("verdict", "message", "misconception", "holds", "fails", "remarks")
    plain = {name: getattr(report, name) for name in same}
    lines = tuple(line for text in report.example() for line in text.splitlines())
    return Verdict(**plain, compared=tuple(report.compared()), example=lines, note=note)


@dataclass(frozen=True)
class Mark:
    """What one notebook earned.

    Attributes
    ----------
    student, notebook : str
        Its folder below the graded one, and its file name; no name where no notebook is.
    reports : dict
        The verdict on each exercise that was handed in, by name.
    expected : tuple of str
        The exercises that belong to it.
    ids : tuple of str
        The student ids that it used.
    remark : str
        What went wrong with the notebook as a whole.
    content : str
        A fingerprint of the file.
    sealed : bool
        Whether it ran sealed off, or did not run.
    """

    student: str
    notebook: str
    reports: dict[str, Verdict] = field(default_factory=dict)
    expected: tuple[str, ...] = ()
    ids: tuple[str, ...] = ()
    remark: str = ""
    content: str = ""
    sealed: bool = True

    @property
    def points(self) -> int:
        """How many of the expected exercises are right."""
        return sum(self.earned(name) for name in self.expected)

    def earned(self, name: str) -> int:
        """Return the point for one exercise."""
        return int(name in self.reports and self.reports[name].passed)

    @property
    def misconceptions(self) -> dict[str, str]:
        """The misconceptions met, by exercise."""
        return {n: r.misconception for n, r in self.reports.items() if r.misconception}

    @property
    def name(self) -> str:
        """Folder and file, as a path."""
        return "/".join(part for part in (self.student, self.notebook) if part)


def from_fields(fields: Mapping[str, Any]) -> Mark:
    """Make a mark of the fields that ``dataclasses.asdict`` gives of one.

    Raises
    ------
    KeyError, TypeError, AttributeError
        Something is missing, or is not what it should be.

    Examples
    --------
    >>> from dataclasses import asdict
    >>> mark = Mark("ada", "06.ipynb", {"dlt": Verdict("right")}, ("dlt",))
    >>> from_fields(asdict(mark)) == mark
    True
    """
    lists = ("holds", "remarks", "compared", "example")
    given = fields["reports"].items()
    reports = {name: Verdict(**_with_tuples(verdict, *lists)) for name, verdict in given}
    return Mark(**_with_tuples(fields, "expected", "ids") | {"reports": reports})


def _with_tuples(fields: Mapping[str, Any], *names: str) -> dict[str, Any]:
    return {**fields, **{name: tuple(map(str, fields[name])) for name in names}}
