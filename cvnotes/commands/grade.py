"""``cvnotes grade``: marks for a folder of handed-in notebooks."""

import argparse
import csv
import io
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from cvnotes.base import CvnotesError
from cvnotes.commands.console import complain, harmless, say
from cvnotes.files import write_whole
from cvnotes.files.writing import check_folder, printable
from cvnotes.learn import EXERCISES
from cvnotes.learn.grader.grading import Mark, grade_folder

_HEADER = ("student", "notebook", "points", "of", "percent")
_TRAILER = ("misconceptions", "id", "remark")


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describe the command's arguments."""
    parser = subparsers.add_parser(
        "grade",
        help="mark a folder of handed-in notebooks",
        description="Run every notebook below a folder in a process of its own, try the answers "
        "it checks, and write a table of marks.",
    )
    parser.add_argument("folder", metavar="FOLDER", help="where the notebooks are")
    parser.add_argument("--out", required=True, metavar="marks.csv", help="table to write")
    parser.add_argument(
        "--seconds", type=_positive, default=120.0, metavar="120", help="time for each notebook"
    )
    parser.add_argument(
        "--megabytes", type=_positive, default=4096.0, metavar="4096", help="memory for each"
    )
    parser.add_argument(
        "--jobs", type=_positive, default=None, metavar="2", help="how many run at a time"
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Grade, write the table, tell about the class; gives the exit code: 0 done, 1 cannot."""
    out = Path(args.out)
    try:
        check_folder(out.parent)
        n, marks = grade_folder(
            Path(args.folder),
            seconds=args.seconds,
            megabytes=int(args.megabytes),
            jobs=int(args.jobs) if args.jobs else None,
        )
        graded = []
        for mark in marks:
            graded.append(mark)
            say(f"{len(graded)} of {n}  {one_line(mark)}")
        write_whole({out: marks_csv(graded).encode()})
    except CvnotesError as error:
        complain("grade", str(error))
        return 1
    say()
    say(summary(graded))
    say(f"written to {printable(out)}")
    return 0


def one_line(mark: Mark) -> str:
    """Tell about one notebook in a line.

    Examples
    --------
    >>> one_line(Mark("ada", "06.ipynb", expected=("dlt",), remark="not a notebook"))
    'ada/06.ipynb: 0 of 1 (not a notebook)'
    """
    name = f"{mark.student}/{mark.notebook}" if mark.student else mark.notebook
    remark = f" ({mark.remark})" if mark.remark else ""
    return f"{name}: {mark.points} of {len(mark.expected)}{remark}"


def marks_csv(marks: Sequence[Mark]) -> str:
    """Write the marks as CSV: a row for each notebook, a column for each exercise.

    Examples
    --------
    >>> print(marks_csv([Mark("ada", "=1+1.ipynb", expected=("dlt",))]).splitlines()[1])
    ada,'=1+1.ipynb,0,1,0,0,,,
    """
    asked = {name for mark in marks for name in mark.expected}
    names = [name for name in EXERCISES if name in asked]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*_HEADER, *names, *_TRAILER])
    for mark in marks:
        points = [mark.earned(name) if name in mark.expected else "" for name in names]
        met = "; ".join(f"{name}: {mistake}" for name, mistake in mark.misconceptions.items())
        percent = round(100 * mark.points / len(mark.expected)) if mark.expected else 0
        texts = [met, ", ".join(mark.ids), mark.remark]
        writer.writerow(
            [harmless(mark.student), harmless(mark.notebook), mark.points, len(mark.expected)]
            + [percent, *points, *map(harmless, texts)]
        )
    return text.getvalue()


def summary(marks: Sequence[Mark]) -> str:
    """Tell what the class as a whole can do, and which misconceptions it met.

    Examples
    --------
    >>> print(summary([Mark("ada", "06.ipynb", expected=("dlt",))]))
    1 notebooks, 0 of 1 points
    dlt                           0 of 1
    """
    points, possible = sum(m.points for m in marks), sum(len(m.expected) for m in marks)
    lines = [f"{len(marks)} notebooks, {points} of {possible} points"]
    for name in EXERCISES:
        asked = [mark for mark in marks if name in mark.expected]
        if asked:
            solved = sum(mark.earned(name) for mark in asked)
            lines.append(f"{name:<29} {solved} of {len(asked)}")
    met = Counter(pair for mark in marks for pair in mark.misconceptions.items())
    lines += ["misconceptions met:"] * bool(met)
    lines += [f"{count:>4} × {name}: {what}" for (name, what), count in met.most_common()]
    return "\n".join(lines)


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1 <= value < 1e6:
        raise argparse.ArgumentTypeError(f"expected a number from 1, got {text!r}")
    return value
