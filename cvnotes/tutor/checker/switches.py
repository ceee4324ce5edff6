"""Functions with a switch at each place of their expressions: all that may slip in them, or did.

One program holds it all (mutants in one schema): every place asks a switch which of its forms is
meant. So a function is compiled once, and a slip is a setting of the switches.
"""

import ast
import copy
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from cvnotes.tutor.checker.parsing import names_set

# What slips, the likely ones first: what is said of a slip, {0} is where; and what puts code right.
KINDS = {
    "stopped": ("you stopped on the way: that is {0}.", "an earlier result"),
    "comparison": ("a comparison is wrong in {0}.", "another comparison"),
    "sign": ("a sign is wrong in {0}.", "another sign"),
    "order": ("two things are in the wrong order in {0}.", "another order"),
    "transposition": (
        "something is transposed that should not be, or not where it should, in {0}.",
        "a transposition more or less",
    ),
    "power": ("a power is wrong in {0}.", "another power"),
    "factor": ("a number is wrong in {0}.", "another number"),
    "left out": ("something is left out in {0}.", "something left out"),
    "upside down": (
        "a fraction is upside down, or a product divided, in {0}.",
        "a product divided, or a fraction upside down,",
    ),
    "index": ("an index is wrong in {0}.", "another index"),
    "axis": ("an axis is wrong in {0}.", "another axis"),
    "brackets": ("brackets are wrong in {0}.", "other brackets"),
    "* for @": (
        "a product of numbers stands for one of matrices, or the other way round, in {0}.",
        "the other kind of product",
    ),
    "function": ("another function belongs in {0}.", "another function"),
    "name": ("one name stands for another in {0}.", "another name"),
    "from 1": ("something is to be taken from 1 in {0}.", "1 less what is there,"),
    "line left out": ("a step is left out: {0}.", "nothing"),
    "line too early": ("a step comes too early: {0}.", "the next two lines exchanged"),
}
_KINDS = tuple(KINDS)
# Nodes of an expression that may stand elsewhere in the same form.
_SHORT = 16

# A form is another expression, or another function of what two operands give.
Form = tuple[str, ast.expr]
Applied = Callable[[Any, Any], Any]


class Slip(NamedTuple):
    """One slip: its kind, the lines it is in, and the form that each place takes."""

    kind: str
    lines: tuple[int, ...]
    setting: tuple[tuple[int, int], ...]
    everywhere: bool = False


class Switches:
    """Puts a switch at each place of functions.

    Parameters
    ----------
    own : bool
        Whether the functions are a student's own. What is wrong there may be put right by more than
        slips: by a number, a comparison, by an expression that is turned or inverted.

    Attributes
    ----------
    places : list of int
        The switches; all are 0 as long as nothing slips.
    """

    def __init__(self, *, own: bool = False) -> None:
        self.places: list[int] = []
        self._own = own
        self._found: list[Slip] = []
        self._turned: list[Slip] = []
        self._nodes: list[tuple[ast.AST, ast.AST | None, Sequence[ast.AST | str]]] = []
        self._operations: dict[int, list[Applied]] = {}
        self._alike: dict[tuple[str, str, str], list[tuple[int, int, int]]] = {}

    def switched(self, function: ast.FunctionDef) -> ast.FunctionDef:
        """Return a function whose expressions take the form that the switches say."""
        self._line, self._set = 0, dict[str, int]()
        arguments = (argument.arg for argument in function.args.args)
        self._names = list(dict.fromkeys((*arguments, *names_set(function))))
        body = [self._statement(i, statement) for i, statement in enumerate(function.body)]
        made = copy.copy(function)
        made.body = self._moved(function.body, body)
        made.returns, made.decorator_list = None, []
        for argument in function.args.args:
            argument.annotation = None
        return ast.fix_missing_locations(made)

    @property
    def names(self) -> dict[str, Any]:
        """What the switched functions have to know."""
        return {"_form_": self.places, "_apply_": self._apply}

    @property
    def slips(self) -> list[Slip]:
        """All slips, the likely ones first; the same slip everywhere behind those in one place."""
        everywhere = []
        for (kind, *_), members in self._alike.items():
            places = {place: form for _, place, form in members}
            if len(places) > 1:
                lines = tuple(dict.fromkeys(line for line, *_ in members))
                everywhere.append(Slip(kind, lines, tuple(places.items()), True))
        found = self._found + everywhere
        found.sort(key=lambda slip: (_KINDS.index(slip.kind), slip.everywhere))
        return found + sorted(self._turned, key=lambda slip: _KINDS.index(slip.kind))

    @contextmanager
    def set_to(self, slip: Slip) -> Iterator[None]:
        """Let a slip be made as long as this lasts."""
        for place, form in slip.setting:
            self.places[place] = form
        try:
            yield
        finally:
            for place, _ in slip.setting:
                self.places[place] = 0

    def text(self, slip: Slip) -> tuple[str, str]:
        """Return the code in the first place of a slip, and what the slip makes of it."""
        place, form = slip.setting[0]
        node, parent, others = self._nodes[place]
        other = others[form - 1]
        if isinstance(other, str):  # of operands
            operands = {"x": node, "a": getattr(node, "left", 0), "b": getattr(node, "right", 0)}
            other = _put(ast.parse(other, mode="eval").body, operands)
        alone = isinstance(node, ast.Name | ast.Constant) and parent is not None
        whole = parent if alone and parent is not None else node
        return ast.unparse(whole), ast.unparse(_put(whole, {node: other}))

    def _apply(self, place: int, *operands: Any) -> Any:
        """Return what the form of a place makes of its operands."""
        form = self.places[place]
        if form and len(operands) == 1 and isinstance(operands[0], list | tuple):
            operands = (np.asarray(operands[0]),)
        return self._operations[place][form](*operands)

    def _place(
        self,
        node: ast.AST,
        forms: Sequence[tuple[str, ast.AST | str]],
        parent: ast.AST | None = None,
        shape: str = "",
        slips: list[Slip] | None = None,
    ) -> int:
        """Put a switch at a node, and note its slips; those of one shape may be made everywhere."""
        place = len(self.places)
        self.places.append(0)
        self._nodes.append((node, parent, [other for _, other in forms]))
        for form, (kind, other) in enumerate(forms, 1):
            slip = Slip(kind, (self._line,), ((place, form),))
            (self._found if slips is None else slips).append(slip)
            after = other if isinstance(other, str) else _shape(other)
            if shape and after:
                alike = self._alike.setdefault((kind, shape, after), [])
                alike.append((self._line, place, form))
        return place

    def _asked(self, place: int, form: int) -> ast.expr:
        switch = ast.Subscript(ast.Name("_form_", ast.Load()), ast.Constant(place), ast.Load())
        return ast.Compare(switch, [ast.Eq()], [ast.Constant(form)])

    def _statement(self, i: int, statement: ast.stmt) -> ast.stmt:
        self._line = i
        new = copy.copy(statement)
        for name, value in ast.iter_fields(statement):
            if isinstance(value, list) and value and isinstance(value[0], ast.stmt):
                setattr(new, name, [self._statement(i, inner) for inner in value])
            elif isinstance(value, ast.expr) and name != "target":
                setattr(new, name, self._switched(value))
        if isinstance(new, ast.Assign) and isinstance(new.targets[0], ast.Tuple):
            return self._exchanged(new, new.targets[0])
        if isinstance(new, ast.Assign) and isinstance(new.targets[0], ast.Name):
            self._set[new.targets[0].id] = i
        if isinstance(new, ast.Return) and new.value is not None:
            new.value = self._stopped(new.value)
        return new

    def _stopped(self, returned: ast.expr) -> ast.expr:
        """Let what one of the lines gives come back in place of the answer."""
        others = {name: ast.Name(name, ast.Load()) for name in self._set}
        place = self._place(returned, [("", other) for other in others.values()], slips=[])
        for form, (name, line) in enumerate(self._set.items(), 1):
            self._found.append(Slip("stopped", (line,), ((place, form),)))
            returned = ast.IfExp(self._asked(place, form), others[name], returned)
        return returned

    def _exchanged(self, statement: ast.Assign, names: ast.Tuple) -> ast.stmt:
        """Let two names on the left be in the other order."""
        if len(names.elts) != 2:
            return statement
        turned = ast.Tuple(names.elts[::-1], ast.Store())
        asked = self._asked(self._place(names, [("order", turned)]), 1)
        return ast.If(asked, [ast.Assign([turned], statement.value)], [statement])

    def _moved(self, old: Sequence[ast.stmt], body: list[ast.stmt]) -> list[ast.stmt]:
        """Let lines that set a name anew be left out, or come after the next one."""
        new: list[ast.stmt] = []
        known = set(self._names)
        seen: set[str] = set()
        for i, statement in enumerate(old):
            sets = {*names_set(statement)}
            again, seen = sets & seen & known, seen | sets
            self._line, line = i, body[i]
            if not again or isinstance(statement, ast.Return):
                new.append(line)
                continue
            left_out = self._asked(self._place(statement, [("line left out", ast.Pass())]), 1)
            line = ast.If(left_out, [ast.Pass()], [line])
            early = self._asked(self._place(statement, [("line too early", statement)]), 1)
            new[-1] = ast.If(early, [line, new[-1]], [new[-1], line])
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
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATIONS:
            as_it_is, others = _OPERATIONS[type(node.op)]
            if isinstance(node.op, ast.Pow):
                given = getattr(node.right, "value", None)
                others += tuple(("power", f"np.asarray(a) ** {n}") for n in _POWERS if n != given)
            place = self._place(node, others, None, shape)
            new = self._applied(place, "a, b", as_it_is, [new.left, new.right])
        forms = [*_forms(node, parent, self._names), *(_more_forms(node) if self._own else ())]
        place = self._place(node, forms, parent, shape)
        for form, (_, other) in enumerate(forms, 1):
            new = ast.IfExp(self._asked(place, form), other, new)
        if self._own and self._has_numbers(node):
            place = self._place(node, _TURNED, parent, slips=self._turned)
            new = self._applied(place, "x", "x", [new])
        return new

    def _has_numbers(self, node: ast.expr) -> bool:
        """Return whether an expression is not a number, nor the name of a function or a library."""
        if isinstance(node, ast.Name):
            return node.id in self._names
        return not isinstance(node, ast.Constant) and getattr(node, "attr", "T") in ("T", "mT")

    def _applied(self, place: int, names: str, as_it_is: str, operands: list[ast.expr]) -> ast.expr:
        """Return an operation on what its operands give, which may be another one."""
        texts = [as_it_is, *map(str, self._nodes[place][2])]
        self._operations[place] = [_function(names, text) for text in texts]
        called = ast.Name("_apply_", ast.Load())
        return ast.Call(called, [ast.Constant(place), *operands], [])


def _shape(node: ast.AST) -> str:
    """Write a short expression without its names, to know the same slip elsewhere."""
    if isinstance(node, ast.Name):
        return node.id
    nodes = list(ast.walk(node))
    if len(nodes) > _SHORT:
        return ""
    text = ast.unparse(node)
    for name in dict.fromkeys(n.id for n in nodes if isinstance(n, ast.Name) and n.id != "np"):
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


@cache
def _function(operands: str, text: str) -> Applied:
    return eval(f"lambda {operands}: {text}", {"np": np})  # type: ignore[no-any-return]


# What each operation is, and what may stand in its place.
_OPERATIONS: dict[type[ast.operator], tuple[str, tuple[tuple[str, str], ...]]] = {
    ast.Add: ("a + b", (
        ("sign", "a - b"), ("left out", "a"), ("left out", "b"), ("sign", "b - a"),
    )),
    ast.Sub: ("a - b", (
        ("sign", "a + b"), ("left out", "a"), ("left out", "-b"), ("order", "b - a"),
    )),
    ast.Mult: ("a * b", (
        ("left out", "a"), ("left out", "b"), ("upside down", "a / b"), ("sign", "-(a * b)"),
    )),
    ast.Div: ("a / b", (
        ("left out", "a"), ("upside down", "a * b"), ("upside down", "b / a"), ("sign", "-(a / b)"),
    )),
    ast.BitAnd: ("a & b", (("left out", "a"), ("left out", "b"))),
    ast.MatMult: ("a @ b", (
        ("order", "b @ a"), ("* for @", "a * b"), ("left out", "a"), ("left out", "b"),
        ("transposition", "np.swapaxes(a, -1, -2) @ b"),
        ("transposition", "a @ np.swapaxes(b, -1, -2)"),
    )),
    ast.Pow: ("a**b", (("left out", "a"),)),
    ast.FloorDiv: ("a // b", (("upside down", "a / b"),)),
    ast.Mod: ("a % b", (("left out", "a"),)),
}  # fmt: skip
_POWERS = (0.5, 2, 3, 4)
# What may put an expression of a student's right, besides.
_TURNED = (
    ("sign", "-x"), ("transposition", "x.T"), ("order", "x[::-1]"),
    ("power", "x**2"), ("power", "np.sqrt(x)"), ("factor", "2 * x"), ("factor", "x / 2"),
    ("upside down", "1 / x"), ("upside down", "np.linalg.inv(x)"), ("from 1", "1 - x"),
)  # fmt: skip
_COMPARED = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)


def _more_forms(node: ast.expr) -> Iterator[Form]:
    """Yield what besides may put right a place of a student's code."""
    match node:
        case ast.Compare(ops=[*ops]):
            for i, op in enumerate(ops):
                if isinstance(op, _COMPARED):
                    for other in _COMPARED:
                        operations = [*ops[:i], other(), *ops[i + 1 :]]
                        yield "comparison", ast.Compare(node.left, operations, node.comparators)
        case ast.BoolOp():
            other = ast.Or() if isinstance(node.op, ast.And) else ast.And()
            yield "comparison", ast.BoolOp(other, node.values)
        case ast.IfExp():
            yield "order", ast.IfExp(node.test, node.orelse, node.body)
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            for number in dict.fromkeys(
                (0, 1, value + 1, value - 1, -value, 2 * value, value / 2, value**2, value**0.5)
            ):
                if number != value:
                    yield "factor", ast.Constant(number)
        case ast.Subscript(slice=ast.Tuple(elts=[ast.Slice(None, None, None), index])):
            yield "index", ast.Subscript(node.value, index, ast.Load())
        case ast.Subscript(slice=ast.Constant() | ast.UnaryOp() | ast.Name() as index):
            last = ast.UnaryOp(ast.USub(), ast.Constant(1))
            column = ast.Tuple([ast.Slice(), index], ast.Load())
            for other in (last, column):
                yield "index", ast.Subscript(node.value, other, ast.Load())


def _put(node: Any, others: dict[Any, Any]) -> Any:
    """Return a copy of code with other nodes, for nodes or for names."""
    if not isinstance(node, ast.AST):
        return [_put(x, others) for x in node] if isinstance(node, list) else node
    if node in others:
        return others[node]
    if isinstance(node, ast.Name) and node.id in others:
        return others[node.id]
    new = copy.copy(node)
    for name, value in ast.iter_fields(node):
        setattr(new, name, _put(value, others))
    return new


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
    if any(isinstance(argument, ast.Starred) for argument in node.args):
        return
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
