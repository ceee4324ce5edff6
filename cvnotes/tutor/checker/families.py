"""Families of slips: all that may slip in the steps of an exercise, made from their own source.

One program holds them all (mutants in one schema): every place of the steps asks a switch which of
its forms is meant. So a family is compiled once, and a slip is a setting of the switches.
"""

import ast
import copy
import operator
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache, partial
from itertools import combinations
from typing import Any, NamedTuple, TypeVar

import numpy as np

from cvnotes.base import Array
from cvnotes.tutor.checker.equality import AS_NEAR, TOLERANCE
from cvnotes.tutor.checker.foreseen import explains
from cvnotes.tutor.checker.steps import Line, lines_of
from cvnotes.tutor.checker.wrong_answer import Found, WrongAnswer

# What slips, and what is said of it; the likely ones first. {0} is where.
KINDS = {
    "stopped": "you stopped on the way: that is {0}.",
    "sign": "a sign is wrong in {0}.",
    "order": "two things are in the wrong order in {0}.",
    "transposition": "something is transposed that should not be, or not where it should, in {0}.",
    "power": "a power is wrong in {0}.",
    "factor": "a number is wrong in {0}.",
    "left out": "something is left out in {0}.",
    "upside down": "a fraction is upside down, or a product divided, in {0}.",
    "index": "an index is wrong in {0}.",
    "axis": "an axis is wrong in {0}.",
    "brackets": "brackets are wrong in {0}.",
    "* for @": "a product of numbers stands for one of matrices, or the other way round, in {0}.",
    "function": "another function belongs in {0}.",
    "name": "one name stands for another in {0}.",
    "line left out": "a step is left out: {0}.",
    "line too early": "a step comes too early: {0}.",
}
_KINDS = tuple(KINDS)
# From how many of the likeliest slips pairs are made.
_PAIRED = 24
# A family is not asked about answers with more numbers, nor grows larger.
_LARGEST, _MOST = 20_000, 700
# Nodes of an expression that may stand elsewhere in the same form.
_SHORT = 16


class Slip(NamedTuple):
    """One slip: its kind, the lines it is in, and the form that each place takes."""

    kind: str
    lines: tuple[int, ...]
    setting: tuple[tuple[int, int], ...]
    everywhere: bool = False


@dataclass(frozen=True, eq=False)
class Family:
    """All slips of the steps of an exercise.

    Attributes
    ----------
    lines : tuple of Line
        The steps.
    slips : tuple of Slip
        The likely ones first.
    places : list of int
        The switches.
    function : callable
        The steps, as the switches say.
    """

    lines: tuple[Line, ...]
    slips: tuple[Slip, ...]
    places: list[int]
    function: Callable[..., Any]

    def gives(self, slip: Slip) -> Callable[..., Any]:
        """Return the steps with a slip in them."""
        return partial(self._run, slip)

    def _run(self, slip: Slip, *args: Any) -> Any:
        for place, form in slip.setting:
            self.places[place] = form
        try:
            given = np.asarray(self.function(*args), dtype=np.float64)
        except Exception:  # whatever a slip leads to
            return None
        finally:
            for place, _ in slip.setting:
                self.places[place] = 0
        return given

    @cached_property
    def pairs(self) -> tuple[Slip, ...]:
        """Two slips of the likeliest kinds, at two places."""
        likely = [s for s in self.slips if len(s.setting) == 1 and s.kind != "stopped"]
        singles = likely[:_PAIRED]
        return tuple(
            Slip(a.kind, (*a.lines, *b.lines), (*a.setting, *b.setting))
            for a, b in combinations(singles, 2)
            if a.setting[0][0] != b.setting[0][0] and a.kind == b.kind
        )

    def found(self, slip: Slip) -> Found:
        """Put a slip into a name, a sentence without the formula, and the formula."""
        words = " and in ".join(dict.fromkeys(self.lines[i].words for i in slip.lines))
        said = KINDS[slip.kind].format(words)
        said = f"{said[0].upper()}{said[1:]}"
        if slip.everywhere:
            said = f"{said[:-1]}, everywhere."
        exact = "; ".join(dict.fromkeys(self.lines[i].code for i in slip.lines))
        return Found(f"{slip.kind} in {words}", said, exact=exact)


def slipped_step(answer: WrongAnswer) -> Found | None:
    """Name the one slip in the steps, or two, that gives what the student's function gave."""
    exercise = answer.exercise
    case, outcome = answer.shown
    if exercise.steps is None or outcome.value is None or outcome.value.size > _LARGEST:
        return None
    family = family_of(exercise.steps)
    for slips in (family.slips, family.pairs):
        results = _results(family, slips is family.pairs, _Arguments(case.args))
        for slip, given in zip(slips, results, strict=True):
            if (
                given is not None
                and given.shape == outcome.value.shape
                and exercise.same(outcome.value, given, AS_NEAR * TOLERANCE)
                and explains(family.gives(slip), answer, exercise.same)
            ):
                return family.found(slip)
    return None


class _Arguments:
    """Arguments by their values, to find again what they gave."""

    def __init__(self, args: tuple[Any, ...]) -> None:
        self.args = args
        self.key = tuple(np.asarray(x).tobytes() for x in args)

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Arguments) and self.key == other.key


@lru_cache(maxsize=256)
def _results(family: Family, pairs: bool, given: _Arguments) -> tuple[Array | None, ...]:
    slips = family.pairs if pairs else family.slips
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return tuple(family.gives(slip)(*copy.deepcopy(given.args)) for slip in slips)


@cache
def family_of(steps: Callable[..., Any]) -> Family:
    """Make the family of a function of steps, once.

    Examples
    --------
    >>> family = family_of(_example)
    >>> [family.gives(slip)(2.0).item() for slip in family.slips if slip.kind == "order"]
    [-2.0, -2.0]
    """
    function, lines = lines_of(steps)
    maker = _Maker(function)
    space = {**steps.__globals__, "_form_": maker.places, "_apply_": maker.apply}
    exec(compile(ast.Module([maker.made], []), "<family>", "exec"), space)
    slips = sorted(maker.slips, key=lambda slip: (_KINDS.index(slip.kind), slip.everywhere))
    made: Callable[..., Any] = space[function.name]
    return Family(tuple(lines), tuple(slips[:_MOST]), maker.places, made)


# A form is another expression, or another function of what two operands give.
Form = tuple[str, ast.expr]
Applied = Callable[[Any, Any], Any]
_Node = TypeVar("_Node", bound=ast.AST)


class _Maker:
    """Puts a switch at each place of the steps."""

    def __init__(self, function: ast.FunctionDef) -> None:
        self.places: list[int] = []
        self.slips: list[Slip] = []
        self._applied: dict[int, list[Applied]] = {}
        self._line = 0
        self._set: dict[str, int] = {}
        self._alike: dict[tuple[str, str, str], list[tuple[int, int, int]]] = {}
        self.names = _names(function)
        body = [self._statement(i, statement) for i, statement in enumerate(function.body)]
        self.made = copy.copy(function)
        self.made.body = self._moved(function.body, body)
        self.made.returns, self.made.decorator_list = None, []
        for argument in function.args.args:
            argument.annotation = None
        self._everywhere()

    def apply(self, place: int, left: Any, right: Any) -> Any:
        """Return what the form of a place makes of its operands."""
        return self._applied[place][self.places[place]](left, right)

    def _place(self) -> int:
        self.places.append(0)
        return len(self.places) - 1

    def _asked(self, place: int, form: int) -> ast.expr:
        switch = ast.Subscript(ast.Name("_form_", ast.Load()), ast.Constant(place), ast.Load())
        return ast.Compare(switch, [ast.Eq()], [ast.Constant(form)])

    def _statement(self, i: int, statement: ast.stmt) -> ast.stmt:
        self._line = i
        new = copy.copy(statement)
        if isinstance(new, ast.For):
            new.body = [self._statement(i, inner) for inner in new.body]
        if isinstance(new, ast.Assign | ast.AugAssign | ast.Return) and new.value is not None:
            new.value = self._switched(new.value)
        if isinstance(new, ast.Assign) and isinstance(new.targets[0], ast.Tuple):
            return self._exchanged(new, new.targets[0])
        if isinstance(new, ast.Assign) and isinstance(new.targets[0], ast.Name):
            self._set[new.targets[0].id] = i
        if isinstance(new, ast.Return) and new.value is not None:
            new.value = self._stopped(new.value)
        return _placed(new)

    def _stopped(self, returned: ast.expr) -> ast.expr:
        """Let what one of the lines gives come back in place of the answer."""
        place = self._place()
        for form, (name, line) in enumerate(self._set.items(), 1):
            self.slips.append(Slip("stopped", (line,), ((place, form),)))
            step = ast.Name(name, ast.Load())
            returned = _placed(ast.IfExp(self._asked(place, form), step, returned))
        return returned

    def _exchanged(self, statement: ast.Assign, names: ast.Tuple) -> ast.stmt:
        """Let two names on the left be in the other order."""
        if len(names.elts) != 2:
            return _placed(statement)
        place = self._place()
        self._note("order", place, 1)
        turned = ast.Tuple(names.elts[::-1], ast.Store())
        other = ast.Assign([turned], statement.value)
        return _placed(ast.If(self._asked(place, 1), [other], [statement]))

    def _moved(self, old: Sequence[ast.stmt], body: list[ast.stmt]) -> list[ast.stmt]:
        """Let lines that set a name anew be left out, or come after the next one."""
        new: list[ast.stmt] = []
        known = set(self.names[: len(self.names)])
        seen: set[str] = set()
        for i, statement in enumerate(old):
            sets = {n.id for n in ast.walk(statement) if isinstance(n, ast.Name) and _is_set(n)}
            again, seen = sets & seen & known, seen | sets
            if again and not isinstance(statement, ast.Return):
                self._line, left_out = i, self._place()
                self._note("line left out", left_out, 1)
                test = self._asked(left_out, 1)
                body[i] = _placed(ast.If(test, [ast.Pass()], [body[i]]))
            if again and i and not isinstance(statement, ast.Return):
                early = self._place()
                self._note("line too early", early, 1)
                both, turned = [new[-1], body[i]], [body[i], new[-1]]
                new[-1] = _placed(ast.If(self._asked(early, 1), turned, both))
            else:
                new.append(body[i])
        return new

    def _switched(self, node: Any, parent: ast.AST | None = None) -> Any:
        """Return an expression that takes one of its forms."""
        if not isinstance(node, ast.AST):
            return node
        new: Any = copy.copy(node)
        for name, value in ast.iter_fields(node):
            if isinstance(value, list):
                setattr(new, name, [self._switched(x, node) for x in value])
            elif isinstance(value, ast.AST) and name not in ("ctx", "func", "op", "slice"):
                setattr(new, name, self._switched(value, node))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            new.func = copy.copy(node.func)
            new.func.value = self._switched(node.func.value, node)
        if not isinstance(node, ast.expr) or isinstance(node, ast.Starred):
            return new
        if not isinstance(getattr(node, "ctx", ast.Load()), ast.Load):
            return new
        shape = _shape(node)
        if isinstance(node, ast.Constant) and parent is not None:
            shape += f" in {_shape(parent)}"
        if isinstance(node, ast.BinOp):
            new = self._operation(node, new, shape)
        place = self._place()
        for form, (kind, other) in enumerate(_forms(node, parent, self.names), 1):
            self._note(kind, place, form, shape, _shape(other))
            new = _placed(ast.IfExp(self._asked(place, form), other, new))
        return new

    def _operation(self, node: ast.BinOp, new: ast.BinOp, shape: str) -> ast.expr:
        """Return an operation on what its operands give, which may be another one."""
        if type(node.op) not in _APPLIED:
            return new
        as_it_is, others = _APPLIED[type(node.op)]
        if isinstance(node.op, ast.Pow):
            given = getattr(node.right, "value", None)
            others += tuple(("power", _power(n)) for n in (0.5, 2, 3, 4) if n != given)
        place = self._place()
        self._applied[place] = [as_it_is, *(function for _, function in others)]
        for form, (kind, _) in enumerate(others, 1):
            self._note(kind, place, form, shape, str(form))
        arguments = [ast.Constant(place), new.left, new.right]
        return _placed(ast.Call(ast.Name("_apply_", ast.Load()), arguments, []))

    def _note(self, kind: str, place: int, form: int, before: str = "", after: str = "") -> None:
        self.slips.append(Slip(kind, (self._line,), ((place, form),)))
        if before and after:
            alike = self._alike.setdefault((kind, before, after), [])
            alike.append((self._line, place, form))

    def _everywhere(self) -> None:
        """Let the same slip be made wherever it can be."""
        for (kind, *_), members in self._alike.items():
            places = {place: form for _, place, form in members}
            if len(places) > 1:
                lines = tuple(dict.fromkeys(line for line, *_ in members))
                self.slips.append(Slip(kind, lines, tuple(places.items()), True))


def _placed(node: _Node) -> _Node:
    """Give new nodes a line, as the compiler asks; old ones have theirs."""
    if "lineno" in node._attributes:
        if hasattr(node, "lineno"):
            return node
        place = {"lineno": 1, "end_lineno": 1, "col_offset": 0, "end_col_offset": 0}
        for name, value in place.items():
            setattr(node, name, value)
    for child in ast.iter_child_nodes(node):
        _placed(child)
    return node


def _is_set(node: ast.Name) -> bool:
    return isinstance(node.ctx, ast.Store)


def _names(function: ast.FunctionDef) -> list[str]:
    names = [argument.arg for argument in function.args.args]
    for node in ast.walk(function):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.append(node.id)
    return list(dict.fromkeys(names))


def _shape(node: ast.AST) -> str:
    """Write a short expression without its names, to know the same slip elsewhere."""
    if isinstance(node, ast.Name):
        return node.id
    nodes = list(ast.walk(node))
    if len(nodes) > _SHORT:
        return ""
    text = ast.unparse(node)
    for name in {n.id for n in nodes if isinstance(n, ast.Name)} - {"np"}:
        text = text.replace(name, "_")
    return re.sub(r"\d(?=[],])", "_", text)  # and whatever the index


def _forms(node: ast.expr, parent: ast.AST | None, names: Sequence[str]) -> Iterator[Form]:
    """Yield what one place of the steps may be by a slip."""
    match node:
        case ast.BinOp():
            yield from _of_brackets(node)
        case ast.UnaryOp(op=ast.USub()):
            yield "sign", node.operand
        case ast.Call():
            yield from _of_call(node)
        case ast.Attribute(attr="T" | "mT"):
            yield "transposition", node.value
        case ast.Subscript():
            yield from _of_index(node)
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            if isinstance(parent, ast.BinOp) and not isinstance(parent.op, ast.Pow):
                for other in {2 * value, value / 2, value + 1, value - 1, 1} - {value}:
                    yield "factor", ast.Constant(other)
        case ast.List() | ast.Tuple():
            for i, j in combinations(range(len(node.elts)), 2):
                if len(node.elts) <= 4 and ast.dump(node.elts[i]) != ast.dump(node.elts[j]):
                    elements = list(node.elts)
                    elements[i], elements[j] = elements[j], elements[i]
                    yield "order", type(node)(elements, ast.Load())
        case ast.Name():
            if node.id in names:
                for name in names:
                    if _look_alike(name, node.id):
                        yield "name", ast.Name(name, ast.Load())


def _look_alike(a: str, b: str) -> bool:
    """Return whether one name is easily written for another: x for y, u0 for v0, B12 for B13."""
    return len(a) == len(b) and sum(x != y for x, y in zip(a, b, strict=True)) == 1


def _left(a: Any, _: Any) -> Any:
    return a


def _right(_: Any, b: Any) -> Any:
    return b


def _power(exponent: float) -> Applied:
    return lambda a, _: np.asarray(a) ** exponent


# What each operation is, and what may stand in its place.
_APPLIED: dict[type[ast.operator], tuple[Applied, tuple[tuple[str, Applied], ...]]] = {
    ast.Add: (operator.add, (
        ("sign", operator.sub), ("left out", _left), ("left out", _right),
        ("sign", lambda a, b: b - a),
    )),
    ast.Sub: (operator.sub, (
        ("sign", operator.add), ("left out", _left), ("left out", lambda _, b: -b),
        ("order", lambda a, b: b - a),
    )),
    ast.Mult: (operator.mul, (
        ("left out", _left), ("left out", _right), ("upside down", operator.truediv),
        ("sign", lambda a, b: -(a * b)),
    )),
    ast.Div: (operator.truediv, (
        ("left out", _left), ("upside down", operator.mul),
        ("upside down", lambda a, b: b / a), ("sign", lambda a, b: -(a / b)),
    )),
    ast.BitAnd: (operator.and_, (("left out", _left), ("left out", _right))),
    ast.MatMult: (operator.matmul, (
        ("order", lambda a, b: b @ a), ("* for @", operator.mul),
        ("left out", _left), ("left out", _right),
        ("transposition", lambda a, b: np.swapaxes(a, -1, -2) @ b),
        ("transposition", lambda a, b: a @ np.swapaxes(b, -1, -2)),
    )),
    ast.Pow: (operator.pow, (("left out", _left),)),
    ast.FloorDiv: (operator.floordiv, (("upside down", operator.truediv),)),
    ast.Mod: (operator.mod, (("left out", _left),)),
}  # fmt: skip


def _of_brackets(node: ast.BinOp) -> Iterator[Form]:
    """Yield a ∘ (b ∘ c) for (a ∘ b) ∘ c, and the other way round."""
    left, right, op = node.left, node.right, node.op
    if isinstance(left, ast.BinOp) and _differ(left.op, op):
        inner = ast.BinOp(left.right, op, right)
        yield "brackets", ast.BinOp(left.left, left.op, inner)
    if isinstance(right, ast.BinOp) and _differ(op, right.op):
        outer = ast.BinOp(left, op, right.left)
        yield "brackets", ast.BinOp(outer, right.op, right.right)


def _differ(first: ast.operator, second: ast.operator) -> bool:
    """Return whether brackets matter between two operations, as (first, second)."""
    usual = (ast.Add, ast.Sub, ast.Mult, ast.Div)
    if not (isinstance(first, usual) and isinstance(second, usual)):
        return False
    return not (type(first) is type(second) and isinstance(first, ast.Add | ast.Mult))


_SISTERS = {
    "sum": ("mean",), "mean": ("sum", "median"), "floor": ("rint",), "rint": ("floor",),
    "sin": ("cos",), "cos": ("sin",), "tan": ("sin",), "arctan": ("arcsin",), "max": ("min",),
    "min": ("max",), "norm": ("max",), "argmin": ("argmax",), "argmax": ("argmin",),
    "hstack": ("vstack",), "vstack": ("hstack",), "var": ("std",), "std": ("var",),
}  # fmt: skip


def _of_call(node: ast.Call) -> Iterator[Form]:
    name = getattr(node.func, "attr", "")
    if isinstance(node.func, ast.Attribute):
        for other in _SISTERS.get(name, ()):
            function = ast.Attribute(node.func.value, other, ast.Load())
            yield "function", ast.Call(function, node.args, node.keywords)
    if len(node.args) == 1 and name not in ("array", "asarray"):
        yield "left out", node.args[0]
    if len(node.args) == 2 and name not in ("reshape", "full", "zeros", "column_stack"):
        yield "order", ast.Call(node.func, node.args[::-1], node.keywords)
    for i, keyword in enumerate(node.keywords):
        match keyword:
            case ast.keyword(arg="axis", value=ast.Constant(value=int() as axis)):
                for value in {None, 0, 1} - {axis, axis % 2}:
                    keywords = list(node.keywords)
                    keywords[i] = ast.keyword("axis", ast.Constant(value))
                    yield "axis", ast.Call(node.func, node.args, keywords)


def _of_index(node: ast.Subscript) -> Iterator[Form]:
    index = node.slice
    if isinstance(index, ast.Tuple) and len({*map(ast.dump, index.elts)}) == 2 == len(index.elts):
        turned = ast.Tuple(index.elts[::-1], ast.Load())
        yield "index", ast.Subscript(node.value, turned, ast.Load())
    parts = list(index.elts) if isinstance(index, ast.Tuple) else [index]
    for i, part in enumerate(parts):
        for other in _of_number(part):
            new = [*parts[:i], other, *parts[i + 1 :]]
            made = ast.Tuple(new, ast.Load()) if isinstance(index, ast.Tuple) else new[0]
            yield "index", ast.Subscript(node.value, made, ast.Load())


def _of_number(part: ast.expr) -> Iterator[ast.expr]:
    match part:
        case ast.Constant(value=int() as number):
            for other in {0, 1, 2} - {number}:
                yield ast.Constant(other)
        case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int())):
            yield ast.Constant(0)
        case ast.Slice(lower=lower, upper=upper, step=step):
            for bound in (lower, upper):
                for other in _of_number(bound) if bound is not None else ():
                    ends = (other, upper) if bound is lower else (lower, other)
                    yield ast.Slice(ends[0], ends[1], step)


def _example(x: float) -> float:
    y = x - 1  # one less
    return y + 2 * y - y
