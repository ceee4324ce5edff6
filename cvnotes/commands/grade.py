"""``cvnotes grade``: marks for a folder of handed-in notebooks."""

import argparse
import codecs
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from cvnotes.base import CvnotesError, FileError
from cvnotes.base.writing import check_folder, printable
from cvnotes.commands.console import complain, say
from cvnotes.commands.signals import ENDING, heard, numbers_of
from cvnotes.files import write_whole
from cvnotes.files.ownership import maker
from cvnotes.learn.exercises import COURSE
from cvnotes.tutor.grader.assignment import Assignment, read_assignment
from cvnotes.tutor.grader.feedback import class_page, class_picture, file_name, student_page
from cvnotes.tutor.grader.grading import grade_folder
from cvnotes.tutor.grader.handed_in import Handin
from cvnotes.tutor.grader.marks import Mark
from cvnotes.tutor.grader.process import Limits
from cvnotes.tutor.grader.records import Records, read_records
from cvnotes.tutor.grader.tables import (
    FORMATS,
    HEADER,
    marks_csv,
    number,
    summary,
)
from cvnotes.tutor.grader.totals import totals

# How the tables of this command begin.
_HEADS = (",".join(HEADER), "Identifier,Full name,Email address,ID number,Grade", "Student,ID,SIS")


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describe the command's arguments."""
    parser = subparsers.add_parser(
        "grade",
        help="mark a folder of handed-in notebooks",
        description="Run every notebook below a folder in a process of its own, try the answers "
        "it checks, and write a table of marks. Rows are written as they come; what was "
        "interrupted goes on with --resume.",
    )
    add = parser.add_argument
    add("folder", type=Path, metavar="FOLDER", help="where the notebooks are")
    add("--out", type=Path, required=True, metavar="marks.csv", help="table to write")
    add("--assignment", type=Path, metavar="homework.toml",
        help="which exercises, for how many points, by whom")  # fmt: skip
    add("--with", dest="added", type=Path, action="append", default=[],
        metavar="my_exercises.py", help="a file with exercises of your own")  # fmt: skip
    add("--feedback", type=Path, metavar="FOLDER",
        help="folder to write a page for each student to")  # fmt: skip
    add("--summary", type=Path, metavar="class.html",
        help="page of the class to write, and its picture (.svg)")  # fmt: skip
    add("--format", choices=FORMATS, help="also write a table for this platform, beside the other")
    add("--resume", action="store_true", help="keep the rows of notebooks that did not change")
    add("--seconds", type=_positive, default=120.0, metavar="120", help="time for each notebook")
    add("--megabytes", type=_positive, default=4096.0, metavar="4096", help="memory for each")
    add("--jobs", type=_positive, default=None, metavar="2", help="how many run at a time")
    add("--cluster", metavar="ADDRESS", help="run them on the workers of a Dask scheduler")


@dataclass(frozen=True)
class Outputs:
    """What is written, and where.

    Attributes
    ----------
    table : Path
        The marks.
    assignment : Assignment or None
        What was asked.
    platform : str or None
        For whom there is a second table.
    feedback, summary : Path or None
        Folder of the students' pages, and page of the class.
    """

    table: Path
    assignment: Assignment | None = None
    platform: str | None = None
    feedback: Path | None = None
    summary: Path | None = None

    @property
    def records(self) -> Path:
        """The finished rows, for ``--resume``."""
        return self.table.with_suffix(".rows.jsonl")

    @property
    def platform_table(self) -> Path:
        """The table for a learning platform."""
        return self.table.with_suffix(f".{self.platform}.csv")

    @property
    def all(self) -> list[Path]:
        """Every file and folder."""
        paths = [self.table, self.records]
        paths += [self.platform_table] * bool(self.platform)
        paths += [self.feedback] if self.feedback else []
        paths += [self.summary, self.summary.with_suffix(".svg")] if self.summary else []
        return paths

    @property
    def title(self) -> str:
        """What the pages are called."""
        return self.assignment.title if self.assignment else "Exercises"

    def unfinished(self, marks: Sequence[Mark], handed_in: Sequence[Handin]) -> bytes:
        """Return the table while others are waiting: of an assignment it says so of them."""
        done = {(mark.student, mark.notebook) for mark in marks}
        waiting = [
            Mark(one.student, one.notebook, remark="not run yet")
            for one in handed_in
            if self.assignment and (one.student, one.notebook) not in done
        ]
        return self._marks([*marks, *waiting])

    def _marks(self, marks: Sequence[Mark]) -> bytes:
        marks = sorted(marks, key=lambda mark: (mark.student, mark.notebook))
        return _for_spreadsheets(marks_csv(marks, COURSE, self.assignment))

    def contents(self, marks: Sequence[Mark]) -> dict[Path, bytes]:
        """Return all files but the records."""
        marks = sorted(marks, key=lambda mark: (mark.student, mark.notebook))
        contents = {self.table: self._marks(marks)}
        sums = totals(marks, COURSE, self.assignment)
        if self.platform:
            text = FORMATS[self.platform](sums, self.title)
            contents[self.platform_table] = _for_spreadsheets(text)
        if self.feedback:
            taken: list[str] = []
            for total in sums:
                taken.append(file_name(total, taken))
                page = student_page(total, COURSE, self.title)
                contents[self.feedback / taken[-1]] = page.encode()
        if self.summary:
            contents[self.summary] = class_page(marks, sums, COURSE, self.title).encode()
            contents[self.summary.with_suffix(".svg")] = class_picture(sums, COURSE).encode()
        return contents


def run(args: argparse.Namespace) -> int:
    """Grade, write the table, tell about the class; gives the exit code: 0 done."""
    for path in args.added:
        COURSE.add_exercises(path)
    assignment = read_assignment(args.assignment, COURSE) if args.assignment else None
    outputs = Outputs(args.out, assignment, args.format, args.feedback, args.summary)
    limits = Limits(args.seconds, int(args.megabytes))
    _check(outputs)
    known = read_records(outputs.records, limits, COURSE) if args.resume else {}
    with ExitStack() as stack:
        handed_in, marks = grade_folder(
            args.folder,
            COURSE,
            seconds=limits.seconds,
            megabytes=limits.megabytes,
            jobs=int(args.jobs) if args.jobs else None,
            executor=stack.enter_context(_cluster(args.cluster)) if args.cluster else None,
            known=known,
            ours=[*outputs.all, *args.added, *filter(None, [args.assignment])],
        )
        stack.enter_context(heard(_interrupt, *ENDING))
        graded: list[Mark] = []
        try:
            records = stack.enter_context(Records(outputs.records, known, limits, COURSE))
            for mark in stack.enter_context(closing(marks)):  # type: ignore[type-var]
                records.add(mark)
                graded.append(mark)
                write_whole({outputs.table: outputs.unfinished(graded, handed_in)})
                say(f"{len(graded)} of {len(handed_in)}  {one_line(mark, assignment)}")
        except KeyboardInterrupt:
            text = f"interrupted; the {len(graded)} finished rows of {len(handed_in)} are kept"
            complain("grade", f"{text}, --resume goes on from there")
            raise
    write_whole(outputs.contents(graded))
    _tell(graded, outputs)
    return 0


def _check(outputs: Outputs) -> None:
    """Refuse what could not be written, before the first notebook runs."""
    for path in outputs.all:
        check_folder(path if path == outputs.feedback else path.parent)
        if path != outputs.feedback and path.is_dir():
            raise FileError(f"{printable(path)} cannot be written: it is a folder")
    pages = outputs.feedback.glob("*.html") if outputs.feedback else []
    for path in [*filter(Path.is_file, outputs.all), *pages]:
        if not _is_ours(path):
            raise FileError(
                f"{printable(path)} was not made by cvnotes grade, which would replace it; "
                "choose another name"
            )
    # What is there is written once more, as it is.
    write_whole({path: path.read_bytes() for path in outputs.all if path.is_file()})


def _is_ours(path: Path) -> bool:
    """Return whether this command made a file, or nobody has written into it."""
    if path.suffix == ".csv":
        head = path.read_bytes()[:200].removeprefix(codecs.BOM_UTF8).decode(errors="replace")
        return not head or head.startswith(_HEADS)
    if path.suffix == ".jsonl":
        return path.read_bytes()[:10] in (b"", b'{"version"')
    return maker(path) == "grade"


def _tell(graded: Sequence[Mark], outputs: Outputs) -> None:
    say()
    say(summary(graded, COURSE, outputs.assignment))
    if not all(mark.sealed for mark in graded):
        say(
            "This system does not let a notebook be sealed off: network, files and other "
            "processes of yours were within its reach (docs/teaching.md says more)."
        )
    say(f"written to {printable(outputs.table)}")


def one_line(mark: Mark, assignment: Assignment | None = None) -> str:
    """Tell about one notebook in a line.

    Examples
    --------
    >>> one_line(Mark("ada", "06.ipynb", expected=("dlt",), remark="not a notebook"))
    'ada/06.ipynb: 0 of 1 (not a notebook)'
    """
    remark = f" ({mark.remark})" if mark.remark else ""
    points, of = float(mark.points), float(len(mark.expected))
    if assignment:
        points, of = assignment.earned(mark.reports), assignment.points
    return f"{mark.name}: {number(points)} of {number(of)}{remark}"


@contextmanager
def _cluster(address: str) -> Iterator[Executor]:
    """Return the workers of a Dask scheduler as an executor."""
    try:
        from distributed import Client
    except ImportError:
        raise CvnotesError(
            "--cluster needs Dask, which is not installed here: pip install distributed"
        ) from None
    try:
        client = Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        raise CvnotesError(f"no Dask scheduler answers at {address}: {error}") from None
    with client:
        yield client.get_executor()


def _interrupt(*_: Any) -> NoReturn:
    """Let the first Ctrl-C end the work and the second not end the tidying up."""
    for number_ in numbers_of(*ENDING):
        signal.signal(number_, signal.SIG_IGN)
    raise KeyboardInterrupt


def _for_spreadsheets(text: str) -> bytes:
    """Begin with the mark by which spreadsheet programs know UTF-8."""
    return text.encode("utf-8-sig")


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1 <= value < 1e6:
        raise argparse.ArgumentTypeError(f"expected a number from 1, got {text!r}")
    return value
