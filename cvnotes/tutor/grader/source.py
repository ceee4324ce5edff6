"""What the text of a notebook says about its answers: whether two students wrote the same.

Running shows whether an answer is right; whose it is, only the text can tell, and only of whoever
does not hide it. So all that is made of this are remarks.
"""

import ast
import copy
from dataclasses import dataclass, field
from functools import cache
from hashlib import sha256
from pathlib import Path

from cvnotes.tutor.checker.parsing import names_set, parsed
from cvnotes.tutor.grader.handin import code_cells

# Functions with fewer nodes than this are equal by nature: there are few ways to write them.
_SHORTEST = 100
Definition = ast.FunctionDef | ast.Assign | ast.AnnAssign


@dataclass
class Code:
    """The definitions of a notebook and what it hands to ``check``.

    Attributes
    ----------
    definitions : dict
        The last definition of each name at the top level.
    handed : dict
        What was handed in last, by exercise.
    """

    definitions: dict[str, Definition] = field(default_factory=dict)
    handed: dict[str, ast.expr] = field(default_factory=dict)

    def functions(self, name: str) -> list[Definition]:
        """Return the definitions that an answer is made of, as far as they are the notebook's."""
        handed = self.handed.get(name)
        found: dict[str, Definition] = {}
        open_ = _names(handed) if handed is not None else []
        while open_:
            used = open_.pop()
            if used in self.definitions and used not in found:
                found[used] = self.definitions[used]
                open_ += _names(found[used])
        return [found[used] for used in sorted(found, key=lambda n: found[n].lineno)]


def own_code(cells: list[str]) -> Code:
    r"""Read the code cells of a notebook; what is no Python is left out.

    Examples
    --------
    >>> code = own_code(["def f(x):\n    return x", "check('lift', f)"])
    >>> list(code.definitions), list(code.handed)
    (['f'], ['lift'])
    """
    found = Code()
    for cell in cells:
        lines = ["" if line.lstrip()[:1] in ("%", "!") else line for line in cell.splitlines()]
        try:
            tree = parsed("\n".join(lines))
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            continue
        for node in tree.body:
            _note(node, found)
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and _called(node) == "check" and len(node.args) > 1:
                exercise = node.args[0]
                if isinstance(exercise, ast.Constant) and ast.unparse(node.args[1]) != "...":
                    found.handed[str(exercise.value)] = node.args[1]
    return found


def fingerprint(name: str, written: Code, notebooks: Path | None) -> str:
    """Return a fingerprint of an answer that is the same for other names and other comments.

    It is empty where the answer is too short to tell two students apart, or stands in the course's
    own notebooks, as its stubs do.
    """
    shapes = {_shape(tree): tree for tree in written.functions(name)}
    given = _given(notebooks) if notebooks is not None else set()
    own = {shape: tree for shape, tree in shapes.items() if shape not in given}
    if sum(1 for tree in own.values() for _ in ast.walk(tree)) < _SHORTEST:
        return ""
    return sha256("\n".join(own).encode()).hexdigest()[:16]


@cache
def _given(notebooks: Path) -> set[str]:
    """Return the shapes of what the course's own notebooks define: everybody has that."""
    shapes: set[str] = set()
    for path in notebooks.glob("*.ipynb"):
        definitions = own_code(code_cells(path.read_bytes())).definitions
        shapes |= {_shape(tree) for tree in definitions.values()}
    return shapes


def _note(node: ast.stmt, found: Code) -> None:
    if isinstance(node, ast.FunctionDef):
        found.definitions[node.name] = node
    elif isinstance(node, ast.Assign | ast.AnnAssign):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        for target in targets:
            if isinstance(target, ast.Name):
                found.definitions[target.id] = node


def _called(node: ast.Call) -> str:
    function = node.func
    return function.id if isinstance(function, ast.Name) else getattr(function, "attr", "")


def _names(tree: ast.AST) -> list[str]:
    return [node.id for node in ast.walk(tree) if isinstance(node, ast.Name)]


def _shape(tree: ast.AST) -> str:
    """Write a definition without comments, docstrings, types and its own names."""
    tree = copy.deepcopy(tree)
    numbers: dict[str, str] = {}
    own = {*names_set(tree)}
    own |= {n.arg for n in ast.walk(tree) if isinstance(n, ast.arg)}
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            node.name, node.decorator_list, node.returns = "f", [], None
            head = node.body[0]
            if isinstance(head, ast.Expr) and isinstance(head.value, ast.Constant):
                node.body = node.body[1:] or [ast.Pass()]
        elif isinstance(node, ast.arg):
            node.annotation = None
            node.arg = numbers.setdefault(node.arg, f"n{len(numbers)}")
        elif isinstance(node, ast.Name) and node.id in own:
            node.id = numbers.setdefault(node.id, f"n{len(numbers)}")
    return ast.dump(tree)
