"""Marks as tables: for a spreadsheet, for Moodle, for Canvas."""

import re
from collections import Counter
from collections.abc import Iterable, Sequence

from cvnotes.base.writing import as_csv
from cvnotes.tutor.course import Course
from cvnotes.tutor.grader.assignment import Assignment
from cvnotes.tutor.grader.marks import Mark
from cvnotes.tutor.grader.totals import Total, remarked, totals

HEADER = ("student", "notebook", "points", "of", "percent")
_TRAILER = ("misconceptions", "id", "remark")


def marks_csv(marks: Sequence[Mark], course: Course, assignment: Assignment | None = None) -> str:
    """Write the marks as CSV: a row for each notebook, or for each student of an assignment.

    Examples
    --------
    >>> from cvnotes.learn.exercises import COURSE
    >>> print(marks_csv([Mark("ada", "=1+1.ipynb", expected=("dlt",))], COURSE).splitlines()[1])
    ada,'=1+1.ipynb,0,1,0,0,,,
    """
    rows: Iterable[tuple[Total | Mark, str, str, float, float, list[str], Iterable[str]]]
    if assignment:
        names = list(assignment.items)
        rows = (
            (total, total.student.student, ", ".join(m.notebook for m in total.marks if m.notebook),
             total.points, total.of, [number(total.earned(name)) for name in names], total.remarks)
            for total in totals(marks, course, assignment)
        )  # fmt: skip
    else:
        names = [name for name in course.exercises if any(name in m.expected for m in marks)]
        rows = (
            (mark, mark.student, mark.notebook, mark.points, len(mark.expected),
             [str(mark.earned(name)) if name in mark.expected else "" for name in names], remarks)
            for mark, remarks in zip(marks, remarked(marks), strict=True)
        )  # fmt: skip
    table = [
        [who, notebook, number(points), number(of), str(round(100 * points / of)) if of else "0"]
        + [*earned, "; ".join(f"{name}: {what}" for name, what in one.misconceptions.items())]
        + [", ".join(one.ids), "; ".join(remarks)]
        for one, who, notebook, points, of, earned, remarks in rows
    ]
    return as_csv([[*HEADER, *names, *_TRAILER], *table])


def for_moodle(sums: Sequence[Total], title: str) -> str:
    """Write a table that Moodle's grade import and its grading worksheet both understand.

    The participant's number is the one in the names of the folders that Moodle itself makes.

    Parameters
    ----------
    sums : sequence of Total
        Of the students.
    title : str
        What the column of points is called beside those of the worksheet.
    """
    header = ["Identifier", "Full name", "Email address", "ID number"]
    rows = []
    for total in sums:
        folder = total.marks[0].student if total.marks else ""
        found = re.search(r"_(\d+)_assignsubmission", folder)
        rows.append(
            [f"Participant {found[1]}" if found else "", _name(total), total.student.email]
            + [total.student.id, number(total.points), number(total.of), _comment(total)]
        )
    return as_csv([[*header, "Grade", "Maximum Grade", f"Feedback comments: {title}"], *rows])


def for_canvas(sums: Sequence[Total], title: str) -> str:
    """Write a table that Canvas's gradebook takes back; its second row are the points possible.

    Parameters
    ----------
    sums : sequence of Total
        Of the students.
    title : str
        The name of the assignment; with Canvas's own number behind it, "Homework (1234)", the
        points go into the assignment that is there already.
    """
    of = max((total.of for total in sums), default=0.0)
    rows = [["    Points Possible", "", "", "", "", number(of)]]
    for total in sums:
        # Canvas names a file NAME_STUDENT_SUBMISSION_FILE.
        found = re.match(
            r"[^_]+_(?:LATE_)?(\d+)_\d+_", total.marks[0].notebook if total.marks else ""
        )
        one = total.student
        rows.append(
            [_name(total), found[1] if found else "", one.id, one.email, one.section]
            + [number(total.points)]
        )
    return as_csv([["Student", "ID", "SIS User ID", "SIS Login ID", "Section", title], *rows])


FORMATS = {"moodle": for_moodle, "canvas": for_canvas}


def summary(marks: Sequence[Mark], course: Course, assignment: Assignment | None = None) -> str:
    """Return what the class as a whole can do, and which misconceptions it met.

    Examples
    --------
    >>> from cvnotes.learn.exercises import COURSE
    >>> print(summary([Mark("ada", "06.ipynb", expected=("dlt",))], COURSE))
    1 notebook, 0 of 1 points
    dlt                           0 of 1
    """
    if assignment:
        sums = totals(marks, course, assignment)
        who, points = counted(len(sums), "student"), sum(t.points for t in sums)
        possible = assignment.points * len(sums)
        solved = {
            name: (sum(name in t.verdicts and t.verdicts[name].passed for t in sums), len(sums))
            for name in assignment.items
        }
    else:
        who = counted(sum(bool(mark.notebook) for mark in marks), "notebook")
        points, possible = sum(m.points for m in marks), sum(len(m.expected) for m in marks)
        asked = {name: [m for m in marks if name in m.expected] for name in course.exercises}
        solved = {n: (sum(m.earned(n) for m in own), len(own)) for n, own in asked.items() if own}
    lines = [f"{who}, {number(points)} of {number(possible)} points"]
    lines += [f"{name:<29} {n} of {of}" for name, (n, of) in solved.items()]
    met = misconceptions(marks)
    lines += ["misconceptions met:"] * bool(met)
    lines += [f"{count:>4} × {name}: {what}" for (name, what), count in met.most_common()]
    return "\n".join(lines)


def misconceptions(marks: Iterable[Mark]) -> Counter[tuple[str, str]]:
    """Count the misconceptions of a class: (exercise, misconception)."""
    return Counter(pair for mark in marks for pair in mark.misconceptions.items())


def counted(n: int, what: str) -> str:
    """Write a number with its noun.

    Examples
    --------
    >>> counted(1, "student"), counted(30, "student")
    ('1 student', '30 students')
    """
    return f"{n} {what}{'s' * (n != 1)}"


def number(x: float) -> str:
    """Write points as a person would.

    Examples
    --------
    >>> number(2.0), number(1.5), number(1 / 3)
    ('2', '1.5', '0.33')
    """
    return f"{round(x, 2):g}"


def _name(total: Total) -> str:
    return total.student.name or total.student.student.split("_")[0]


def _comment(total: Total) -> str:
    """Tell a student in a cell what the feedback page tells in full."""
    said = []
    for name, item in total.items.items():
        verdict = total.verdicts.get(name)
        mistake = f". {verdict.message}" if verdict and verdict.misconception else ""
        said.append(f"{name}: {number(total.earned(name))} of {number(item.points)}{mistake}")
    return "; ".join(said)
