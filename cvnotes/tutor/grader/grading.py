"""Grade handed-in notebooks: each runs in its own process, the verdict is worked out here.

The processes have limits of time and memory, are sealed off where the system lets them, and what
they hand back is numbers only. That keeps mistakes to the row of whoever made them.
"""

import os
import queue
import secrets
from collections.abc import Collection, Iterator, Mapping
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

from cvnotes.base import CvnotesError
from cvnotes.tutor.checker.outcome import clean
from cvnotes.tutor.course import Course, course_named
from cvnotes.tutor.grader.belonging import expected_exercises
from cvnotes.tutor.grader.handed_in import Handin, listed
from cvnotes.tutor.grader.handin import code_cells
from cvnotes.tutor.grader.judging import judged
from cvnotes.tutor.grader.marks import Mark
from cvnotes.tutor.grader.process import Limits, Ran, clear_abandoned, run_notebook, stop
from cvnotes.tutor.grader.source import fingerprint, own_code


def grade_folder(
    folder: Path,
    course: Course,
    *,
    seconds: float = 120.0,
    megabytes: int = 4096,
    jobs: int | None = None,
    executor: Executor | None = None,
    known: Mapping[tuple[str, str, str], Mark] | None = None,
    ours: Collection[Path] = (),
) -> tuple[list[Handin], Iterator[Mark]]:
    """Grade all notebooks below a folder.

    Parameters
    ----------
    folder : Path
        Where they were handed in, in folders of their own or not.
    course : Course
        Whose exercises they answer.
    seconds, megabytes : float and int
        What each notebook may use.
    jobs : int, optional
        How many run at a time; by default one for each processor.
    executor : concurrent.futures.Executor, optional
        What runs them, on this machine or on others, in place of threads of our own. Its workers
        need this package.
    known : mapping, optional
        Marks that were given already, by student, notebook and hash: these are not run again.
    ours : collection of Path, optional
        Files and folders that nobody handed in.

    Returns
    -------
    handed_in, marks
        What there is, and an iterator over its marks, as they come: close it to stop.

    Raises
    ------
    FileError
        There is no such folder, or no notebook in it.
    CvnotesError
        The course is not where it says: its processes would not find it.
    """
    if course_named(course.home) is not course:
        raise CvnotesError(f"{course.home} is another course than the one to grade by")
    handed_in, limits = listed(folder, ours), Limits(seconds, megabytes)
    clear_abandoned()

    def marks() -> Iterator[Mark]:
        batch = secrets.token_hex(8)
        waiting: dict[Future[Mark], Handin] = {}
        done: queue.SimpleQueue[Future[Mark]] = queue.SimpleQueue()
        pool = executor or ThreadPoolExecutor(jobs or os.cpu_count())
        try:
            for one in handed_in:
                mark = (known or {}).get((one.student, one.notebook, one.hash))
                if mark is not None:
                    yield mark
                    continue
                try:
                    waiting[pool.submit(grade, one, course, limits, (folder,), batch)] = one
                except Exception as error:  # a pool whose worker died takes nothing more
                    yield _lost(one, course, error)
            for future in waiting:
                future.add_done_callback(done.put)
            for _ in range(len(waiting)):
                future = done.get()
                try:
                    yield future.result()
                except Exception as error:  # what a worker dies of stays in the row
                    yield _lost(waiting[future], course, error)
        finally:
            stop(batch)
            for future in waiting:
                future.cancel()
            if executor is None:
                pool.shutdown(cancel_futures=True)

    return handed_in, marks()


def _lost(one: Handin, course: Course, error: Exception) -> Mark:
    why = clean(f"{type(error).__name__}: {error}", 120)
    expected = expected_exercises(one.notebook, [], course)
    return Mark(one.student, one.notebook, {}, expected, remark=f"could not be graded: {why}")


def grade(
    one: Handin, course: Course, limits: Limits, hidden: tuple[Path, ...] = (), batch: str = ""
) -> Mark:
    """Grade one notebook, perhaps on another machine; whatever goes wrong is a remark."""
    try:
        return _graded(one, course, limits, hidden, batch)
    except Exception as error:
        return _lost(one, course, error)


def _graded(
    one: Handin, course: Course, limits: Limits, hidden: tuple[Path, ...], batch: str
) -> Mark:
    nothing = Mark(one.student, one.notebook, {}, expected_exercises(one.notebook, [], course))
    if isinstance(one.content, str):
        return replace(nothing, remark=one.content)
    try:
        cells = code_cells(one.content)
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return replace(nothing, remark="not a notebook", content=one.hash)
    # Inputs that nobody knows before, and that are the same if the notebook is graded again.
    seed = int(one.hash[:12], 16)
    ran = run_notebook(cells, seed, course, limits, hidden, batch)
    verdicts, ids = judged(ran.answers, seed, course)
    written = own_code(cells)
    verdicts = {
        name: replace(verdict, code=fingerprint(name, written, course.notebooks))
        for name, verdict in verdicts.items()
    }
    return replace(
        nothing,
        reports=verdicts,
        expected=expected_exercises(one.notebook, list(verdicts), course),
        ids=ids,
        remark="; ".join(_remarks(ran, "check" in written.definitions)),
        content=one.hash,
        sealed=ran.sealed,
    )


def _remarks(ran: Ran, own_check: bool) -> Iterator[str]:
    """Yield what a teacher is to know of a notebook as a whole."""
    failed = ran.finished.get("failed")
    if ran.ended or not ran.finished:
        yield ran.ended or "ended before its last cell"
    elif failed:
        yield f"{failed} cells failed, first: {clean(ran.finished.get('first'), 120)}"
    if own_check:
        yield "has a check of its own"
    elif not ran.answers and ran.finished:
        yield "hands nothing to check"
