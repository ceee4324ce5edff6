"""The map that straightens a photograph."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens
from cvnotes.learn.cases.cameras import lens_factor, pixel_centres, some_lens
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def undistortion_map(A: Array, k: Array, size: tuple[int, int]) -> Array:
    """Give where in the photograph to look up each pixel, (height, width, 2)."""
    columns, rows = size
    u, v = np.meshgrid(np.arange(columns), np.arange(rows))
    x, y = (u - A[0, 2]) / A[0, 0], (v - A[1, 2]) / A[1, 1]  # ideal: that is what is wanted
    r2 = x * x + y * y
    L = 1 + k[0] * r2 + k[1] * r2**2
    return np.stack([A[0, 0] * L * x + A[0, 2], A[1, 1] * L * y + A[1, 2]], axis=-1)


def _small_cameras(rng: Rng) -> list[Case]:
    A = np.array([[4.0, 0, 1.5], [0, 5, 1], [0, 0, 1]])
    k, _ = some_lens(rng)
    other = np.array([[12.0, 0, 4.2], [0, 13.0, 2.7], [0, 0, 1]])
    return [Case((A, np.array([-0.2, 0.05]), (4, 3))), Case((other, k, (10, 7)))]


def _moved(A: Array, k: Array, size: tuple[int, int], *, radius: str = "ideal") -> Array:
    """Move each pixel away from the principal point, by L of a radius that may be wrong."""
    m = pixel_centres(size)
    offset = m - (0 if radius == "from pixel 0" else A[:2, 2])
    xy = offset / (1 if radius == "pixels" else A[[0, 1], [0, 1]])
    moved = offset * lens_factor(xy, k)
    out = moved + (0 if radius == "from pixel 0" else A[:2, 2])
    return np.asarray(out.reshape(size[1], size[0], 2))


def _undone(A: Array, k: Array, size: tuple[int, int]) -> Array:
    ideal = Camera(A, lens=Lens(tuple(k))).ideal(pixel_centres(size))
    return (ideal @ A[:2, :2].T + A[:2, 2]).reshape(size[1], size[0], 2)


def _at_piercing_point(m: Array, case: Case) -> float:
    """Give by how much the map moves the pixel nearest to the principal point, less what it may."""
    u, v = np.round(case.args[0][:2, 2]).astype(int)
    return float(np.linalg.norm(m[v, u] - case.right[v, u]))


def _factors(A: Array, k: Array, size: tuple[int, int]) -> Array:
    return lens_factor((pixel_centres(size) - A[:2, 2]) / A[[0, 1], [0, 1]], k)


def _by(A: Array, L: Array, size: tuple[int, int]) -> Array:
    moved = A[:2, 2] + (pixel_centres(size) - A[:2, 2]) * L
    return moved.reshape(size[1], size[0], 2)


def _with_r(A: Array, k: Array, size: tuple[int, int]) -> Array:
    r = np.linalg.norm((pixel_centres(size) - A[:2, 2]) / A[[0, 1], [0, 1]], axis=1)[:, None]
    return np.asarray(1 + k[0] * r + k[1] * r**2)


def _half_pixels(A: Array, k: Array, size: tuple[int, int]) -> Array:
    m = pixel_centres(size) + 0.5
    offset = m - A[:2, 2]
    moved = A[:2, 2] + offset * lens_factor(offset / A[[0, 1], [0, 1]], k)
    return moved.reshape(size[1], size[0], 2)


def _centred(A: Array, size: tuple[int, int], less: int) -> Array:
    B = np.array(A)
    B[:2, 2] = (np.array(size) - less) / 2
    return B


def _twice(A: Array, k: Array, size: tuple[int, int]) -> Array:
    offset = undistortion_map(A, k, size) - A[:2, 2]
    return np.asarray(A[:2, 2] + offset * lens_factor(offset / A[[0, 1], [0, 1]], k))


UNDISTORTION = Exercise(
    name="undistortion_map",
    chapter=8,
    title="The map that straightens a photograph",
    task="For each pixel of the straightened picture, of size (width, height), give the position "
    "(u, v) in the photograph at which it is to be looked up: shape (height, width, 2). The lens "
    "has k = (k1, k2), and both pictures share A, which has no skew.",
    stub='''def my_undistortion_map(A, k, size):
    """Give the position in the photograph for each pixel, (height, width, 2)."""
    ...''',
    hints=(
        "Backwards: the target is the ideal picture, the source is the distorted one. So the way "
        "leads from ideal to distorted, and nothing has to be inverted.",
        "x = (u − u0) / α_u, y = (v − v0) / α_v; then L(r); then back to pixels.",
        "u' = u + (k1 r² + k2 r⁴)(u − u0), with r² = x² + y², and so for v.",
    ),
    cases=_small_cameras,
    properties=(
        Property(
            "The principal point stays where it is, as nothing is distorted there.",
            lambda m, c: abs(_at_piercing_point(m, c)) < 0.05,
        ),
        Property("Each pixel is looked up where the lens shows it."),
    ),
    misconceptions=(
        Misconception(
            "the wrong direction",
            "You undistorted the target's pixels. They are ideal already; where the lens shows "
            "them is found by distorting.",
            _undone,
        ),
        Misconception(
            "radius in pixels",
            "You took r² in pixels. k1 and k2 belong to x = (u − u0) / α_u and y = (v − v0) / α_v.",
            lambda A, k, size: _moved(A, k, size, radius="pixels"),
        ),
        Misconception(
            "about pixel (0, 0)",
            "You distorted about pixel (0, 0); the centre is the principal point (u0, v0).",
            lambda A, k, size: _moved(A, k, size, radius="from pixel 0"),
        ),
        Misconception(
            "v before u",
            "Your positions are (v, u); u comes first.",
            lambda A, k, size: undistortion_map(A, k, size)[..., ::-1],
        ),
        Misconception(
            "columns before rows",
            "The map has shape (width, height, 2); arrays have their rows first.",
            lambda A, k, size: undistortion_map(A, k, size).transpose(1, 0, 2),
        ),
        Misconception(
            "not back to pixels",
            "These are x' and y' on the plane z = 1; the look-up needs pixels.",
            lambda A, k, size: (undistortion_map(A, k, size) - A[:2, 2]) / A[[0, 1], [0, 1]],
        ),
        Misconception(
            "displacement only",
            "That is by how much each pixel moves; add where it is.",
            lambda A, k, size: (
                undistortion_map(A, k, size) - pixel_centres(size).reshape(size[1], size[0], 2)
            ),
        ),
        Misconception(
            "divided by L",
            (
                "You divided by L: that is about the way back. The target is ideal, and the "
                "photograph is found by distorting: multiply."
            ),
            lambda A, k, size: _by(A, 1 / _factors(A, k, size), size),
        ),
        Misconception(
            "both coefficients with r²",
            "k2 belongs to r⁴, which is (r²)²; you used r² for both.",
            lambda A, k, size: undistortion_map(A, np.array([k.sum(), 0.0]), size),
        ),
        Misconception(
            "r for r²",
            "You used r and r² where L has r² and r⁴.",
            lambda A, k, size: _by(A, _with_r(A, k, size), size),
        ),
        Misconception(
            "principal point not added back",
            "You left the result measured from the principal point: add u0 and v0.",
            lambda A, k, size: undistortion_map(A, k, size) - A[:2, 2],
        ),
        Misconception(
            "a list of positions",
            (
                "The positions are right, one after the other; asked is the shape (height, width, "
                "2)."
            ),
            lambda A, k, size: undistortion_map(A, k, size).reshape(-1, 2),
        ),
        Misconception(
            "nothing moved",
            "Every pixel is looked up where it is: the lens is missing.",
            lambda A, k, size: undistortion_map(A, 0 * k, size),
        ),
        Misconception(
            "half-pixel centres",
            "You took pixel centres at halves. Here whole numbers are the centres.",
            lambda A, k, size: _half_pixels(A, k, size),
            variants=(lambda A, k, size: _half_pixels(A, k, size) - 0.5,),
        ),
        Misconception(
            "u multiplied, not u − u0",
            "The radius is right, but L multiplies u − u0 and v − v0, not u and v themselves.",
            lambda A, k, size: (
                pixel_centres(size).reshape(size[1], size[0], 2)
                * _factors(A, k, size).reshape(size[1], size[0], 1)
            ),
        ),
        Misconception(
            "principal point in the middle",
            "You took the middle of the picture for the principal point: it is (A[0, 2], A[1, 2]).",
            lambda A, k, size: undistortion_map(_centred(A, size, 1), k, size),
            variants=(lambda A, k, size: undistortion_map(_centred(A, size, 0), k, size),),
        ),
        Misconception(
            "the factors alone",
            "These are the factors L; they multiply u − u0 and v − v0.",
            lambda A, k, size: _factors(A, k, size).reshape(size[1], size[0]),
        ),
        Misconception(
            "radius from pixel (0, 0)",
            "You measured the radius from pixel (0, 0): measure it from the principal point.",
            lambda A, k, size: _by(
                A, lens_factor(pixel_centres(size) / A[[0, 1], [0, 1]], k), size
            ),
        ),
        Misconception(
            "u and v first",
            "You have two pictures, one of u and one of v; asked is the shape (height, width, 2): "
            "axis=-1.",
            lambda A, k, size: np.moveaxis(undistortion_map(A, k, size), -1, 0),
        ),
        Misconception(
            "rows and columns exchanged",
            "You went through the picture with rows for columns: np.meshgrid(np.arange(width), "
            "np.arange(height)).",
            lambda A, k, size: undistortion_map(A, k, size[::-1]).transpose(1, 0, 2)[..., ::-1],
        ),
        Misconception(
            "the lens twice",
            "You applied the lens twice.",
            lambda A, k, size: _twice(A, k, size),
        ),
        Misconception(
            "the 1 of L left out",
            "L starts with 1: without distortion nothing moves.",
            lambda A, k, size: _by(A, _factors(A, k, size) - 1, size),
        ),
    ),
    reference=undistortion_map,
    concepts=("69", "77", "E44"),
)
