"""A lecture of 90 minutes for each chapter: the table of docs/teaching.md, with slides by number.

The table names sections, which stay when slides are added before them; pages and slides are built
with the numbers that the slides have at that moment.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Protocol

_ROW = re.compile(r"^\| (\d+) \| ([^|]+) \| ([^|]+) \| (`[^|]+`) \|$", re.M)


class Titled(Protocol):
    """As much of a slide as tells its section."""

    title: str


def numbered(text: str, made: Mapping[str, Sequence[Titled]]) -> str:
    """Return docs/teaching.md with the numbers of the slides behind the sections of its table.

    Parameters
    ----------
    text : str
        The page.
    made : mapping
        Slides by notebook, such as ``03_camera_model``.

    Raises
    ------
    KeyError
        A section is in no slide's title.
    """

    def with_numbers(row: re.Match[str]) -> str:
        number, sections, exploration, exercises = row.groups()
        slides = next(slides for name, slides in made.items() if name.startswith(f"{number:0>2}_"))
        shown = "; ".join(f"{name} ({pages(name, slides)})" for name in sections.split("; "))
        explored = f"{exploration} ({pages(exploration, slides)})"
        return f"| {number} | {shown} | {explored} | {exercises} |"

    return _ROW.sub(with_numbers, text)


def pages(section: str, slides: Sequence[Titled]) -> str:
    """Return the numbers of a section's slides, from 1, such as "4–6"."""
    titles = (section, f"Explore: {section}")
    numbers = [number for number, slide in enumerate(slides, 1) if slide.title in titles]
    if not numbers:
        raise KeyError(f"docs/teaching.md names a section that no slide has: {section!r}")
    first, last = numbers[0], numbers[-1]
    return f"{first}–{last}" if last > first else f"{first}"


def plan(text: str, made: Mapping[str, Sequence[Titled]]) -> dict[str, str]:
    """Return each chapter's lecture as a line, by its number: "3" to "sections; exploration"."""
    return {
        number: f"{sections}; explore: {exploration}; exercises: {exercises}"
        for number, sections, exploration, exercises in _ROW.findall(numbered(text, made))
    }
