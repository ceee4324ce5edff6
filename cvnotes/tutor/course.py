"""A course: its exercises by name, and what a student may ask of them."""

import difflib
import importlib
import importlib.util
import inspect
import re
import sys
import textwrap
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from cvnotes.base import CvnotesError, FileError
from cvnotes.tutor.checker.agreement import NOTEBOOK_SEED, verdict
from cvnotes.tutor.checker.exercise import Exercise
from cvnotes.tutor.checker.repairs import pointed
from cvnotes.tutor.checker.report import OPEN, WRONG, Report, Source, Words
from cvnotes.tutor.checker.sandbox import ask
from cvnotes.tutor.remembered import remember, shell, solved_before

# The notebooks that are no chapter: one may be in a course, and teachers write the other.
MORE, OWN = "more_exercises", "own_exercises"


@dataclass
class Session:
    """What one student did in one notebook."""

    solved: set[str] = field(default_factory=set)
    hints: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    exact: dict[str, str] = field(default_factory=dict)


class Course:
    """The exercises of a course, and where what belongs to them is.

    Parameters
    ----------
    home : str
        Where it is found by other processes: ``"my_course:COURSE"``, a module and a name in it.
    exercises : iterable of Exercise
        In the order of the course.
    further : sequence of str
        The names of those that the notebook ``more_exercises`` asks for, not that of a chapter.
    faces : sequence of str
        The modules that notebooks import ``check`` from; by default `home`.
    notebooks, data : Path or None
        The course's own notebooks, and what stands beside them as ``data`` when one is graded.

    Attributes
    ----------
    exercises : dict
        By name. Exercises that a teacher adds are among them.
    """

    def __init__(
        self,
        home: str,
        exercises: Iterable[Exercise],
        *,
        further: Iterable[str] = (),
        faces: Iterable[str] = (),
        notebooks: Path | None = None,
        data: Path | None = None,
    ) -> None:
        self.home, self.notebooks, self.data = home, notebooks, data
        self.exercises = {exercise.name: exercise for exercise in exercises}
        self.further = frozenset(further)
        self.faces = tuple(faces) or (home.partition(":")[0],)
        self.session = Session()
        # Exercises that a teacher has added, by name, with the file that they come from.
        self.added: dict[str, Path] = {}

    def __reduce__(self) -> Any:
        """Travel to other processes and machines by name, with the files that were added."""
        return course_named, (self.home, self.added_files())

    def add_exercises(self, path: str | Path) -> tuple[str, ...]:
        """Add the exercises of a file, in place of what came from it before; give their names.

        Raises
        ------
        CvnotesError
            The file cannot be read or run, has no exercises, or takes a name of the course.
        """
        path = Path(path).expanduser()
        before = tuple(name for name, origin in self.added.items() if origin.name == path.name)
        if not path.is_file():
            if before:  # a grader has added them already, from where the teacher keeps them
                return before
            raise FileError(f"{path}: there is no such file with exercises")
        new = exercises_in(path)
        for exercise in new:
            if exercise.name in self.exercises and exercise.name not in before:
                raise CvnotesError(f"{path.name}: there is an exercise {exercise.name!r} already")
        for name in before:
            del self.exercises[name], self.added[name]
        self.exercises.update((exercise.name, exercise) for exercise in new)
        self.added.update((exercise.name, path.resolve()) for exercise in new)
        return tuple(exercise.name for exercise in new)

    def added_files(self) -> tuple[Path, ...]:
        """Return the files that exercises were added from."""
        return tuple(dict.fromkeys(self.added.values()))

    def check(self, name: str, answer: Any, *, student: str | int | None = None) -> Report:
        """Try an answer, and say what holds, what does not, and why.

        Parameters
        ----------
        name : str
            Which exercise.
        answer : any
            The function, without brackets; or a number, a letter, or several functions by name.
        student : str or int, optional
            The id, for exercises that have numbers of the student's own.

        Raises
        ------
        CvnotesError
            There is no such exercise, or the id is missing.
        """
        exercise = self.asked(name, student)
        report = verdict(exercise, {NOTEBOOK_SEED: ask(exercise, answer, NOTEBOOK_SEED)})
        self.session.exact.pop(name, None)
        if report.passed:
            self.session.solved.add(name)
            remember(self.session.solved)
        elif report.verdict == WRONG:
            report = self._pointed(report, exercise, answer)
        self._offer_what_reports_name()
        call = f'check("{name}", {_name_of(answer) or exercise.variable})'
        if report.verdict == OPEN:  # the same below each exercise that was not begun
            return replace(report, call=call)
        return replace(report, call=call, progress=self._progress_in(self.notebook_of(exercise)))

    def _pointed(self, report: Report, exercise: Exercise, answer: Any) -> Report:
        """Say where the answer leaves the way; the formula from the second refusal on."""
        again = self.session.refused[exercise.name] > 0
        self.session.refused[exercise.name] += 1
        found = pointed(answer, exercise, report.misconception)
        report = replace(
            report,
            misconception=report.misconception or found.name or None,
            located=found.sentence,
            exact=report.exact or found.exact,
        )
        self.session.exact[exercise.name] = report.exact
        return report if again else replace(report, exact="")

    def hint(self, name: str) -> Words:
        """Return a hint; the next one each time, and the last again.

        After an answer that left the way at a step it begins with that step, exactly.
        """
        exercise, given = self.find(name), self.session.hints
        number = min(given[name], len(exercise.hints) - 1)
        given[name] += 1
        title = f"{name}, hint {number + 1} of {len(exercise.hints)}"
        step = self.session.exact.get(name)
        exact = (f"The step that is missing first is {step}.",) if step else ()
        return Words(title, (*exact, exercise.hints[number]))

    def solution(self, name: str) -> Source:
        """Show one right answer: the source of the reference."""
        exercise = self.find(name)
        sources = [function_behind(source) for source in exercise.sources or (exercise.reference,)]
        code = "\n\n".join(textwrap.dedent(inspect.getsource(source)) for source in sources)
        places = sorted({source.__module__ for source in sources})
        return Source(f"{name}: one solution, from {' and '.join(places)}", code)

    def progress(self) -> Words:
        """Return how far the student is, notebook by notebook, today and on the days before."""
        notebooks = sorted({*map(self.notebook_of, self.exercises.values())})
        solved = self._solved() & set(self.exercises)
        title = f"{len(solved)} of {len(self.exercises)} exercises solved"
        return Words(title, tuple(self._progress_in(n) for n in notebooks))

    def find(self, name: str) -> Exercise:
        """Return an exercise by name.

        Raises
        ------
        CvnotesError
            There is no such exercise; the message names those that sound like it. Or this is
            no name.
        """
        if not isinstance(name, str):
            raise CvnotesError('the name of the exercise comes first: check("lift", my_lift)')
        exercise = self.exercises.get(name)
        if exercise is None:
            near = difflib.get_close_matches(str(name), self.exercises, n=3, cutoff=0.3)
            meant = f"; did you mean {' or '.join(map(repr, near))}?" if near else ""
            raise CvnotesError(f"there is no exercise {name!r}{meant}")
        return exercise

    def asked(self, name: str, student: str | int | None) -> Exercise:
        """Return an exercise as one student gets it: some have numbers of the student's own.

        Raises
        ------
        CvnotesError
            There is no such exercise, or it needs the student's id.
        """
        exercise = self.find(name)
        if exercise.personal is None:
            return exercise
        if student is None:
            raise CvnotesError(f'{name} has other numbers for each student: add student="your id"')
        return exercise.personal(str(student))  # many ids are numbers

    def notebook_of(self, exercise: Exercise) -> str:
        """Return which notebook asks for an exercise, as `short_name` calls it."""
        if exercise.name in self.added:
            return OWN
        return MORE if exercise.name in self.further else f"{exercise.chapter:02d}"

    def _offer_what_reports_name(self) -> None:
        """Let hint, solution and progress be at hand where nothing else is called so.

        Reports name them; a notebook that imported check alone would not know them.
        """
        if (running := shell()) is not None:
            for function in (self.hint, self.solution, self.progress):
                running.user_ns.setdefault(function.__name__, function)

    def _solved(self) -> set[str]:
        """Return what was solved here, and in other notebooks and on other days."""
        return self.session.solved | set(solved_before())

    def _progress_in(self, notebook: str) -> str:
        names = [e.name for e in self.exercises.values() if self.notebook_of(e) == notebook]
        solved = self._solved()
        open_ = [name for name in names if name not in solved]
        left = f"; next: {open_[0]}" if open_ else ""
        others = {MORE: "Further exercises", OWN: "Added exercises"}
        title = others.get(notebook) or f"Chapter {int(notebook)}"
        return f"{title}: {len(names) - len(open_)} of {len(names)} solved{left}."


def short_name(notebook: str) -> str:
    """Return the number of a chapter's notebook, and of another its whole name.

    Examples
    --------
    >>> short_name("06_homography_dlt.ipynb"), short_name("more_exercises.ipynb")
    ('06', 'more_exercises')
    """
    stem = Path(notebook).stem
    return stem[:2] if re.match(r"\d\d_", stem) else stem


def course_named(home: str, added: Iterable[Path] = ()) -> Course:
    """Import a course by the name of its home, and add files of exercises that it has not yet."""
    module, _, name = home.partition(":")
    course = getattr(importlib.import_module(module), name, None)
    if not isinstance(course, Course):
        raise CvnotesError(f"{home}: expected the home of a Course, as my_course:COURSE")
    for path in added:
        if path not in course.added_files():
            course.add_exercises(path)
    return course


def exercises_in(path: Path) -> tuple[Exercise, ...]:
    """Run a file and give its ``EXERCISES``."""
    name = f"own_{re.sub(r'[^0-9a-zA-Z_]', '_', path.stem)}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise CvnotesError(f"{path.name}: exercises are in a Python file, my_exercises.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # where inspect finds the source of a solution
    try:
        spec.loader.exec_module(module)
        found = tuple(module.EXERCISES)
    except Exception as error:
        raise CvnotesError(f"{path.name}: {type(error).__name__}: {error}") from None
    if not found or not all(isinstance(exercise, Exercise) for exercise in found):
        raise CvnotesError(f"{path.name}: EXERCISES is a tuple of Exercise(…), with one at least")
    return found


def _name_of(answer: Any) -> str:
    """Return the name of a function, if it has one that can be written."""
    name = getattr(answer, "__name__", "")
    return name if isinstance(name, str) and name.isidentifier() else ""


def function_behind(source: Any) -> Any:
    """Return the function behind a property; a function is its own."""
    return getattr(source, "fget", None) or getattr(source, "func", None) or source
