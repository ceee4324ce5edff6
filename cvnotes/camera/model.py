"""The sensor, from the plane z = 1 to pixels and back, and the whole camera (notes 2b.1-2b.3)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import pi, sin, tan
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    CvnotesError,
    InputTypeError,
    Points,
    guarded,
    image_size,
    intrinsic_matrix,
    number,
    numbers,
    points,
    rigid_motion,
)
from cvnotes.camera.any_lens import AnyLens
from cvnotes.camera.lens import Lens
from cvnotes.projective import from_homogeneous

# Where the five numbers of the sensor stand in A.
SENSOR = {"alpha_u": (0, 0), "alpha_v": (1, 1), "skew": (0, 1), "u0": (0, 2), "v0": (1, 2)}


def intrinsics(alpha_u: float, alpha_v: float, u0: float, v0: float, skew: float = 0.0) -> Array:
    """Build the intrinsic matrix A (3, 3), all entries in pixels.

    (u0, v0) is the principal point, which the notes call the piercing point.

    Examples
    --------
    >>> intrinsics(800, 805, 320, 240)
    array([[800.,   0., 320.],
           [  0., 805., 240.],
           [  0.,   0.,   1.]])
    """
    entries = {"alpha_u": alpha_u, "alpha_v": alpha_v, "u0": u0, "v0": v0, "skew": skew}
    alpha_u, alpha_v, u0, v0, skew = (number(x, name) for name, x in entries.items())
    return intrinsic_matrix([[alpha_u, skew, u0], [0, alpha_v, v0], [0, 0, 1]])


def intrinsics_from_pixel_size(
    f: float, du: float, dv: float, u0: float, v0: float, *, angle: float = pi / 2
) -> Array:
    """Build the intrinsic matrix A (3, 3) from what the makers of lens and sensor print.

    Parameters
    ----------
    f : float
        Focal length, in the same unit of length as the pixels.
    du, dv : float
        Width and height of a pixel.
    u0, v0 : float
        Where the optical axis pierces the picture, in pixels; in general not its middle (E7).
    angle : float
        Angle in radians between the sensor's axes u and v.

    Returns
    -------
    ndarray, shape (3, 3)
        [α_u  −α_u cot θ  u0; 0  α_v / sin θ  v0; 0 0 1] with α_u = f / du and α_v = f / dv.

    Notes
    -----
    The notes give the skew entry as cot(π/2) = 0, without its factor, and leave α_v as it is
    (erratum E9). An angle below 90° makes the skew negative.

    References
    ----------
    .. [1] Notes 2b.2, "Image Digitalization".
    .. [2] Forsyth and Ponce, Computer Vision, 2nd ed. (2012), 1.2.2.

    Examples
    --------
    >>> intrinsics_from_pixel_size(8.0, 0.01, 0.01, 320, 240)  # 8 mm, 10 µm
    array([[800.,   0., 320.],
           [  0., 800., 240.],
           [  0.,   0.,   1.]])
    """
    given = {"f": f, "du": du, "dv": dv, "angle": angle}
    f, du, dv, angle = (number(value, name) for name, value in given.items())
    for name, value in zip(given, (f, du, dv, angle), strict=True):
        if value <= 0:
            raise CvnotesError(f"{name}: expected a positive number, got {value:g}")
    if angle >= pi:
        raise CvnotesError(f"angle: expected radians between 0 and π, got {angle:g} (degrees?)")
    alpha_u, alpha_v = f / du, f / dv
    skew = 0.0 if angle == pi / 2 else -alpha_u / tan(angle)
    return intrinsics(alpha_u, alpha_v / sin(angle), u0, v0, skew)


@guarded(A=intrinsic_matrix, xy=Points(2))
def px_from_xy(A: Array, xy: Array) -> Array:
    """Turn image coordinates on the plane z = 1 into pixels (..., 2): m̃ = A (x, y, 1)ᵀ.

    Examples
    --------
    >>> px_from_xy(intrinsics(800, 805, 320, 240), [0.1, 0.2])
    array([400., 401.])
    """
    x, y = xy[..., 0], xy[..., 1]
    u = A[0, 0] * x + A[0, 1] * y + A[0, 2]
    v = A[1, 1] * y + A[1, 2]
    return np.stack([u, v], axis=-1)


@guarded(A=intrinsic_matrix, m=Points(2))
def xy_from_px(A: Array, m: Array) -> Array:
    """Turn pixels (..., 2) into image coordinates on the plane z = 1, still through the lens.

    Examples
    --------
    >>> xy_from_px(intrinsics(800, 805, 320, 240), [400, 401])
    array([0.1, 0.2])
    """
    u, v = m[..., 0], m[..., 1]
    y = (v - A[1, 2]) / A[1, 1]
    x = (u - A[0, 2] - A[0, 1] * y) / A[0, 0]
    return np.stack([x, y], axis=-1)


# The pose of a camera whose frame is that of the world: good already, as nobody can write to it.
_AT_ITS_OWN_FRAME = np.eye(4)
_AT_ITS_OWN_FRAME.setflags(write=False)
_ON_A_SIDE = 200  # points of the border that are asked for: a lens folds over many at once


@dataclass(frozen=True, eq=False)
class Camera:
    """A camera: sensor A, pose G, lens and picture size.

    Parameters
    ----------
    A : array_like, shape (3, 3)
        Intrinsic matrix in pixels; see `intrinsics`.
    G : array_like, shape (4, 4)
        Rigid motion that carries world points into the camera's frame (CRF ← WRF).
    lens : Lens, RationalLens, FisheyeLens, or another `AnyLens`
        Distortion on the plane z = 1; a fisheye's depends on the angle of the ray.
    size : (width, height)
        The picture's size in pixels. Pixel centres are integers.

    Examples
    --------
    >>> from cvnotes.camera import Camera, intrinsics
    >>> camera = Camera(intrinsics(800, 800, 320, 240))
    >>> camera.project([[0.0, 0.0, 5.0], [1.0, 0.5, 5.0]])
    array([[320., 240.],
           [480., 320.]])
    """

    A: Array
    G: Array = field(default_factory=lambda: _AT_ITS_OWN_FRAME)
    lens: AnyLens = field(default_factory=Lens)
    size: tuple[int, int] = (640, 480)

    def __post_init__(self) -> None:
        if not isinstance(self.lens, AnyLens):
            raise CvnotesError(f"lens: expected a Lens, got {type(self.lens).__name__}")
        A = intrinsic_matrix(self.A)
        G = self.G if self.G is _AT_ITS_OWN_FRAME else rigid_motion(self.G)
        if G.ndim != 2:
            raise CvnotesError(f"G: a camera has one pose (4, 4), got {G.shape}")
        for array in (A, G):
            array.setflags(write=False)
        object.__setattr__(self, "A", A)
        object.__setattr__(self, "G", G)
        object.__setattr__(self, "size", image_size(self.size))

    @property
    def R(self) -> Array:
        """Rotation CRF ← WRF, (3, 3)."""
        return self.G[:3, :3]

    @property
    def T(self) -> Array:
        """Where the world's origin lies in the CRF, (3,). Not the camera's position."""
        return self.G[:3, 3]

    @cached_property
    def P(self) -> Array:
        """The perspective projection matrix P = A [I|0] G = A [R|T], (3, 4)."""
        P = self.A @ self.G[:3]
        P.setflags(write=False)
        return P

    @property
    def factors(self) -> tuple[Array, Array, Array]:
        """What P is made of: A (sensor), [I|0] (pinhole, the canonical PPM), G (pose)."""
        return self.A, np.eye(3, 4), self.G

    @property
    def centre(self) -> Array:
        """Where the camera stands in the WRF, (3,): C = −Rᵀ T."""
        return -self.R.T @ self.T + 0.0

    def moved(self, G: npt.ArrayLike) -> "Camera":
        """Return the same camera with another pose G (4, 4)."""
        return Camera(self.A, cast(Array, G), self.lens, self.size)  # guards it

    def cropped(self, corner: Sequence[int], size: tuple[int, int]) -> "Camera":
        """Return the camera whose pictures are a part of this one's.

        Parameters
        ----------
        corner : (left, top)
            The pixel of the whole picture that becomes pixel (0, 0): columns cut off on the left,
            rows cut off above.
        size : (width, height)
            Of the part.

        Returns
        -------
        Camera
            It would have taken ``picture[top : top + height, left : left + width]``.

        Raises
        ------
        CvnotesError
            The part reaches out of the picture.

        Notes
        -----
        u0 − left and v0 − top. Nothing is stretched, so focal lengths, skew and lens stay.

        Examples
        --------
        >>> from cvnotes.camera import Camera, intrinsics
        >>> part = Camera(intrinsics(800, 804, 325, 238)).cropped((100, 60), (320, 240))
        >>> part.parameters["u0"], part.parameters["v0"], part.size
        (225.0, 178.0, (320, 240))
        """
        at, (width, height) = _whole_pair(corner, "corner"), image_size(size)
        whole = f"{self.size[0]} × {self.size[1]}"
        if min(at) < 0 or at[0] + width > self.size[0] or at[1] + height > self.size[1]:
            raise CvnotesError(
                f"a part of {width} × {height} from pixel {at} on is not inside of a picture of "
                f"{whole} (row before column?)"
            )
        shift = np.array([[1, 0, -at[0]], [0, 1, -at[1]], [0, 0, 1.0]])
        return Camera(shift @ self.A, self.G, self.lens, (width, height))

    def resized(self, size: tuple[int, int]) -> "Camera":
        """Return the camera whose pictures are this one's, made larger or smaller.

        Parameters
        ----------
        size : (width, height)
            Of the new picture. It shows the same as the old one, from border to border.

        Notes
        -----
        With s = width / old width, the left border, u = −½, has to stay the left border: so it is
        u + ½ that is multiplied, u' = s (u + ½) − ½. Of A, α_u and the skew are multiplied by s,
        and u0 becomes s (u0 + ½) − ½; likewise for v. The lens acts before there are pixels, and
        stays. ``cv2.resize`` keeps to the same rule.

        Examples
        --------
        >>> from cvnotes.camera import Camera, intrinsics
        >>> half = Camera(intrinsics(800, 804, 325, 238)).resized((320, 240))
        >>> half.parameters["alpha_u"], half.parameters["u0"], half.parameters["v0"]
        (400.0, 162.25, 118.75)
        """
        size = image_size(size)
        s_u, s_v = size[0] / self.size[0], size[1] / self.size[1]
        stretch = np.array([[s_u, 0, (s_u - 1) / 2], [0, s_v, (s_v - 1) / 2], [0, 0, 1]])
        return Camera(stretch @ self.A, self.G, self.lens, size)

    @property
    def parameters(self) -> dict[str, float]:
        """Sensor and lens as named numbers: alpha_u, alpha_v, skew, u0, v0, k1, …, p1, p2.

        Lens coefficients without a name here are zero.

        Examples
        --------
        >>> from cvnotes.camera import Camera, intrinsics
        >>> Camera(intrinsics(800, 805, 320, 240), lens=Lens(k=(-0.25,))).parameters
        {'alpha_u': 800.0, 'alpha_v': 805.0, 'skew': 0.0, 'u0': 320.0, 'v0': 240.0, 'k1': -0.25}
        """
        sensor = {name: float(self.A[place]) for name, place in SENSOR.items()}
        return sensor | self.lens.parameters

    def with_parameters(self, values: Mapping[str, float]) -> "Camera":
        """Return the same camera with other values of the parameters that are named.

        Examples
        --------
        >>> from cvnotes.camera import Camera, intrinsics
        >>> camera = Camera(intrinsics(800, 805, 320, 240))
        >>> camera.with_parameters({"alpha_u": 810, "k1": -0.2}).parameters
        {'alpha_u': 810.0, 'alpha_v': 805.0, 'skew': 0.0, 'u0': 320.0, 'v0': 240.0, 'k1': -0.2}
        """
        A, lens = with_values(self.A, self.lens, values)
        return Camera(A, self.G, lens, self.size)

    def depth(self, W: npt.ArrayLike) -> Array:
        """Distance of world points (..., 3) from the plane z = 0 of the CRF, along its axis."""
        return np.asarray(points(W, "W", 3) @ self.R[2] + self.T[2])

    @guarded(W=Points(3))
    @np.errstate(over="ignore", invalid="ignore")  # of points too far away to have an image
    def project(self, W: Array) -> Array:
        """Image world points: the four steps of the image formation flow.

        Parameters
        ----------
        W : array_like, shape (..., 3)
            Points in the WRF.

        Returns
        -------
        ndarray, shape (..., 2)
            Pixels (u, v). Rows of points that are not in front of the camera, or that the lens
            model does not reach, are NaN. Pixels may lie outside of the picture.

        References
        ----------
        .. [1] Notes 2b.3, "Image Formation Flow".

        Examples
        --------
        >>> from cvnotes.camera import Camera, intrinsics
        >>> Camera(intrinsics(800, 800, 320, 240)).project([0, 0, -1])
        array([nan, nan])
        """
        # 1. WRF → CRF
        M = W @ self.R.T + self.T
        # 2. divide by z, and 3. lens (one step: a fisheye goes by the angle, not by x/z and y/z)
        xy_lens = self.lens.of_rays.inside(self.lens, M)
        # 4. sensor
        return px_from_xy.inside(self.A, xy_lens)

    @guarded(m=Points(2))
    def ideal(self, m: Array) -> Array:
        """Undo sensor and lens: pixels (..., 2) to ideal coordinates on the plane z = 1.

        Rows that the lens model does not reach are NaN.

        Examples
        --------
        >>> from cvnotes.camera import Camera, intrinsics
        >>> Camera(intrinsics(800, 800, 320, 240)).ideal([400, 240])
        array([0.1, 0. ])
        """
        return self.lens.undistort.inside(self.lens, xy_from_px.inside(self.A, m))

    def ray(self, m: npt.ArrayLike) -> Array:
        """Return the direction in the WRF of the ray that pixels (..., 2) see, as unit vectors.

        The ray starts at ``centre``. Rows that the lens model does not reach are NaN.

        Examples
        --------
        >>> from cvnotes.camera import Camera, intrinsics
        >>> Camera(intrinsics(800, 800, 320, 240)).ray([320, 240])
        array([0., 0., 1.])
        """
        return np.asarray(self.lens.rays.inside(self.lens, xy_from_px(self.A, m)) @ self.R)

    @guarded(d=Points(3))
    def vanishing_point(self, d: Array) -> Array:
        """Return the pixel (..., 2) where lines of world direction d (..., 3) seem to end.

        Through an ideal lens: m̃ ≈ P [d; 0]. A direction parallel to the image plane has its
        vanishing point at infinity (NaN). d and −d share one vanishing point.

        Examples
        --------
        >>> from cvnotes.camera import Camera, intrinsics
        >>> Camera(intrinsics(800, 800, 320, 240)).vanishing_point([1, 0, 2])
        array([720., 240.])
        """
        return from_homogeneous.inside(d @ self.P[:, :3].T)

    @property
    def field_of_view(self) -> tuple[float, float]:
        """Angles in radians that the picture spans (horizontally, vertically) at its middle."""
        w, h = self.size
        u, v = self.A[0, 2], self.A[1, 2]
        edges = [[-0.5, v], [w - 0.5, v], [u, -0.5], [u, h - 0.5]]
        x, y, z = (self.ray(edges) @ self.R.T).T
        left, right, top, bottom = np.arctan2([x[0], x[1], y[2], y[3]], z)
        return float(right - left), float(bottom - top)

    @property
    def is_invertible(self) -> bool:
        """Return whether every pixel of the picture shows a point that the lens model reaches."""
        w, h = self.size
        u, v = (np.linspace(0, n - 1, min(n, _ON_A_SIDE)) for n in self.size)
        border = [(u, 0 * u), (u, 0 * u + h - 1), (0 * v, v), (0 * v + w - 1, v)]
        edge = np.concatenate([np.stack(side, axis=-1) for side in border])
        return not np.isnan(self.ideal(edge)).any()

    def __repr__(self) -> str:
        a, w = self.A, self.size
        return (
            f"Camera(alpha_u={a[0, 0]:.2f}, alpha_v={a[1, 1]:.2f}, u0={a[0, 2]:.2f}, "
            f"v0={a[1, 2]:.2f}, skew={a[0, 1]:.2f}, lens={self.lens}, size={w})"
        )


def with_values(A: Array, lens: AnyLens, values: Mapping[str, float]) -> tuple[Array, AnyLens]:
    """Return A and lens with other values of the parameters that are named.

    Examples
    --------
    >>> with_values(np.eye(3), Lens(), {"u0": 320.0, "k1": -0.2})[1].k
    (-0.2,)
    """
    A, of_lens = A.copy(), {}
    for name, value in values.items():
        if name in SENSOR:
            A[SENSOR[name]] = value
        else:
            of_lens[name] = value
    return A, lens.with_parameters(of_lens)


def _whole_pair(x: Any, name: str) -> tuple[int, int]:
    """Guard a pixel that is named by two whole numbers, (column, row)."""
    pair = numbers(x, name)
    if pair.shape != (2,) or (pair != np.round(pair)).any():
        raise CvnotesError(f"{name}: expected (column, row), two whole numbers, got {x!r}")
    return int(pair[0]), int(pair[1])


def is_camera(x: Any, name: str) -> Camera:
    """Guard a camera.

    Examples
    --------
    >>> is_camera("left.json", "left")
    Traceback (most recent call last):
    cvnotes.base.errors.InputTypeError: left: expected a Camera, got str
    """
    if not isinstance(x, Camera):
        raise InputTypeError(f"{name}: expected a Camera, got {type(x).__name__}")
    return x


def project_with_derivative(camera: Camera, M: Array) -> tuple[Array, Array]:
    """Image points M (n, 3) of the CRF: pixels m (n, 2), and dm/dM (n, 2, 3).

    Rows that are not in front of the camera, or that its lens does not reach, are NaN in both.
    No guard: for use inside, by who refines.

    Notes
    -----
    dm/dM = A₂ₓ₂ · d(x', y')/dM.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> camera = Camera(intrinsics(800, 800, 320, 240))
    >>> project_with_derivative(camera, np.array([[0.0, 1, 10]]))
    (array([[320., 320.]]), array([[[80.,  0.,  0.],
            [ 0., 80., -8.]]]))
    """
    m = px_from_xy.inside(camera.A, camera.lens.of_rays.inside(camera.lens, M))
    by_M = np.full((len(M), 2, 3), np.nan)
    valid = np.isfinite(m).all(-1)
    by_M[valid] = camera.A[:2, :2] @ np.moveaxis(camera.lens.derivatives(M[valid].T)[1], -1, 0)
    return m, by_M
