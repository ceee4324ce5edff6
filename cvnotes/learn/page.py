"""Exercises on a page: what is written into a box is run as the cell of a notebook would be.

A page has no kernel. Python in a worker of the browser (``docs/static/live/worker.js``) runs the
box; an endless loop there is ended by the page, which ends the worker and shows what `late` said
before.
"""

import ast
import contextlib
import json
import linecache
import traceback
from collections.abc import Sequence
from html import escape
from typing import Any

from cvnotes.learn.exercises import COURSE, check, hint, progress, solution
from cvnotes.tutor.checker.attempt import Printed
from cvnotes.tutor.checker.outcome import Outcome, clean
from cvnotes.tutor.checker.remarks import trouble
from cvnotes.tutor.checker.report import WRONG, Report

Space = dict[str, Any]


def answered(question: str) -> str:
    r"""Run the cell of an exercise, and give what it shows.

    Parameters
    ----------
    question : str
        JSON: ``exercise``, its name; ``cell``, what is written in the box, with the call of
        `check`; ``before``, the boxes above it, whose functions it may use; ``cells``, the page's
        cells, whose imports hold here too; ``solved``, the exercises solved so far.

    Returns
    -------
    str
        JSON: ``html``, ``passed`` and ``solved``.

    Examples
    --------
    >>> cell = "def my_drop(x_h):\n    return x_h[:, :-1]\n\ncheck('drop', my_drop)"
    >>> json.loads(answered(json.dumps({"exercise": "drop", "cell": cell})))["html"][:44]
    '<div><strong>drop: ✗ not yet right.</strong>'
    """
    given = json.loads(question)
    COURSE.session.solved |= set(given.get("solved", ())) & set(COURSE.exercises)
    space, printed = _space(given.get("cells", ()), given.get("before", ())), Printed()
    report: Any = None
    try:
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
            report = run_cell(given["cell"], space, f"<{given['exercise']}>")
        shown = report._repr_html_() if hasattr(report, "_repr_html_") else ""
        shown = shown or f"<pre>{escape(repr(report)[:2000])}</pre>"
    except BaseException as error:
        shown = _refused(given["exercise"], _what(error, given["cell"], f"<{given['exercise']}>"))
    if printed.text:
        shown += f"<p>The cell printed:</p><pre>{escape(printed.text)}</pre>"
    passed = isinstance(report, Report) and report.passed
    return json.dumps(
        {"html": shown, "passed": passed, "solved": sorted(COURSE.session.solved)},
        ensure_ascii=False,
    )


def helped(name: str, given: int) -> str:
    """Return one more hint, as HTML, after so many.

    Examples
    --------
    >>> helped("lift", 1)[:47]
    '<div><strong>lift, hint 2 of 3</strong><ul styl'
    """
    COURSE.session.hints[name] = given
    return hint(name)._repr_html_()


def solved(name: str) -> str:
    """Return a solution, as HTML."""
    return solution(name)._repr_html_()


def late(name: str, seconds: float) -> str:
    """Say, as HTML, what a page shows where a cell has to be stopped.

    Examples
    --------
    >>> late("lift", 5)[45:]
    'Your function was stopped after 5 seconds: does a loop never end?</div>'
    """
    return _refused(name, trouble(Outcome("late", words=f"{seconds:g}"), COURSE.find(name)))


def run_cell(source: str, space: Space, name: str) -> Any:
    """Run the statements of a cell; gives the value of the last one, if it has one.

    What would only be displayed is left out: the page has its pictures already.
    """
    linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)
    body = [x for x in ast.parse(source, name).body if not _displays(x)]
    last = body.pop() if body else None
    if last is not None and not isinstance(last, ast.Expr):
        body.append(last)
    exec(compile(ast.Module(body, []), name, "exec"), space)
    if not isinstance(last, ast.Expr):
        return None
    return eval(compile(ast.Expression(last.value), name, "eval"), space)


def _space(cells: Sequence[str], before: Sequence[str]) -> Space:
    """Return what a cell finds: the page's imports, and what the boxes above define."""
    space: Space = {
        "__name__": "__page__", "check": check, "hint": hint, "solution": solution,
        "progress": progress,
    }  # fmt: skip
    importing = (ast.Import, ast.ImportFrom)
    defining = (*importing, ast.FunctionDef, ast.Assign, ast.ClassDef)
    for sources, kinds in ((cells, importing), (before, defining)):
        for statement in (x for source in sources for x in _statements(source, kinds)):
            _try(statement, space)
    return space


def _statements(source: str, kinds: tuple[type[ast.stmt], ...]) -> list[ast.stmt]:
    try:
        return [x for x in ast.parse(source).body if isinstance(x, kinds)]
    except (SyntaxError, ValueError):
        return []


def _try(statement: ast.stmt, space: Space) -> None:
    """Run what may fail: it is asked about only if the cell uses it."""
    with contextlib.suppress(Exception), contextlib.redirect_stdout(Printed()):
        exec(compile(ast.Module([statement], []), "<page>", "exec"), space)


def _displays(statement: ast.stmt) -> bool:
    call = statement.value if isinstance(statement, ast.Expr) else None
    return isinstance(call, ast.Call) and ast.unparse(call.func) == "display"


def _refused(exercise: str, why: str) -> str:
    return Report(exercise, WRONG, why)._repr_html_()


def _what(error: BaseException, cell: str, name: str) -> str:
    """Describe in which line of the cell something went wrong, and what."""
    words = clean(error) or "without words"
    line, said = 0, f"raised {type(error).__name__}: {words}"
    if isinstance(error, SyntaxError):
        line, said = error.lineno or 0, f"cannot be read: {clean(error.msg)}"
    else:
        for frame, at in traceback.walk_tb(error.__traceback__):
            line = at if frame.f_code.co_filename == name else line
    lines = cell.splitlines()
    if not 0 < line <= len(lines):
        return f"The cell {said}."
    return f"Line {line}, `{clean(lines[line - 1], 80)}`, {said}."
