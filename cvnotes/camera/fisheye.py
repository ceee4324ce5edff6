"""The fisheye: a lens whose picture grows with the angle of a ray, not with its tangent.

The plane z = 1 of the notes (2b.3) ends at 90° from the axis: a ray at 90° meets it nowhere. A
fisheye sees such rays, and those behind. Its picture is laid out by the angle θ itself.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from cvnotes.base import Array, CvnotesError, Points, ShapeError, guarded, numbers
from cvnotes.camera.any_lens import AnyLens
from cvnotes.camera.lens import horner
from cvnotes.camera.rational import sign_changes

_STEPS = 50  # of Newton's method; near the end a dozen are needed


@dataclass(frozen=True)
class FisheyeLens(AnyLens):
    """An equidistant lens, corrected by a polynomial of the angle.

    Parameters
    ----------
    k : sequence of up to 4 floats
        k1 … k4 of θ' = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸), with θ the angle between the ray
        and the axis, in radians.

    Notes
    -----
    A ray at angle θ is shown at the distance θ' from the centre, in its own direction. Rays beyond
    90° have no point on the plane z = 1: `of_rays` and `rays` reach them, ``distort``
    and ``undistort`` do not.

    References
    ----------
    .. [1] J. Kannala and S. Brandt, A generic camera model and calibration method for conventional,
       wide-angle, and fish-eye lenses, PAMI 28 (2006) 1335-1340.

    Examples
    --------
    >>> FisheyeLens().distort([1.0, 0.0])[0] * 4 / np.pi
    np.float64(1.0)
    """

    model: ClassVar[str] = "equidistant"
    choices: ClassVar[Mapping[str, tuple[str, ...]]] = {"fisheye": ("k1", "k2", "k3", "k4")}
    wide: ClassVar[bool] = True
    ros_name: ClassVar[str] = "equidistant"

    k: tuple[float, ...] = (0.0,) * 4

    def __post_init__(self) -> None:
        given = numbers(self.k, "k", largest=np.inf)
        if given.ndim != 1 or given.size > 4:
            raise ShapeError(f"k: expected up to 4 numbers, got shape {given.shape}")
        if (np.abs(given) > 1e50).any():
            raise CvnotesError(f"k = {given.tolist()}: no lens has such coefficients")
        object.__setattr__(self, "k", (*given.tolist(), *[0.0] * (4 - given.size)))

    @cached_property
    def max_angle(self) -> float:
        """Largest angle θ, in radians, up to which the lens maps one to one; at most π.

        Examples
        --------
        >>> FisheyeLens((-1 / 3,)).max_angle
        1.0
        """
        slopes = np.zeros(9)
        slopes[::2] = [1.0, *(k * (2 * i + 1) for i, k in enumerate(self.k, 1))]
        ends = sign_changes(slopes[::-1], np.pi)
        return min(ends, default=np.pi)

    @guarded(M=Points(3))
    @np.errstate(all="ignore")  # of points too far away
    def of_rays(self, M: Array) -> Array:
        """Where the lens shows points M (..., 3) of the CRF, behind the plane z = 0 too.

        Examples
        --------
        >>> FisheyeLens().of_rays([-1.0, 0.0, 0.0])[0] * 2 / np.pi
        np.float64(-1.0)
        """
        rho = np.hypot(M[..., 0], M[..., 1])
        theta = np.arctan2(rho, M[..., 2])
        shown = self._shown(theta)[0]
        ratio = np.where(rho > 0, shown / np.where(rho > 0, rho, 1), 0.0)
        inside = (theta <= self.max_angle) & ((rho > 0) | (M[..., 2] > 0))
        return np.where(inside[..., None], ratio[..., None] * M[..., :2], np.nan)

    @guarded(xy_lens=Points(2))
    @np.errstate(all="ignore")
    def rays(self, xy_lens: Array) -> Array:
        """Directions (..., 3) of length 1 that observed points (..., 2) show; NaN beyond the end.

        Notes
        -----
        Newton's method on θ, from a table.

        Examples
        --------
        >>> FisheyeLens().rays([0.0, np.pi / 2]).round(12) + 0.0
        array([0., 1., 0.])
        """
        shown = np.hypot(xy_lens[..., 0], xy_lens[..., 1])
        knots = np.linspace(0, self.max_angle, 1025)
        theta = np.interp(shown, self._shown(knots)[0], knots)
        for _ in range(_STEPS):
            value, slope = self._shown(theta)
            step = np.where(slope > 0, (value - shown) / np.where(slope > 0, slope, 1), 0.0)
            theta = np.clip(theta - step, 0, self.max_angle)
            if not np.abs(step).max(initial=0.0) > 1e-15:
                break
        reached = np.abs(self._shown(theta)[0] - shown) <= 1e-12 * (1 + shown)
        unit = np.where(
            shown[..., None] > 0, xy_lens / np.where(shown > 0, shown, 1)[..., None], 0.0
        )
        d = np.concatenate([np.sin(theta)[..., None] * unit, np.cos(theta)[..., None]], axis=-1)
        return np.where(reached[..., None], d, np.nan)

    def derivatives(
        self, M: Array, names: tuple[str, ...] | None = None, out: tuple[Array, Array] | None = None
    ) -> tuple[Array, Array, Array]:
        """Show M (3, ...) through the lens, with derivatives; see `AnyLens.derivatives`.

        Notes
        -----
        With ρ = √(X² + Y²) and θ = atan2(ρ, Z): ∂θ/∂(X, Y) = Z (X, Y)/(ρ ‖M‖²), ∂θ/∂Z = −ρ/‖M‖².
        """
        D, C = self.room(M, names) if out is None else out  # always by all four
        X, Y, Z = M
        rho2 = X * X + Y * Y
        rho = np.sqrt(rho2)
        norm2 = rho2 + Z * Z
        theta = np.arctan2(rho, Z)
        shown, slope = self._shown(theta)
        on_axis = rho2 <= 1e-24 * norm2
        safe = np.where(on_axis, 1.0, rho)
        # θ'/ρ, whose limit on the axis is 1/Z; (slope Z/‖M‖² − θ'/ρ)/ρ² there is left out
        ratio = np.where(on_axis, 1 / np.where(Z == 0, 1, Z), shown / safe)
        bend = np.where(on_axis, 0.0, (slope * Z / norm2 - ratio) / safe**2)
        seen = ratio * M[:2]
        D[0, 0], D[1, 1] = ratio + bend * X * X, ratio + bend * Y * Y
        D[0, 1] = D[1, 0] = bend * X * Y
        D[:, 2] = -slope / norm2 * M[:2]
        unit = np.where(on_axis, 0.0, M[:2] / safe)
        C[...] = np.stack([theta ** (2 * i + 1) * unit for i in range(1, 5)])
        return seen, D, C

    def opencv_coefficients(self) -> Array:
        """Return k1 … k4, for the functions of ``cv2.fisheye``."""
        return np.array(self.k)

    def _shown(self, theta: Array) -> tuple[Array, Array]:
        """Return θ' = θ (1 + k1 θ² + …) and its slope dθ'/dθ = 1 + 3 k1 θ² + …."""
        t = theta * theta
        slopes = [(2 * i + 1) * k_i for i, k_i in enumerate(self.k, 1)]
        return theta * horner((1.0, *self.k), t), horner((1.0, *slopes), t)
