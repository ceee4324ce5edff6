"""The sensor: from the plane z = 1 to pixels, and back (notes 2b.2)."""

from math import pi, sin, tan

import numpy as np

from cvnotes.base import Array, CvnotesError, Points, guarded, intrinsic_matrix, number


def intrinsics(alpha_u: float, alpha_v: float, u0: float, v0: float, skew: float = 0.0) -> Array:
    """Build the intrinsic matrix A (3, 3), all entries in pixels.

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
