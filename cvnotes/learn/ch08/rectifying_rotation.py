"""Two cameras side by side."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded, some_rotation
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def rectifying_rotation(R: Array, left: Array, right: Array) -> Array:
    """Give the rotation CRF ← WRF that both cameras of a pair are turned to."""
    x = _unit(right - left)
    y = _unit(np.cross(R[2], x))
    return np.array([x, y, np.cross(x, y)])


def _unit(x: Array) -> Array:
    return np.asarray(x / np.linalg.norm(x))


def _stereo_pairs(rng: Rng) -> list[Case]:
    R = some_rotation(rng)
    left = rounded(rng.uniform(-50, 50, 3), 1)
    right = rounded(left + R.T @ [100.0, *rng.uniform(-8, 8, 2)], 1)
    return [Case((np.eye(3), np.zeros(3), np.array([3.0, 0.0, 4.0]))), Case((R, left, right))]


def _unscaled(R: Array, x: Array) -> Array:
    y = np.cross(R[2], x)
    return np.array([x, y, np.cross(x, y)])


def _from_x(z: Array, x: Array) -> Array:
    x = _unit(x)
    y = _unit(np.cross(z, x))
    return np.array([x, y, np.cross(x, y)])


def _old_y(R: Array, left: Array, right: Array) -> Array:
    x = _unit(right - left)
    z = _unit(np.cross(x, R[1]))
    return np.array([x, np.cross(z, x), z])


def _old_z(R: Array, left: Array, right: Array) -> Array:
    y = _unit(np.cross(R[2], right - left))
    return np.array([np.cross(y, R[2]), y, R[2]])


RECTIFY = Exercise(
    name="rectifying_rotation",
    chapter=8,
    title="Two cameras side by side",
    task="To rectify a stereo pair both cameras are turned to one rotation, CRF ← WRF, whose x "
    "axis leads from the left camera's centre to the right one's; its z axis is as near as that "
    "allows to the left camera's. Give it (3, 3) from the left camera's R and the two centres.",
    stub='''def my_rectifying_rotation(R, left, right):
    """Give the common rotation (3, 3), CRF ← WRF; left and right are centres (3,)."""
    ...''',
    hints=(
        "The rows of a rotation CRF ← WRF are the camera's axes, seen in the world.",
        "First row: the unit vector from left to right. The old z axis is R[2].",
        "y = z_old × x, scaled to length 1: it points down, as y does in every camera's frame. "
        "Then "
        "z = x × y.",
    ),
    cases=_stereo_pairs,
    properties=(
        Property(
            "It is a rotation.",
            lambda R, _: np.allclose(R @ R.T, np.eye(3), atol=1e-5) and np.linalg.det(R) > 0,
        ),
        Property(
            "The right camera lies on the left one's x axis.",
            lambda R, c: np.allclose(
                R @ _unit(c.args[2] - c.args[1]), [1, 0, 0], rtol=0, atol=1e-5
            ),
        ),
        Property("It looks as nearly as it can where the left camera looked."),
    ),
    misconceptions=(
        Misconception(
            "axes as columns",
            "You wrote the axes as columns, which is the rotation WRF ← CRF: transpose it.",
            lambda R, left, right: rectifying_rotation(R, left, right).T,
        ),
        Misconception(
            "from right to left",
            "Your x axis leads from the right camera to the left one, so that the pictures stand "
            "on their heads.",
            lambda R, left, right: rectifying_rotation(R, right, left),
        ),
        Misconception(
            "z axis kept",
            "You kept the old z axis, which need not be perpendicular to the baseline: that is no "
            "rotation. Finish with z = x × y.",
            lambda R, left, right: np.array(
                [
                    *rectifying_rotation(R, left, right)[:2],
                    R[2],
                ]
            ),
        ),
        Misconception(
            "y axis not of length 1",
            "Your y axis is not of length 1: z_old × x is shorter, unless both are perpendicular.",
            lambda R, left, right: _unscaled(R, _unit(right - left)),
        ),
        Misconception(
            "left-handed",
            "Your z axis points backwards: z = x × y, in this order.",
            lambda R, left, right: rectifying_rotation(R, left, right) * [[1], [1], [-1]],
        ),
        Misconception(
            "y the wrong way round",
            "Your y axis points up: y = z_old × x, in this order.",
            lambda R, left, right: rectifying_rotation(R, left, right) * [[1], [-1], [-1]],
        ),
        Misconception(
            "nothing turned",
            "That is the left camera's own rotation; its x axis need not lie along the baseline.",
            lambda R, left, right: R,
        ),
        Misconception(
            "a column of R for its row",
            ("R[:, 2] is the world's z axis, seen by the camera. The camera's own z axis is R[2]."),
            lambda R, left, right: rectifying_rotation(R.T, left, right),
        ),
        Misconception(
            "x axis not of length 1",
            "Your x axis is not of length 1: divide the baseline by its length.",
            lambda R, left, right: (
                rectifying_rotation(R, left, right) * [[np.linalg.norm(right - left)], [1], [1]]
            ),
        ),
        Misconception(
            "old y axis",
            "You kept the old y axis; asked is that z stays as near as it can: y = z_old × x.",
            _old_y,
        ),
        Misconception(
            "baseline turned too",
            (
                "You turned the baseline into the camera's frame; the rows of the rotation are "
                "axes seen in the world."
            ),
            lambda R, left, right: _from_x(R[2], R @ (right - left)),
        ),
        Misconception(
            "centre for the baseline",
            "x leads from the left centre to the right one: right − left.",
            lambda R, left, right: _from_x(R[2], right),
        ),
        Misconception(
            "rows in another order",
            "You have the rows in another order: x, y, z.",
            lambda R, left, right: rectifying_rotation(R, left, right)[[0, 2, 1]],
            variants=(
                lambda R, left, right: rectifying_rotation(R, left, right)[[2, 1, 0]],
                lambda R, left, right: rectifying_rotation(R, left, right)[[1, 0, 2]],
            ),
        ),
        Misconception(
            "old z axis in front",
            "You kept z and made x perpendicular to it: x has to lie along the baseline.",
            _old_z,
        ),
        Misconception(
            "the world's z axis",
            "You took the world's z axis, (0, 0, 1); asked is nearness to the left camera's, R[2].",
            lambda R, left, right: _from_x(np.array([0.0, 0, 1]), right - left),
        ),
        Misconception(
            "multiplied by R once more",
            "The rows are axes in the world already: that is the rotation, R does not come once "
            "more.",
            lambda R, left, right: rectifying_rotation(R, left, right) @ R,
            variants=(
                lambda R, left, right: R @ rectifying_rotation(R, left, right),
                lambda R, left, right: R.T @ rectifying_rotation(R, left, right),
            ),
        ),
        Misconception(
            "axes in the camera's frame",
            "Your axes are seen in the left camera's frame: that is by how much it is turned. CRF "
            "← "
            "WRF needs them in the world: multiply by R.",
            lambda R, left, right: rectifying_rotation(R, left, right) @ R.T,
            variants=(lambda R, left, right: R @ rectifying_rotation(R, left, right).T,),
        ),
        Misconception(
            "a column of R for y",
            "You made z = x × R[:, 1] or the like: a column of R is an axis of the world.",
            lambda R, left, right: _old_y(R.T, left, right),
        ),
        Misconception(
            "y not perpendicular",
            "You kept the old y axis as it is: it need not be perpendicular to the baseline.",
            lambda R, left, right: np.array(
                [_unit(right - left), R[1], np.cross(_unit(right - left), R[1])]
            ),
            variants=(lambda R, left, right: np.array([_unit(right - left), R[1], R[2]]),),
        ),
        Misconception(
            "sum of the centres",
            "You added the centres; the baseline is their difference, right − left.",
            lambda R, left, right: _from_x(R[2], right + left),
        ),
        Misconception(
            "baseline alone",
            "That is the x axis; y = z_old × x and z = x × y are missing.",
            lambda R, left, right: _unit(right - left),
        ),
        Misconception(
            "y from the world",
            "You took the world's y axis for the new one's neighbour; asked is that z stays near "
            "R[2].",
            lambda R, left, right: _old_y(np.eye(3), left, right),
        ),
    ),
    reference=rectifying_rotation,
    concepts=("70", "j"),
)
