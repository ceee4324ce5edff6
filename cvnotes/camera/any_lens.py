"""What all lenses have in common: the one face by which the rest of the package knows them.

A lens stands between the rays that reach the camera and the plane of its picture. It is known by
where it shows a point (`AnyLens.of_rays`), which ray it shows somewhere (`AnyLens.rays`), how the
former changes (`AnyLens.derivatives`), and by its coefficients. Cameras, pictures, calibrations and
files ask for nothing else, so a class is all that a new lens takes.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import Field, fields
from typing import Any, ClassVar, Self

import numpy as np

from cvnotes.base import Array, CvnotesError, Points, guarded

# What `lens=` may name: the class, and which of its coefficients are then estimated.
LENSES: "dict[str, tuple[type[AnyLens], tuple[str, ...]]]" = {}
# What files name.
MODELS: "dict[str, type[AnyLens]]" = {}

# What comes into these methods of a lens has been looked at before their body sees it.
_GUARDS = {"of_rays": 3, "rays": 2, "distort": 2, "undistort": 2}


class AnyLens(ABC):
    """A lens: a frozen dataclass whose fields are its coefficients, each of them with a default.

    A field that is a tuple counts its numbers: those of ``k`` are k1, k2, … A class is known to
    `calibrate` and to files as soon as it is defined. It has to say `model` and `choices`, and to
    have the methods `of_rays`, `rays` and `derivatives` and the property `max_angle`, or to be a
    `PlaneLens`; whatever else is here may stay as it is.

    Attributes
    ----------
    model : str
        How our files call it.
    choices : mapping
        What `lens=` of `calibrate` may name, and which coefficients are then estimated, in the
        order of the fields.
    wide : bool
        Whether it may show rays at 90° from the axis and beyond, which the plane z = 1 cannot.
    linear_terms : int
        How many of k1, k2, … begin as those of the notes' polynomial, which is fitted linearly.
    cancelling : tuple of str
        Coefficients that can nearly cancel each other: the smallest error is then a valley, into
        which the refinement is led by holding them near zero first.
    ros_name : str
        How ROS calls it, if it does.
    seldom : tuple of str
        Fields that our files leave out where they have their default.
    """

    model: ClassVar[str]
    choices: ClassVar[Mapping[str, tuple[str, ...]]]
    wide: ClassVar[bool] = False
    linear_terms: ClassVar[int] = 0
    cancelling: ClassVar[tuple[str, ...]] = ()
    ros_name: ClassVar[str] = ""
    seldom: ClassVar[tuple[str, ...]] = ()

    # Radial and tangential coefficients and the distortion centre, of a lens that has none.
    k: tuple[float, ...] = ()
    p: tuple[float, float] = (0.0, 0.0)
    centre: tuple[float, float] = (0.0, 0.0)

    def __init_subclass__(cls, **kwargs: Any) -> None:
        """Make the class known, and guard what comes into its methods."""
        super().__init_subclass__(**kwargs)
        for name, dimensions in _GUARDS.items():
            formula = vars(cls).get(name)
            if formula is not None and not hasattr(formula, "inside"):
                argument = formula.__code__.co_varnames[1]
                guards: Any = {argument: Points(dimensions)}
                setattr(cls, name, guarded(**guards)(formula))
        if "choices" not in vars(cls):
            return
        taken = [LENSES[name][0] for name in cls.choices if name in LENSES]
        taken += [MODELS[cls.model]] if cls.model in MODELS else []
        for other in taken:
            if (other.__module__, other.__qualname__) != (cls.__module__, cls.__qualname__):
                raise CvnotesError(
                    f"{cls.__name__}: {other.__name__} has the same name in `lens=` or in files"
                )
        MODELS[cls.model] = cls
        LENSES.update({name: (cls, wanted) for name, wanted in cls.choices.items()})

    # --- what a lens has to say

    @property
    @abstractmethod
    def max_angle(self) -> float:
        """Largest angle from the axis, in radians, up to which the lens maps one to one."""

    @guarded(M=Points(3))
    @abstractmethod
    def of_rays(self, M: Array) -> Array:
        """Where the lens shows points M (..., 3) of the CRF, (..., 2); NaN where it does not."""

    @guarded(xy_lens=Points(2))
    @abstractmethod
    def rays(self, xy_lens: Array) -> Array:
        """Directions (..., 3) of length 1 that points (..., 2) of its picture show, or NaN."""

    @abstractmethod
    def derivatives(
        self, M: Array, names: tuple[str, ...] | None = None, out: tuple[Array, Array] | None = None
    ) -> tuple[Array, Array, Array]:
        """Show M (3, ...) through the lens, with derivatives; unguarded, for whoever refines.

        Parameters
        ----------
        M : ndarray, shape (3, ...)
            Points of the CRF, coordinates first.
        names : tuple of str, optional
            The coefficients by which to differentiate, one of the `choices`; by default all of
            `parameters`. A lens with one choice need not look at it.
        out : (ndarray, ndarray), optional
            Arrays that `by_M` and `by_coefficients` are written into; by default those of `room`.

        Returns
        -------
        xy_lens : ndarray, shape (2, ...)
        by_M : ndarray, shape (2, 3, ...)
        by_coefficients : ndarray, shape (len(names), 2, ...)
        """

    # --- what follows from that

    def room(self, M: Array, names: tuple[str, ...] | None) -> tuple[Array, Array]:
        """Return empty arrays that `derivatives` may be written into."""
        count = len(self.parameters if names is None else names)
        return np.empty((2, 3, *M.shape[1:])), np.empty((count, 2, *M.shape[1:]))

    @property
    def parameters(self) -> dict[str, float]:
        """The coefficients that a calibration may estimate, by name."""
        wanted = {name for names in self.choices.values() for name in names}
        return {name: x for name, x in self._numbers().items() if name in wanted}

    def with_parameters(self, values: Mapping[str, float]) -> Self:
        """Return the same lens with other values of the coefficients that are named."""
        known = self.parameters
        for name in values:
            if name not in known:
                raise CvnotesError(
                    f"{name!r} is no coefficient of a {type(self).__name__}: those are "
                    f"{', '.join(known)}"
                )
        value = self._numbers() | dict(values)
        return type(self)(
            **{f.name: _taken(f, getattr(self, f.name), value) for f in _fields(self)}
        )

    @classmethod
    def unchecked(cls, values: Mapping[str, float]) -> Self:
        """Make the lens of such coefficients, the others being zero, whatever they are.

        For the refinement, which has hundreds of lenses made, and may come by any numbers.
        """
        lens = object.__new__(cls)
        for f in _fields(cls):
            object.__setattr__(lens, f.name, _taken(f, f.default, values))
        return lens

    def _numbers(self) -> dict[str, float]:
        """All numbers in the fields, by name."""
        numbers: dict[str, float] = {}
        for f in _fields(self):
            x = getattr(self, f.name)
            several = isinstance(x, tuple)
            numbers |= {f"{f.name}{i}": y for i, y in enumerate(x, 1)} if several else {f.name: x}
        return numbers

    @classmethod
    def usual(cls) -> tuple[Self, ...]:
        """Lenses of this kind by which corners are straightened to find a start.

        With each the cameras of several fields of view are tried, where `calibrate` has no start
        on the plane z = 1 (wide lenses), or not a good one.
        """
        return (cls(),) if cls.wide else ()

    @property
    def is_ideal(self) -> bool:
        """Return whether this lens moves nothing."""
        return False

    @property
    def max_radius(self) -> float:
        """Largest ideal radius on the plane z = 1 that the lens shows; inf from 90° on."""
        return float(np.tan(self.max_angle)) if self.max_angle < np.pi / 2 else np.inf

    def reaches(self, r: float) -> bool:
        """Return whether the lens shows something at distance r from the middle."""
        return bool(np.isfinite(self.rays([r, 0.0])).all())

    @guarded(xy=Points(2))
    def distort(self, xy: Array) -> Array:
        """Move ideal image points (..., 2) to where the lens shows them; NaN beyond its end.

        Examples
        --------
        >>> from cvnotes.camera import FisheyeLens
        >>> FisheyeLens(k=(0.1,)).distort([0.0, 0.0])
        array([0., 0.])
        """
        M = np.concatenate([xy, np.ones_like(xy[..., :1])], axis=-1)
        return self.of_rays.inside(self, M)

    @guarded(xy_lens=Points(2))
    def undistort(self, xy_lens: Array) -> Array:
        """Move observed points (..., 2) to the plane z = 1; NaN from 90° on, and beyond the end.

        Examples
        --------
        >>> from cvnotes.camera import FisheyeLens
        >>> FisheyeLens().undistort([np.pi / 4, 0.0]).round(12)
        array([1., 0.])
        """
        d = self.rays.inside(self, xy_lens)
        z = d[..., 2:]
        return np.where(z > 1e-12, d[..., :2] / np.where(z > 0, z, 1), np.nan)

    @guarded(xy=Points(2))
    @np.errstate(all="ignore")  # far from all lenses
    def jacobian(self, xy: Array) -> Array:
        """Differentiate the observed point by the ideal one: (..., 2, 2).

        Examples
        --------
        >>> from cvnotes.camera import FisheyeLens, Lens
        >>> FisheyeLens().jacobian([1.0, 0.0]).round(6) + 0.0
        array([[0.5     , 0.      ],
               [0.      , 0.785398]])
        >>> Lens(k=(-4 / 3,)).jacobian([0.5, 0.0])[0, 0].round(12) + 0.0
        np.float64(0.0)
        """
        M = np.stack([xy[..., 0], xy[..., 1], np.ones_like(xy[..., 0])])
        return np.moveaxis(self.derivatives(M)[1][:, :2], (0, 1), (-2, -1))

    def opencv_coefficients(self) -> Array:
        """Return the coefficients in OpenCV's order.

        Raises
        ------
        CvnotesError
            OpenCV has no such lens.
        """
        raise CvnotesError(f"OpenCV and ROS have no {self.model} lens; keep it as JSON")


class PlaneLens(AnyLens):
    """A lens that moves the points of the plane z = 1, so that it sees what is in front of it.

    It has to have `distort`, `undistort`, `on_plane` and `max_radius`; the rest follows.
    """

    @property
    @abstractmethod
    def max_radius(self) -> float:
        """Largest ideal radius up to which the lens maps one to one (inf if there is no end)."""

    @abstractmethod
    def on_plane(
        self, xy: Array, names: tuple[str, ...], by_coefficients: Array
    ) -> tuple[Array, tuple[Array, Array]]:
        """Distort xy (2, ...), with derivatives; unguarded.

        Parameters
        ----------
        xy : ndarray, shape (2, ...)
        names : tuple of str
            As `derivatives` takes them, and never None.
        by_coefficients : ndarray, shape (len(names), 2, ...)
            Takes the derivatives by the coefficients.

        Returns
        -------
        xy_lens : ndarray, shape (2, ...)
        by_xy : (ndarray, ndarray), each of shape (2, ...)
            By x and by y.
        """

    @property
    def max_angle(self) -> float:
        """Largest angle from the axis, in radians, up to which the lens maps one to one."""
        return float(np.arctan(self.max_radius))

    @guarded(M=Points(3))
    @np.errstate(over="ignore", invalid="ignore")  # of points too far away to have an image
    def of_rays(self, M: Array) -> Array:
        """Where the lens shows points M (..., 3) of the CRF; NaN if they are not in front of it.

        Examples
        --------
        >>> from cvnotes.camera import Lens
        >>> Lens().of_rays([[1.0, 2.0, 2.0], [1.0, 2.0, -2.0]])
        array([[0.5, 1. ],
               [nan, nan]])
        """
        z = M[..., 2:]
        xy = np.divide(M[..., :2], z, out=np.full_like(M[..., :2], np.nan), where=z > 0)
        return self.distort.inside(self, xy)

    @guarded(xy_lens=Points(2))
    def rays(self, xy_lens: Array) -> Array:
        """Directions (..., 3) of length 1 that observed points (..., 2) show; NaN beyond the end.

        Examples
        --------
        >>> from cvnotes.camera import Lens
        >>> Lens().rays([0.75, 0.0])
        array([0.6, 0. , 0.8])
        """
        xy = self.undistort.inside(self, xy_lens)
        d = np.concatenate([xy, np.ones_like(xy[..., :1])], axis=-1)
        return np.asarray(d / np.linalg.norm(d, axis=-1, keepdims=True))

    def derivatives(
        self, M: Array, names: tuple[str, ...] | None = None, out: tuple[Array, Array] | None = None
    ) -> tuple[Array, Array, Array]:
        """Show M (3, ...) through the lens, with derivatives; see `AnyLens.derivatives`.

        Notes
        -----
        d(x, y)/dM = [1 0 −x; 0 1 −y]/z.
        """
        names = tuple(self.parameters) if names is None else names
        by_M, by_coefficients = self.room(M, names) if out is None else out
        over_z = 1 / M[2]
        x, y = xy = M[:2] * over_z
        xy_lens, (by_x, by_y) = self.on_plane(xy, names, by_coefficients)
        by_X = np.multiply(by_x, over_z, out=by_M[:, 0])
        by_Y = np.multiply(by_y, over_z, out=by_M[:, 1])
        np.negative(x * by_X + y * by_Y, out=by_M[:, 2])
        return xy_lens, by_M, by_coefficients


def _fields(lens: Any) -> tuple[Field[Any], ...]:
    return fields(lens)


def _taken(f: Field[Any], before: Any, values: Mapping[str, float]) -> Any:
    """Return what a field becomes with such values, given by name; the others stay."""
    if isinstance(before, tuple):
        return tuple([values.get(f"{f.name}{i}", x) for i, x in enumerate(before, 1)])
    return values.get(f.name, before)
