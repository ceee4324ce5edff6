"""Which exercises belong to which notebook: what the course's own notebooks ask for."""

import re
from collections import defaultdict
from functools import cache
from pathlib import Path

from cvnotes.tutor.course import MORE, Course, short_name


def expected_exercises(notebook: str, handed_in: list[str], course: Course) -> tuple[str, ...]:
    """Return the exercises that belong to a notebook.

    The number in its name says which chapter it is; of several numbers (of a group, of a sheet)
    the one whose chapter it answers most of. That of the further exercises has a name instead.
    Without either, they are what it answers.

    Examples
    --------
    >>> from cvnotes.learn.exercises import COURSE
    >>> "dlt" in expected_exercises("06_homography_dlt.ipynb", [], COURSE)
    True
    >>> expected_exercises("homework1.ipynb", ["dlt", "lift"], COURSE)
    ('lift', 'dlt')
    >>> "bilinear" in expected_exercises("ada_more_exercises.ipynb", [], COURSE)
    True
    """
    placed, given = _placed(course), {*handed_in}
    chapter = _chapter(notebook, placed, given)
    expected = placed[chapter] if chapter else given
    return tuple(name for name in course.exercises if name in expected)


def _chapter(notebook: str, placed: dict[str, set[str]], given: set[str]) -> str:
    """Return the notebook of the course that a name speaks of; nothing if of none."""
    named = re.findall(rf"(?<![^\W_])(?:\d\d(?=_)|{MORE})", notebook)
    # The course's own names end in the chapter's: of equals the last one counts.
    among = [name for name in reversed(named) if name in placed]
    return max(among, key=lambda name: len(placed[name] & given), default="")


def _placed(course: Course) -> dict[str, set[str]]:
    """Return what each of the course's own notebooks asks for; without them, what it should."""
    placed: dict[str, set[str]] = defaultdict(set)
    for exercise in course.exercises.values():
        placed[course.notebook_of(exercise)].add(exercise.name)
    asked = _asked(course.notebooks) if course.notebooks is not None else {}
    found = {name: names & set(course.exercises) for name, names in asked.items()}
    return placed | {name: names for name, names in found.items() if names}


@cache
def _asked(notebooks: Path) -> dict[str, set[str]]:
    """Return the names that each notebook of a folder hands to ``check``."""
    found: dict[str, set[str]] = defaultdict(set)
    for path in notebooks.glob("*.ipynb"):
        text = path.read_text(encoding="utf-8").replace('\\"', '"')
        found[short_name(path.name)] |= set(re.findall(r"check\(\s*[\"'](\w+)[\"']", text))
    return found
