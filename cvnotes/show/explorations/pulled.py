"""Points pulled on a page: what a notebook calls `pull_points` with, made of the page's cells.

A page has no kernel, and a chapter takes long to run. So of the cells before the call only those
statements are run whose names the call needs, and those that these need.
"""

import ast
from collections.abc import Iterator, Sequence
from contextlib import redirect_stdout, suppress
from functools import lru_cache
from io import StringIO
from symtable import symtable
from typing import Any

from cvnotes.base import CvnotesError
from cvnotes.show.explorations.hand import hand_model
from cvnotes.show.explorations.model import Model

_CALL = "pull_points"


@lru_cache(maxsize=4)
def pulled_model(cells: tuple[str, ...], photo: str | None = None) -> Model:
    r"""Return the model of the call of `pull_points` in the last of some cells.

    Parameters
    ----------
    cells : tuple of str
        The page's cells, up to the one with the call.
    photo : str, optional
        The file of a photograph that takes the place of the call's picture.

    Raises
    ------
    CvnotesError
        The last cell does not end in such a call, or there is no model of what that is given.

    Examples
    --------
    >>> cells = (
    ...     "import numpy as np",
    ...     "grey = np.zeros((9, 9))",
    ...     "slow = 1 / 0",
    ...     "def told(picture, points):\n    return 'Here.', []",
    ...     "pull_points(grey, [[1, 2]], told)",
    ... )
    >>> pulled_model(cells).drawing().sentence
    'Here.'
    """
    statements: list[ast.stmt] = []
    for cell in cells:
        with suppress(SyntaxError):  # "%pip", and what a reader has not finished
            statements += ast.parse(cell).body
    call = statements[-1] if statements else None
    if call is None or not _calls(call):
        raise CvnotesError(f"cells: the last one does not end in a call of {_CALL}")
    made: list[Model] = []

    def take(picture: Any, at: Any, tell: Any) -> None:
        made.append(hand_model(picture if photo is None else photo, at, tell))

    space: dict[str, Any] = {"__name__": "__page__"}
    with redirect_stdout(StringIO()):
        exec(compile(ast.Module([*_needed(statements, call)], []), "<page>", "exec"), space)
        space[_CALL] = take
        exec(compile(ast.Module([call], []), "<page>", "exec"), space)
    return made[0]


def _calls(statement: ast.stmt) -> bool:
    return any(
        isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == _CALL
        for node in ast.walk(statement)
    )


def _needed(statements: Sequence[ast.stmt], call: ast.stmt) -> Iterator[ast.stmt]:
    """Give, in their order, the statements that make the names which the call needs."""
    names = [_made_and_used(statement) for statement in statements]
    _, used = _made_and_used(call)
    taken, n = set[int](), -1
    while n != len(taken):  # a function may use what is made below it
        n = len(taken)
        for i, (made, uses) in enumerate(names):
            if used & made:
                taken.add(i)
                used |= uses
    return (statements[i] for i in sorted(taken))


def _made_and_used(statement: ast.stmt) -> tuple[set[str], set[str]]:
    """Return the page's names to which a statement gives a meaning, and those it needs."""
    tables = [symtable(ast.unparse(statement), "<page>", "exec")]
    made = {x.get_name() for x in tables[0].get_symbols() if x.is_assigned() or x.is_imported()}
    used = {x.get_name() for x in tables[0].get_symbols() if x.is_referenced()}
    for table in tables:  # also those of the functions in it, and of the functions in these
        tables += table.get_children()
        used |= {x.get_name() for x in table.get_symbols() if x.is_global()}
    return made, used
