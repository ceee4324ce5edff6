"""Guards before the body, so that the body of a function is its formula."""

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar, cast, overload

from cvnotes.base.guards import matrix, paired, points

P = ParamSpec("P")
R_co = TypeVar("R_co", covariant=True)
Self_ = TypeVar("Self_")
Guard = Callable[[Any, str], Any]


class Guarded(Protocol[P, R_co]):
    """A function that guards its arguments; `inside` is its body, for arguments that are good."""

    @property
    def inside(self) -> Callable[P, R_co]:
        """The body alone: for use inside the package, by who has guarded already."""

    @overload
    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R_co: ...
    @overload  # what a guard turns into an array may be anything array_like
    def __call__(self, *args: Any, **kwargs: Any) -> R_co: ...

    @overload
    def __get__(self, instance: None, owner: type) -> "Guarded[P, R_co]": ...
    @overload
    def __get__(
        self: "Guarded[Concatenate[Self_, ...], R_co]", instance: object, owner: type
    ) -> "Guarded[..., R_co]": ...  # whose `inside` still wants the instance first


def guarded(
    *,
    pair: tuple[str, str] | None = None,
    at_least: int = 1,
    also: Callable[..., object] | None = None,
    **guards: Guard,
) -> Callable[[Callable[P, R_co]], Guarded[P, R_co]]:
    """Guard arguments by name before the body sees them; it then holds nothing but the formula.

    Parameters
    ----------
    pair : (str, str), optional
        Two arguments whose points belong together row by row, at least `at_least` of them.
    also : callable, optional
        Called with the same arguments, guarded; raises if they do not fit together.
    **guards
        For an argument what guards it: (x, name) → the good value. What is left out, so that it
        has its default, is good.

    Examples
    --------
    >>> @guarded(x=Points(2))
    ... def twice(x):
    ...     return 2 * x
    >>> twice([1, 2])
    array([2., 4.])
    >>> twice([1, 2, 3])
    Traceback (most recent call last):
    cvnotes.base.errors.ShapeError: x: expected shape (..., 2), got (3,)
    >>> twice.inside(7)
    14
    """

    def decorate(formula: Callable[P, R_co]) -> Guarded[P, R_co]:
        parameters = inspect.signature(formula).parameters
        known = parameters.keys()
        needed = {name for name, x in parameters.items() if x.default is x.empty}

        @wraps(formula)
        def function(*args: Any, **kwargs: Any) -> Any:
            given = dict(zip(parameters, args, strict=False)) | kwargs
            if len(given) < len(args) + len(kwargs) or not needed <= given.keys() <= known:
                return cast(Any, formula)(*args, **kwargs)  # Python says what is wrong
            for name, guard in guards.items():
                if name in given:
                    given[name] = guard(given[name], name)
            if pair:
                paired(given[pair[0]], given[pair[1]], pair, at_least=at_least)
            if also:
                also(**given)
            return cast(Any, formula)(**given)

        function.inside = formula  # type: ignore[attr-defined]
        return cast(Guarded[P, R_co], function)

    return decorate


def Points(*dims: int) -> Guard:
    """Guard points (..., d) with d one of `dims`; see `points`.

    Examples
    --------
    >>> Points(2, 3)([1, 2], "m")
    array([1., 2.])
    """
    return lambda x, name: points(x, name, *dims)


def Matrix(*shape: int) -> Guard:
    """Guard matrices of one shape; see `matrix`.

    Examples
    --------
    >>> Matrix(2, 2)([[1, 0], [0, 1]], "H").shape
    (2, 2)
    """
    return lambda x, name: matrix(x, name, *shape)
