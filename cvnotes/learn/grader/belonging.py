"""Which exercises belong to which notebook: what the course's own notebooks ask for."""

import re
from collections import defaultdict
from functools import cache
from pathlib import Path

from cvnotes.base.material import material
from cvnotes.learn.exercises import EXERCISES, notebook_of

COURSE = material("notebooks")


def expected_exercises(notebook: str, handed_in: list[str]) -> tuple[str, ...]:
    """Give the exercises that belong to a notebook.

    The number in its name says which chapter it is; of several numbers (of a group, of a sheet)
    the one whose chapter it answers most of. Without a number, a notebook that answers one
    chapter is that chapter, and a collection is what it answers.

    Examples
    --------
    >>> "dlt" in expected_exercises("06_homography_dlt.ipynb", [])
    True
    >>> expected_exercises("homework1.ipynb", ["dlt", "lift"])
    ('lift', 'dlt')
    """
    placed, given = _placed(COURSE), {*handed_in}
    chapter = _chapter(notebook, placed, given)
    met = [names for names in placed.values() if names & given]
    if chapter:
        expected = placed[chapter]
    elif len(met) == 1:
        [expected] = met
    else:
        expected = given
    return tuple(name for name in EXERCISES if name in expected)


def _chapter(notebook: str, placed: dict[int, set[str]], given: set[str]) -> int:
    """Give the chapter that a name speaks of; 0 if of none."""
    numbers = [int(n) for n in re.findall(r"(?<![^\W_])(\d\d)(?=_)", notebook)]
    numbers = [n for n in numbers if n in placed]
    # The course's own names end in the chapter's: of equals the last one counts.
    return max(reversed(numbers), key=lambda n: len(placed[n] & given), default=0)


@cache
def _placed(course: Path) -> dict[int, set[str]]:
    """Give what each of the course's own notebooks asks for; without them, what it should."""
    numbers = {notebook_of(e) for e in EXERCISES.values()}
    placed = {n: {e.name for e in EXERCISES.values() if notebook_of(e) == n} for n in numbers}
    found: dict[int, set[str]] = defaultdict(set)
    for path in course.glob("[0-9][0-9]_*.ipynb"):
        text = path.read_text(encoding="utf-8").replace('\\"', '"')
        names = set(re.findall(r"check\(\s*[\"'](\w+)[\"']", text)) & set(EXERCISES)
        found[int(path.name[:2])] |= names
    return placed | {n: names for n, names in found.items() if names}
