"""A piece of homework: which exercises, for how many points, from whom; a small TOML file.

title = "Homework 1"
students = "students.csv"               # or ["ada", "bob"]; may be left out

[exercises]
lift = 1
dlt = 4
drop = { points = 3, parts = [1, 2] }   # points for each property that holds
depth = { points = 2, parts = true }    # the same for each
"""

import csv
import io
import re
import tomllib
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cvnotes.base import CvnotesError, FileError
from cvnotes.base.writing import printable
from cvnotes.tutor.checker.exercise import Exercise
from cvnotes.tutor.course import Course
from cvnotes.tutor.grader.marks import Verdict

_LARGEST = 1_000_000  # bytes
_COLUMNS = ("student", "name", "id", "email", "section")


@dataclass(frozen=True)
class Item:
    """One exercise of an assignment.

    Attributes
    ----------
    points : float
        What a right answer is worth.
    parts : dict
        What each of its properties is worth by itself, by its sentence; together `points`. Empty
        where only the whole counts.
    """

    points: float
    parts: Mapping[str, float] = field(default_factory=dict)

    def earned(self, verdict: Verdict | None) -> float:
        """Return the points for an answer."""
        if verdict is None:
            return 0.0
        if verdict.passed:
            return self.points
        return sum(part for sentence, part in self.parts.items() if sentence in verdict.holds)


@dataclass(frozen=True)
class Student:
    """Somebody who is to hand in.

    Attributes
    ----------
    student : str
        What the folder, or the file, is called.
    name, id, email, section : str
        What a learning platform wants to know; `id` is the one for `personal_camera`, too.
    """

    student: str
    name: str = ""
    id: str = ""
    email: str = ""
    section: str = ""

    def handed_in(self, folder: str, notebook: str) -> bool:
        """Return whether a folder, or a file that lies in none, is this student's.

        Examples
        --------
        >>> Student("ada").handed_in("Ada_123456_assignsubmission_file", "06.ipynb")
        True
        >>> Student("ada").handed_in("", "07_ada_06_homography_dlt.ipynb")
        True
        >>> Student("ada").handed_in("adam", "ada.ipynb")
        False
        """
        written = _plain(folder.split("/")[0] or notebook.rpartition(".")[0])
        own = [_plain(text) for text in (self.student, self.name, self.id) if text.strip()]
        return any(re.search(rf"(?<![^\W_]){re.escape(x)}(?![^\W_])", written) for x in own)


@dataclass(frozen=True)
class Assignment:
    """What is asked of whom, and for how many points.

    Attributes
    ----------
    title : str
        Its name, as a learning platform is to show it.
    items : dict
        By the name of the exercise, in the order of the file.
    students : tuple of Student
        Who is expected; empty if anybody is.
    """

    title: str
    items: dict[str, Item] = field(default_factory=dict)
    students: tuple[Student, ...] = ()

    @property
    def points(self) -> float:
        """What everything together is worth."""
        return sum(item.points for item in self.items.values())

    def earned(self, verdicts: Mapping[str, Verdict]) -> float:
        """Return the points for some answers."""
        return sum(item.earned(verdicts.get(name)) for name, item in self.items.items())


def read_assignment(path: Path, course: Course) -> Assignment:
    """Read an assignment.

    Raises
    ------
    FileError
        It is not one; the message says which entry, and what was expected.
    """
    text = _read(path)
    try:
        fields = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise FileError(f"{printable(path)} is no TOML: {error}") from None
    try:
        return _assignment(fields, path, course)
    except CvnotesError as error:
        raise FileError(f"{printable(path)}: {error}") from None


def _read(path: Path) -> str:
    try:
        if path.stat().st_size > _LARGEST:
            raise FileError(f"{printable(path)} is larger than 1 MB; an assignment is a few lines")
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise FileError(f"{printable(path)} is no text in UTF-8") from None
    except OSError as error:
        raise FileError(f"{printable(path)} cannot be read: {error.strerror}") from None


def _assignment(fields: Mapping[str, Any], path: Path, course: Course) -> Assignment:
    unknown = sorted(set(fields) - {"title", "students", "exercises"})
    if unknown:
        raise CvnotesError(f"{unknown[0]!r} is none of title, students, [exercises]")
    exercises, title = fields.get("exercises"), fields.get("title", path.stem)
    if not isinstance(exercises, dict) or not exercises:
        raise CvnotesError('expected [exercises] with lines such as "dlt = 2"')
    if not isinstance(title, str):
        raise CvnotesError(f"title: expected a text in quotes, got {title!r}")
    items = {name: _item(course.find(name), value) for name, value in exercises.items()}
    return Assignment(title, items, _students(fields.get("students", []), path.parent))


def _item(exercise: Exercise, value: Any) -> Item:
    name, sentences = exercise.name, [p.sentence for p in exercise.properties]
    given = value if isinstance(value, dict) else {"points": value}
    unknown = sorted(set(given) - {"points", "parts"})
    if unknown:
        raise CvnotesError(f"{name}: {unknown[0]!r} is none of points, parts")
    parts = given.get("parts", False)
    if isinstance(parts, list) and all(map(_is_number, parts)):
        if len(parts) != len(sentences):
            n = len(sentences)
            raise CvnotesError(f"{name}: expected {n} parts, one for each property, got {parts}")
        total = given.get("points", sum(parts))
        if total != sum(parts):
            raise CvnotesError(f"{name}: parts {parts} make {sum(parts):g} points, not {total}")
        return Item(float(sum(parts)), dict(zip(sentences, map(float, parts), strict=True)))
    points = given.get("points", 1)
    if not _is_number(points):
        raise CvnotesError(f"{name}: expected points from 0, got {points!r}")
    if not isinstance(parts, bool):
        raise CvnotesError(f"{name}: parts is true, or a list of points, not {parts!r}")
    share = float(points) / max(len(sentences), 1)
    return Item(float(points), dict.fromkeys(sentences, share) if parts else {})


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and 0 <= value < 1e6


def _students(value: Any, folder: Path) -> tuple[Student, ...]:
    if isinstance(value, str):
        students = _listed(folder / value)
    elif isinstance(value, list) and all(isinstance(name, str) for name in value):
        students = [Student(name) for name in value]
    else:
        raise CvnotesError("students: expected a list of names, or the name of a CSV file")
    names = [_plain(student.student) for student in students]
    twice = [name for i, name in enumerate(names) if name in names[:i]]
    if twice:
        raise CvnotesError(f"students: {twice[0]!r} is there twice")
    return tuple(students)


def _listed(path: Path) -> list[Student]:
    """Read a list of students: a table with the column student, and others if there are."""
    lines = io.StringIO(_read(path))
    delimiter = ";" if ";" in lines.readline() else ","
    lines.seek(0)
    rows = [
        {(key or "").strip().lower(): (value or "") for key, value in row.items() if key}
        for row in csv.DictReader(lines, delimiter=delimiter)
    ]
    if not rows or "student" not in rows[0]:
        raise CvnotesError(f"{printable(path.name)}: expected a column with the head student")
    given = [{key: row.get(key, "").strip() for key in _COLUMNS} for row in rows]
    return [Student(**fields) for fields in given if fields["student"]]


def same_id(text: str, student: Student) -> bool:
    """Return whether an id that a notebook used is a student's.

    Examples
    --------
    >>> same_id("S123", Student("ada", id="s123")), same_id("bob", Student("ada"))
    (True, False)
    """
    return any(_plain(text) == _plain(own) for own in (student.student, student.name, student.id))


def _plain(text: str) -> str:
    return unicodedata.normalize("NFKC", text).strip().casefold()
