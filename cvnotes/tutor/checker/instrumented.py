"""A student's function with all that it works out on its way, and with values put in its place."""

import ast
import copy
import inspect
import textwrap
from collections import Counter
from collections.abc import Callable
from types import FunctionType
from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.base.text import clipped
from cvnotes.tutor.checker.parsing import parsed

_LIBRARIES = ("np", "numpy", "math", "scipy", "linalg", "cv2")
_MOST = 4000  # numbers in a value
_ROUNDS = 200  # evaluations of one expression
_LONGEST = 60  # characters of an expression that is quoted


class Instrumented:
    """A function whose expressions are numbered, and looked at while it runs.

    Parameters
    ----------
    function : callable
        Written in Python; functions of the same notebook that it calls are looked into as well.

    Attributes
    ----------
    text : list of str
        What the student wrote, by the number of the expression.
    reads : list of list of int
        The names in an expression, by their numbers.
    function : callable
        What is looked at, and calls this instance meanwhile.

    Raises
    ------
    OSError, TypeError, SyntaxError
        Its source is not to be had.

    Examples
    --------
    >>> twice = Instrumented(_example)
    >>> [twice.text[i] for i in twice.values((3.0,))]
    ['x', 'x + 1', 'y', '2 * y']
    >>> twice((3.0,), {1: np.array(5.0)})
    10.0
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self.text: list[str] = []
        self.reads: list[list[int]] = []
        self._seen: dict[int, list[Array | None]] = {}
        # What is put in the place of expressions, and how often it was; None while all is noted.
        self._put: dict[int, Array] | None = None
        self._times: Counter[int] = Counter()
        self.function = self._made(function)

    def values(self, args: tuple[Any, ...]) -> dict[int, Array]:
        """Run it; give what its expressions gave: of a loop, one below the other."""
        self._seen, self._put = {}, None
        self._run(args)
        return {
            i: array for i, values in self._seen.items() if (array := _stacked(values)) is not None
        }

    def is_repeated(self, number: int) -> bool:
        """Return whether an expression was worked out more than once when values were asked for."""
        return len(self._seen.get(number, ())) > 1

    def __call__(self, args: tuple[Any, ...], put: dict[int, Array] | None = None) -> Any:
        """Run it, with values in the place of some expressions; None if that raises."""
        self._put, self._times = put or {}, Counter()
        return self._run(args)

    def _run(self, args: tuple[Any, ...]) -> Any:
        try:
            return self.function(*copy.deepcopy(args))
        except Exception:
            return None

    def _look(self, number: int, value: Any) -> Any:
        """Note what an expression gave, or give something else in its place."""
        if self._put is None:
            seen = self._seen.setdefault(number, [])
            if len(seen) < _ROUNDS:
                seen.append(numbers_in(value))
            return value
        if number not in self._put:
            return value
        new, old = self._put[number], np.asarray(value)
        if new.size != old.size and old.size:  # one of the rounds of a loop
            new = np.reshape(new, (-1, *old.shape))[self._times[number]]
            self._times[number] += 1
        new = np.reshape(new, old.shape) if new.size == old.size else new
        if old.dtype.kind in "iu" and (new == np.rint(new)).all():  # it may be an index
            new = new.astype(old.dtype)
        return new.item() if new.ndim == 0 else np.array(new)

    def _made(self, function: Callable[..., Any]) -> Callable[..., Any]:
        names = dict(function.__globals__)
        names |= _closed_over(function)
        own = {function.__name__: function}
        for name, other in names.items():  # functions of the student's own that it calls
            if isinstance(other, FunctionType) and other.__module__ == function.__module__:
                own[name] = other
        names |= self._known
        called = _called(function)
        made = None
        for name, one in own.items():
            if one is not function and name not in called:
                continue
            tree = self._tree(one)
            exec(compile(ast.Module([tree], []), "<looked into>", "exec"), names)
            new = names[tree.name]
            new.__defaults__, new.__kwdefaults__ = one.__defaults__, one.__kwdefaults__
            names[name] = new
            made = new if one is function else made
        assert made is not None
        return made  # type: ignore[no-any-return]

    def _tree(self, function: Callable[..., Any]) -> ast.FunctionDef:
        source = textwrap.dedent(inspect.getsource(function))
        tree = parsed(source)
        found = next((n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)), None)
        if found is None:
            [one] = [n for n in ast.walk(tree) if isinstance(n, ast.Lambda)]
            found = ast.FunctionDef("_lambda_", one.args, [ast.Return(one.body)], [])
        found.decorator_list, found.returns = [], None
        found.args.defaults = []
        found.args.kw_defaults = [None] * len(found.args.kwonlyargs)
        for argument in ast.walk(found.args):
            if isinstance(argument, ast.arg):
                argument.annotation = None
        return ast.fix_missing_locations(self._marked(found, source))

    @property
    def _known(self) -> dict[str, Any]:
        """What the code that is made has to know."""
        return {"_look_": self._look}

    def _marked(self, function: ast.FunctionDef, source: str) -> ast.FunctionDef:
        """Mark the expressions of a function by numbers."""
        marking = _Marking(source, self.text, self.reads)
        function.body = [marking.visit(statement) for statement in function.body]
        return function


class _Marking(ast.NodeTransformer):
    """Wrap every expression that is worked out: ``_look_(number, expression)``."""

    def __init__(self, source: str, text: list[str], reads: list[list[int]]) -> None:
        self.source, self.text, self.reads = source, text, reads

    def generic_visit(self, node: ast.AST) -> ast.AST:
        """Wrap what has a value, from the inside out."""
        skipped = (ast.Constant, ast.Starred, ast.Slice, ast.JoinedStr, ast.Lambda, ast.Attribute)
        is_read = isinstance(getattr(node, "ctx", ast.Load()), ast.Load)
        wrapped = isinstance(node, ast.expr) and is_read and not isinstance(node, skipped)
        text = self._text(node) if wrapped else ""
        super().generic_visit(node)
        return self._look(node, text) if wrapped else node

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        """Look at ``x.T``; leave ``np.pi`` and what is stored as it is."""
        if not isinstance(node.ctx, ast.Load) or _root(node) in _LIBRARIES:
            return node
        text = self._text(node)
        node.value = self.visit(node.value)
        return self._look(node, text) if node.attr in ("T", "mT") else node

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Look at a result and at arguments, not at the name of what is called."""
        text = self._text(node)
        if isinstance(node.func, ast.Attribute) and _root(node.func) not in _LIBRARIES:
            node.func.value = self.visit(node.func.value)
        node.args = [self.visit(argument) for argument in node.args]
        for keyword in node.keywords:
            if keyword.arg != "axis":
                keyword.value = self.visit(keyword.value)
        return self._look(node, text)

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        """Look at an entry, not at its index."""
        if not isinstance(node.ctx, ast.Load):
            return node
        text = self._text(node)
        node.value = self.visit(node.value)
        return self._look(node, text)

    def _text(self, node: ast.AST) -> str:
        text = ast.get_source_segment(self.source, node) or ast.unparse(node)
        return clipped(" ".join(text.split()), _LONGEST)

    def _look(self, node: Any, text: str) -> ast.Call:
        own = len(self.text)
        self.text.append(text)
        read = [own] if isinstance(node, ast.Name) else []
        for call in ast.walk(node):
            match call:
                case ast.Call(ast.Name("_look_"), [ast.Constant(int() as inner), ast.Name()]):
                    read.append(inner)
        self.reads.append(read)
        number = ast.Constant(own)
        return ast.copy_location(ast.Call(ast.Name("_look_", ast.Load()), [number, node], []), node)


def _root(node: ast.expr) -> str:
    while isinstance(node, ast.Attribute):
        node = node.value
    return node.id if isinstance(node, ast.Name) else ""


def _called(function: Callable[..., Any]) -> set[str]:
    """Return the names that a function, and those it calls, may call."""
    found: set[str] = set()
    waiting = [function.__code__]
    while waiting:
        code = waiting.pop()
        for name in {*code.co_names, *code.co_freevars} - found:
            found.add(name)
            other = function.__globals__.get(name)
            if isinstance(other, FunctionType) and other.__module__ == function.__module__:
                waiting.append(other.__code__)
    return found


def _closed_over(function: Callable[..., Any]) -> dict[str, Any]:
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    found = {}
    for name, cell in cells:
        try:
            found[name] = cell.cell_contents
        except ValueError:  # not defined yet
            continue
    return found


def numbers_in(value: Any) -> Array | None:
    """Return a copy of a value as numbers; None if it is none, or too much to be compared."""
    if not isinstance(value, int | float | np.ndarray | np.generic | list | tuple):
        return None
    try:
        array = np.array(value, dtype=np.float64)
    except (ValueError, TypeError):
        return None
    return array if 0 < array.size <= _MOST else None


def _stacked(values: list[Array | None]) -> Array | None:
    """Return the one value of an expression; those of a loop as rows, if they are alike."""
    there = [value for value in values if value is not None]
    if len(there) < len(values) or len({value.shape for value in there}) != 1:
        return None
    return there[0] if len(there) == 1 else np.stack(there)


def _example(x: float) -> float:
    y = x + 1
    return 2 * y
