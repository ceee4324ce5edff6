"""The camera: the perspective projection matrix and what it is made of (notes 2b.1-2b.3)."""

from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np
import numpy.typing as npt

from cvnotes.errors import (
    Array,
    CvnotesError,
    DegenerateError,
    ShapeError,
    image_size,
    intrinsic_matrix,
    matrix,
    numbers,
    points,
    rigid_motion,
)
from cvnotes.lens import Lens
from cvnotes.projective import drop


def intrinsics(alpha_u: float, alpha_v: float, u0: float, v0: float, skew: float = 0.0) -> Array:
    """Build the intrinsic matrix A (3, 3), all entries in pixels.

    Examples
    --------
    >>> intrinsics(800, 805, 320, 240)
    array([[800.,   0., 320.],
           [  0., 805., 240.],
           [  0.,   0.,   1.]])
    """
    return intrinsic_matrix([[alpha_u, skew, u0], [0, alpha_v, v0], [0, 0, 1]])


def intrinsics_from_pixel_size(
    f: float, du: float, dv: float, u0: float, v0: float, *, angle: float = np.pi / 2
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
    for name, value in given.items():
        if not numbers(value, name) > 0:
            raise CvnotesError(f"{name}: expected a positive number, got {value}")
    if angle >= np.pi:
        raise CvnotesError(f"angle: expected radians between 0 and π, got {angle:g} (degrees?)")
    alpha_u, alpha_v = f / du, f / dv
    skew = 0.0 if angle == np.pi / 2 else -alpha_u / np.tan(angle)
    return intrinsics(alpha_u, alpha_v / np.sin(angle), u0, v0, skew)


def px_from_xy(A: npt.ArrayLike, xy: npt.ArrayLike) -> Array:
    """Turn image coordinates on the plane z = 1 into pixels (..., 2): m̃ = A (x, y, 1)ᵀ.

    Examples
    --------
    >>> px_from_xy(intrinsics(800, 805, 320, 240), [0.1, 0.2])
    array([400., 401.])
    """
    return pixels(intrinsic_matrix(A), points(xy, "xy", 2))


def xy_from_px(A: npt.ArrayLike, m: npt.ArrayLike) -> Array:
    """Turn pixels (..., 2) into image coordinates on the plane z = 1, still through the lens.

    Examples
    --------
    >>> xy_from_px(intrinsics(800, 805, 320, 240), [400, 401])
    array([0.1, 0.2])
    """
    return np.stack(_xy_from_px(intrinsic_matrix(A), points(m, "m", 2)), axis=-1)


@dataclass(frozen=True, eq=False)
class Camera:
    """A camera: sensor A, pose G, lens and picture size.

    Parameters
    ----------
    A : array_like, shape (3, 3)
        Intrinsic matrix in pixels; see `intrinsics`.
    G : array_like, shape (4, 4)
        Rigid motion that carries world points into the camera's frame (CRF ← WRF).
    lens : Lens
        Distortion on the plane z = 1.
    size : (width, height)
        The picture's size in pixels. Pixel centres are integers.

    Examples
    --------
    >>> camera = Camera(intrinsics(800, 800, 320, 240))
    >>> camera.project([[0.0, 0.0, 5.0], [1.0, 0.5, 5.0]])
    array([[320., 240.],
           [480., 320.]])
    """

    A: Array
    G: Array = field(default_factory=lambda: np.eye(4))
    lens: Lens = field(default_factory=Lens)
    size: tuple[int, int] = (640, 480)

    def __post_init__(self) -> None:
        if not isinstance(self.lens, Lens):
            raise CvnotesError(f"lens: expected a Lens, got {type(self.lens).__name__}")
        A, G = intrinsic_matrix(self.A), rigid_motion(self.G)
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
        """Give the same camera with another pose G (4, 4)."""
        return Camera(self.A, rigid_motion(G), self.lens, self.size)

    def depth(self, W: npt.ArrayLike) -> Array:
        """Distance of world points (..., 3) from the plane z = 0 of the CRF, along its axis."""
        return np.asarray(points(W, "W", 3) @ self.R[2] + self.T[2])

    def project(self, W: npt.ArrayLike) -> Array:
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
        >>> Camera(intrinsics(800, 800, 320, 240)).project([0, 0, -1])
        array([nan, nan])
        """
        # 1. WRF → CRF
        M = points(W, "W", 3) @ self.R.T + self.T
        # 2. divide by z; what is not in front has no image
        z = M[..., 2:]
        xy = np.divide(M[..., :2], z, out=np.full_like(M[..., :2], np.nan), where=z > 0)
        # 3. lens, 4. sensor
        return pixels(self.A, self.lens._distort(xy))

    def ideal(self, m: npt.ArrayLike) -> Array:
        """Undo sensor and lens: pixels (..., 2) to ideal coordinates on the plane z = 1.

        Rows that the lens model does not reach are NaN.

        Examples
        --------
        >>> Camera(intrinsics(800, 800, 320, 240)).ideal([400, 240])
        array([0.1, 0. ])
        """
        return self.lens._undistort(points(m, "m", 2), partial(_xy_from_px, self.A))

    def ray(self, m: npt.ArrayLike) -> Array:
        """Give the direction in the WRF of the ray that pixels (..., 2) see, as unit vectors.

        The ray starts at ``centre``. Rows that the lens model does not reach are NaN.

        Examples
        --------
        >>> Camera(intrinsics(800, 800, 320, 240)).ray([320, 240])
        array([0., 0., 1.])
        """
        xy = self.ideal(m)
        d = np.concatenate([xy, np.ones_like(xy[..., :1])], axis=-1) @ self.R
        return np.asarray(d / np.linalg.norm(d, axis=-1, keepdims=True))

    def vanishing_point(self, d: npt.ArrayLike) -> Array:
        """Give the pixel (..., 2) where lines of world direction d (..., 3) seem to end.

        Through an ideal lens: m̃ ≈ P [d; 0]. A direction parallel to the image plane has its
        vanishing point at infinity (NaN). d and −d share one vanishing point.

        Examples
        --------
        >>> Camera(intrinsics(800, 800, 320, 240)).vanishing_point([1, 0, 2])
        array([720., 240.])
        """
        return drop(points(d, "d", 3) @ self.P[:, :3].T)

    @property
    def field_of_view(self) -> tuple[float, float]:
        """Angles in radians that the picture spans (horizontally, vertically) at its middle."""
        w, h = self.size
        u, v = self.A[0, 2], self.A[1, 2]
        edges = [[-0.5, v], [w - 0.5, v], [u, -0.5], [u, h - 0.5]]
        left, right, top, bottom = self.ray(edges)
        return float(np.arccos(left @ right)), float(np.arccos(top @ bottom))

    @property
    def is_invertible(self) -> bool:
        """Tell whether every pixel of the picture shows a point that the lens model reaches."""
        w, h = self.size
        u, v = np.arange(w), np.arange(h)
        border = [(u, 0 * u), (u, 0 * u + h - 1), (0 * v, v), (0 * v + w - 1, v)]
        edge = np.concatenate([np.stack(side, axis=-1) for side in border])
        return not np.isnan(self.ideal(edge)).any()

    def __repr__(self) -> str:
        a, w = self.A, self.size
        return (
            f"Camera(alpha_u={a[0, 0]:.2f}, alpha_v={a[1, 1]:.2f}, u0={a[0, 2]:.2f}, "
            f"v0={a[1, 2]:.2f}, skew={a[0, 1]:.2f}, lens={self.lens}, size={w})"
        )


def decompose(P: npt.ArrayLike) -> tuple[Array, Array, Array]:
    """Take a projection matrix apart: P ≈ A [R|T].

    Parameters
    ----------
    P : array_like, shape (3, 4)
        A projection matrix, of any scale and sign.

    Returns
    -------
    A : ndarray, shape (3, 3)
        Intrinsic matrix with positive focal lengths and A[2, 2] = 1.
    R : ndarray, shape (3, 3)
        Rotation with determinant +1.
    T : ndarray, shape (3,)
        Translation.

    Raises
    ------
    DegenerateError
        The left 3×3 block is singular: the camera is at infinity, or P has too low a rank.

    Notes
    -----
    The left block is A R up to scale. Its RQ decomposition is the QR decomposition of the
    block read backwards; signs are moved so that the diagonal of A is positive.

    References
    ----------
    .. [1] Notes 2b.2, "Rigid motion".
    .. [2] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 6.2.4.

    Examples
    --------
    >>> camera = Camera(intrinsics(800, 805, 320, 240))
    >>> np.allclose(decompose(-3 * camera.P)[0], camera.A)
    True
    """
    P = matrix(P, "P", 3, 4)
    largest = np.abs(P).max(initial=0.0)
    if P.ndim != 2 or largest == 0:
        raise DegenerateError("P must be one non-zero (3, 4) matrix")
    P = P / largest
    s = np.linalg.svd(P[:, :3], compute_uv=False)
    if s[2] <= 1e-13 * s[0]:
        raise DegenerateError(
            "the left 3×3 block of P is singular: its camera is at infinity (affine), "
            "or the rank of P is below 3"
        )
    if np.linalg.det(P[:, :3]) < 0:
        P = -P
    Q, U = np.linalg.qr(P[::-1, :3].T)
    A, R = U.T[::-1, ::-1], Q.T[::-1]
    signs = np.sign(np.diag(A))
    A, R = A * signs, signs[:, None] * R
    T = np.linalg.solve(A, P[:, 3])
    return np.triu(A / A[2, 2]), R, T


def pixels(A: Array, xy: Array) -> Array:
    """Apply A without a guard, so that NaN rows stay NaN: for use inside."""
    x, y = xy[..., 0], xy[..., 1]
    return np.stack([A[0, 0] * x + A[0, 1] * y + A[0, 2], A[1, 1] * y + A[1, 2]], axis=-1)


def _xy_from_px(A: Array, m: Array) -> tuple[Array, Array]:
    """Undo A without a guard, and give the two columns."""
    y = (m[..., 1] - A[1, 2]) / A[1, 1]
    return (m[..., 0] - A[0, 2] - A[0, 1] * y) / A[0, 0], y


def centre_of(P: npt.ArrayLike) -> Array:
    """Give the camera centre as the null vector of P, homogeneous (4,).

    Also defined for cameras at infinity, whose centre has a zero last coordinate.

    Raises
    ------
    DegenerateError
        P has rank below 3, so that more than a point has no image.

    Examples
    --------
    >>> centre_of(np.eye(3, 4))
    array([0., 0., 0., 1.])
    """
    P = matrix(P, "P", 3, 4)
    if P.ndim != 2:
        raise ShapeError(f"P: expected one (3, 4) matrix, got {P.shape}")
    _, s, Vt = np.linalg.svd(P)
    if s[2] <= 1e-13 * s[0]:
        raise DegenerateError("P has rank below 3: it has no single centre")
    C = Vt[3]
    sign = C[3] if abs(C[3]) > 1e-14 else C[np.argmax(np.abs(C))]
    return np.asarray(C * np.sign(sign)) + 0.0
