"""Try exercises as their author: ``python -m cvnotes.learn.try NAME --with my_exercises.py``.

What a student would notice too late is said in seconds: a stub that does not count as unsolved, a
reference that is not right on every random case, a mistake that passes or is taken for another.
"""

# The name is a keyword: it is run with -m, nobody imports it.
# ruff: noqa: N999

import argparse
from pathlib import Path

from cvnotes.base import CvnotesError
from cvnotes.learn.exercises import COURSE
from cvnotes.tutor.checker.soundness import by_rules, faults


def main(arguments: list[str] | None = None) -> int:
    """Try the exercises that are named; gives the exit code: 0 sound, 1 not."""
    parser = argparse.ArgumentParser(
        prog="python -m cvnotes.learn.try",
        description="Try exercises as their author: right answers pass, mistakes are named.",
    )
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help="which; all of the file if none is named"
    )
    parser.add_argument(
        "--with",
        dest="added",
        action="append",
        default=[],
        type=Path,
        metavar="my_exercises.py",
        help="a file with exercises of your own",
    )
    parser.add_argument(
        "--rules",
        action="store_true",
        help="say of each mistake of the list what the rules say of it without the list",
    )
    args = parser.parse_args(arguments)
    try:
        tried = _by_rules if args.rules else _tried
        added = [name for path in args.added for name in COURSE.add_exercises(path)]
        return max([tried(name) for name in args.names or added or COURSE.exercises], default=0)
    except CvnotesError as error:
        print(f"cvnotes.learn.try: {error}")
        return 1


def _tried(name: str) -> int:
    exercise = COURSE.find(name)
    found = list(faults(exercise))
    mistakes = len(exercise.misconceptions)
    known = f"{mistakes} mistake{'s' * (mistakes != 1)} known by name"
    print(f"{name}: {'sound' if not found else 'not sound'}, {known}")
    for fault in found:
        print(f"  {fault}")
    return int(bool(found))


def _by_rules(name: str) -> int:
    exercise = COURSE.find(name)
    print(f"{name}:")
    for mistake, said in by_rules(exercise):
        print(f"  {mistake:<40} {said}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
