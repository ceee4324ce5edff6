"""The map that straightens a photograph."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens
from cvnotes.learn.cases.cameras import pixel_centres, some_lens
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _small_cameras(rng: np.random.Generator) -> list[Case]:
    A = np.array([[4.0, 0, 1.5], [0, 5, 1], [0, 0, 1]])
    k, _ = some_lens(rng)
    other = np.array([[12.0, 0, 4.2], [0, 13.0, 2.7], [0, 0, 1]])
    return [Case((A, np.array([-0.2, 0.05]), (4, 3))), Case((other, k, (10, 7)))]


def _undone(A: Array, k: Array, size: tuple[int, int]) -> Array:
    ideal = Camera(A, lens=Lens(tuple(k))).ideal(pixel_centres(size))
    return (ideal @ A[:2, :2].T + A[:2, 2]).reshape(size[1], size[0], 2)


def _at_piercing_point(m: Array, case: Case) -> float:
    """Return how far the map moves the pixel nearest to the principal point, less what it may."""
    u, v = np.round(case.args[0][:2, 2]).astype(int)
    return float(np.linalg.norm(m[v, u] - case.right[v, u]))


def undistortion_map(A: Array, k: Array, size: tuple[int, int]) -> Array:
    """Return the position in the photograph for each pixel, (height, width, 2)."""
    u, v = np.meshgrid(np.arange(size[0]), np.arange(size[1]))
    x = (u - A[0, 2]) / A[0, 0]  # the ideal x
    y = (v - A[1, 2]) / A[1, 1]  # the ideal y
    r2 = x**2 + y**2  # r²
    L = 1 + k[0] * r2 + k[1] * r2**2  # the radial factor L
    return np.stack([A[0, 0] * L * x + A[0, 2], A[1, 1] * L * y + A[1, 2]], axis=-1)


_MISTAKES = mistakes_in(undistortion_map,
    ("the wrong direction", "You undistorted: that is where a photographed pixel belongs. The map "
     "goes the other way, from the straight picture to the photograph.",
     _undone),
    ("radius in pixels", "You took the radius in pixels; where is L defined?",
     ("/ A[0, 0]", "/ 1", "/ A[1, 1]", "/ 1", "A[0, 0] * L", "L", "A[1, 1] * L", "L")),
    ("not back to pixels", "You stopped in the plane z = 1: asked are pixels of the photograph.",
     ("A[0, 0] * L * x + A[0, 2]", "L * x", "A[1, 1] * L * y + A[1, 2]", "L * y")),
    ("displacement only", "That is by how much each pixel moves; asked is where it is looked up.",
     lambda A, k, size: undistortion_map(A, k, size) - undistortion_map(A, 0 * k, size)),
    ("principal point not added back", "You gave offsets from the principal point; pixels are "
     "counted from the first one.",
     lambda A, k, size: undistortion_map(A, k, size) - A[:2, 2]),
    ("r for r²", "Which powers of r does L have? You have others.",
     ("r2 = x**2 + y**2", "r2 = np.hypot(x, y)")),
    ("nothing moved", "You gave each pixel its own position: the lens has no part in it.",
     lambda A, k, size: undistortion_map(A, 0 * k, size)),
    ("half-pixel centres", "You took pixel centres at halves. Here whole numbers are the centres.",
     ("np.arange(size[0])", "np.arange(size[0]) + 0.5", "np.arange(size[1])",
      "np.arange(size[1]) + 0.5"), lambda A, k, size: undistortion_map(A, k, size) + 0.5),
    ("u multiplied, not u − u0", "You multiplied u and v themselves: the lens moves a pixel away "
     "from the principal point, or towards it.",
     ("A[0, 0] * L * x + A[0, 2]", "L * u", "A[1, 1] * L * y + A[1, 2]", "L * v")),
    ("principal point in the middle", "You took the middle of the picture; A knows better.",
     ("A[0, 2]", "size[0] / 2", "A[1, 2]", "size[1] / 2"),
     ("A[0, 2]", "(size[0] - 1) / 2", "A[1, 2]", "(size[1] - 1) / 2")),
    ("rows and columns exchanged", "You counted rows as u and columns as v: u counts columns.",
     ("u, v = np.meshgrid", "v, u = np.meshgrid"),
     lambda A, k, size: undistortion_map(A, k, size[::-1]).transpose(1, 0, 2)[..., ::-1]),
    ("the lens twice", "You distorted twice.",
     ("    r2 = x**2 + y**2",
      "    r2 = x**2 + y**2; "
      "M = 1 + k[0] * r2 + k[1] * r2**2; x, y = M * x, M * y; r2 = M**2 * r2")),
)  # fmt: skip

EXERCISE = Exercise(
    name="undistortion_map",
    chapter=8,
    title="The map that straightens a photograph",
    task="For each pixel of the straightened picture, of size (width, height), give the position "
    "(u, v) in the photograph at which it is to be looked up: shape (height, width, 2). The lens "
    "has k = (k1, k2), and both pictures share A, which has no skew.",
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
    misconceptions=_MISTAKES,
    steps=undistortion_map,
    concepts=("69", "77", "E44"),
)
