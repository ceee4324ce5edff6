"""From the marks of notebooks to those of students: sums, and what a teacher is to look at."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from cvnotes.tutor.course import Course
from cvnotes.tutor.grader.assignment import Assignment, Item, Student, same_id
from cvnotes.tutor.grader.handed_in import NOTHING
from cvnotes.tutor.grader.marks import Mark, Verdict


@dataclass(frozen=True)
class Total:
    """What one student earned.

    Attributes
    ----------
    student : Student
        Whose it is; for those on no list, their folder, or their file.
    items : dict
        What was asked, by the name of the exercise.
    verdicts : dict
        On each exercise the best answer of all notebooks, also on what was not asked.
    marks : tuple of Mark
        Of the notebooks.
    remarks : tuple of str
        What the teacher is to look at.
    """

    student: Student
    items: Mapping[str, Item]
    verdicts: Mapping[str, Verdict] = field(default_factory=dict)
    marks: tuple[Mark, ...] = ()
    remarks: tuple[str, ...] = ()

    @property
    def points(self) -> float:
        """The sum over what was asked."""
        return sum(self.earned(name) for name in self.items)

    @property
    def of(self) -> float:
        """The most that was to be had."""
        return sum(item.points for item in self.items.values())

    @property
    def misconceptions(self) -> dict[str, str]:
        """The misconceptions met, by exercise."""
        return {n: v.misconception for n, v in self.verdicts.items() if v.misconception}

    @property
    def ids(self) -> tuple[str, ...]:
        """The ids that were used for personal cameras."""
        return tuple(dict.fromkeys(one for mark in self.marks for one in mark.ids))

    def earned(self, name: str) -> float:
        """Return the points for one exercise."""
        return self.items[name].earned(self.verdicts.get(name))


def remarked(marks: Sequence[Mark], assignment: Assignment | None = None) -> list[list[str]]:
    """Return the remarks on each notebook: what went wrong, and what stands out in the class.

    Parameters
    ----------
    marks : sequence of Mark
        All of them, since some remarks are about two.
    assignment : Assignment, optional
        What was asked, if not the notebook's own chapter.
    """
    equal = _equal(marks)
    theirs: dict[str, list[Mark]] = defaultdict(list)
    found = []
    for mark in marks:
        remarks = [mark.remark] * bool(mark.remark)
        asked = assignment.items if assignment else mark.expected
        others = [n for n, v in mark.reports.items() if n not in asked and not v.is_open]
        if others:
            remarks.append(f"other exercises answered: {', '.join(others)}")
        remarks += [f"{name}: {v.note}" for name, v in mark.reports.items() if v.note]
        remarks += [f"id {one} is not the folder's" for one in _foreign(mark, assignment)]
        remarks += filter(None, [equal.get(mark.name)])
        if mark.student and not assignment:  # there the sum over all notebooks says so
            theirs[_who(mark)].append(mark)
            remarks += _copies(theirs[_who(mark)], of=mark)
        found.append(remarks)
    return found


def totals(
    marks: Sequence[Mark], course: Course, assignment: Assignment | None = None
) -> list[Total]:
    """Sum up for each student, in the order of their names.

    Parameters
    ----------
    marks : sequence of Mark
        Of all notebooks.
    course : Course
        Whose exercises were answered.
    assignment : Assignment, optional
        What was asked; without it, a point for each exercise of the notebooks handed in.
    """
    grouped: dict[Student, list[tuple[Mark, list[str]]]] = defaultdict(list)
    expected = assignment.students if assignment else ()
    for student in expected:
        grouped[student] = []
    for mark, remarks in zip(marks, remarked(marks, assignment), strict=True):
        grouped[_whose(mark, expected)].append((mark, remarks))
    return [
        _total(student, pairs, course, assignment, known=student in expected or not expected)
        for student, pairs in sorted(grouped.items(), key=lambda x: x[0].student.casefold())
    ]


def _whose(mark: Mark, expected: Sequence[Student]) -> Student:
    """Return the student to whom a notebook belongs."""
    theirs = [one for one in expected if one.handed_in(mark.student, mark.notebook)]
    if theirs:  # of Ann and Ann Lee, the longer name is meant where it fits
        return max(theirs, key=lambda one: len(one.student))
    return Student(mark.student.split("/")[0] or mark.notebook)


def _total(
    student: Student,
    pairs: list[tuple[Mark, list[str]]],
    course: Course,
    assignment: Assignment | None,
    *,
    known: bool,
) -> Total:
    marks = tuple(mark for mark, _ in pairs)
    expected = {name for mark in marks for name in mark.expected}
    asked = (name for name in course.exercises if name in expected)
    items = assignment.items if assignment else dict.fromkeys(asked, Item(1.0))
    best: dict[str, Verdict] = {}
    total = Total(student, items, marks=marks)
    for mark in marks:
        for name, verdict in mark.reports.items():
            item = items.get(name, Item(1.0))
            before = best.get(name)
            if before is None or _beats(verdict, before, item):
                best[name] = verdict
    remarks = ["not on the list of students"] * (not known)
    remarks += [NOTHING] * (not pairs)
    remarks += [text for mark in marks for text in _copies(marks, of=mark)] * bool(assignment)
    several = len(pairs) > 1
    for mark, said in pairs:
        remarks += [f"{mark.notebook}: {text}" if several else text for text in said]
    return replace(total, verdicts=best, remarks=tuple(remarks))


def _beats(one: Verdict, other: Verdict, item: Item) -> bool:
    """Return whether an answer is better than another; what nobody tried beats nothing."""
    return (item.earned(one), not one.is_open) > (item.earned(other), not other.is_open)


def _copies(marks: Sequence[Mark], of: Mark) -> Iterator[str]:
    """Yield which notebooks of one student, before this one, answer the same exercises."""
    for other in marks[: marks.index(of)]:
        both = f"two copies: {other.notebook} and {of.notebook}"
        if of.content and of.content == other.content:
            yield f"{both}, the same file"
        elif {*of.reports} & {*other.reports}:
            yield f"{both}, the better answers count"


def _foreign(mark: Mark, assignment: Assignment | None) -> Iterator[str]:
    """Yield the ids of a notebook that are not its student's."""
    student = _whose(mark, assignment.students if assignment else ())
    for one in mark.ids:
        if not same_id(one, student) and not Student(one).handed_in(mark.student, mark.notebook):
            yield one


def _equal(marks: Sequence[Mark]) -> dict[str, str]:
    """Say, for each notebook, whose functions are equal to its own."""
    writers: dict[tuple[str, str], list[Mark]] = defaultdict(list)
    for mark in marks:
        for name, verdict in mark.reports.items():
            if verdict.code:
                writers[name, verdict.code].append(mark)
    found: dict[str, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for (name, _), alike in writers.items():
        for mark in alike:
            others = [other.name for other in alike if _who(other) != _who(mark)]
            for other in others:
                found[mark.name][other].append(name)
    return {mark: f"the same functions as {_clause(others)}" for mark, others in found.items()}


def _clause(others: Mapping[str, Sequence[str]]) -> str:
    """Put who wrote which functions, too, into one clause."""
    by_names: dict[str, list[str]] = defaultdict(list)
    for other, names in others.items():
        by_names[", ".join(names)].append(other)
    said = []
    for names, group in by_names.items():
        more = f" and {len(group) - 2} more" if len(group) > 3 else ""
        said.append(f"{', '.join(group[: 2 if more else 3])}{more}: {names}")
    return ", as ".join(said)


def _who(mark: Mark) -> str:
    return mark.student.split("/")[0] or mark.notebook
