"""Which exercises belong to which notebook: what the course's own notebooks ask for."""

import re
from collections import defaultdict
from functools import cache
from pathlib import Path

from cvnotes.learn.exercises import EXERCISES, notebook_of

COURSE = Path(__file__).resolve().parents[3] / "notebooks"


def expected_exercises(notebook: str, handed_in: list[str]) -> tuple[str, ...]:
    """Give the exercises that belong to a notebook, by the number in its name.

    Without a number they are those of the course's notebooks that it answers something of.

    Examples
    --------
    >>> "dlt" in expected_exercises("06_homography_dlt.ipynb", [])
    True
    """
    placed = _placed(COURSE)
    number = re.match(r"(\d\d)_", notebook)
    if number and int(number[1]) in placed:
        expected = placed[int(number[1])]
    else:
        expected = set().union(*(names for names in placed.values() if names & {*handed_in}))
    return tuple(name for name in EXERCISES if name in expected)


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
