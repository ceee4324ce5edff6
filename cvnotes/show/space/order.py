"""From far to near: flat things cut where they pass through each other, and put in order.

What lies behind the plane of a face is painted before the face, and what lies before it afterwards.
"""

from typing import Generic, NamedTuple, TypeVar

import numpy as np

from cvnotes.base import Array

Paint = TypeVar("Paint")


class Part(NamedTuple, Generic[Paint]):
    """A line (2, 3) or a flat face (k, 3), and what it is painted with."""

    corners: Array
    paint: Paint


def from_far_to_near(
    parts: list[Part[Paint]], towards: Array, thinnest: float
) -> list[Part[Paint]]:
    """Return parts in an order in which a painter does not paint far things over near ones.

    Parameters
    ----------
    parts : list of Part
        Those that pass through the plane of a face are cut there.
    towards : ndarray, shape (3,)
        Direction to the viewer, who is far away.
    thinnest : float
        How far from a plane a corner may be that still lies in it.

    Examples
    --------
    >>> wall = Part(np.array([[0.0, 0, 5], [9, 0, 5], [0, 9, 5]]), "wall")
    >>> ray = Part(np.array([[1.0, 1, 0], [1, 1, 9]]), "ray")
    >>> ordered = from_far_to_near([ray, wall], np.array([0.0, 0, -1]), 1e-9)
    >>> [(part.paint, part.corners[:, 2].tolist()) for part in ordered]
    [('ray', [5.0, 9.0]), ('wall', [5.0, 5.0, 5.0]), ('ray', [0.0, 5.0])]
    """
    done, todo = list[Part[Paint]](), [(parts, False)]
    while todo:
        some, in_order = todo.pop()
        face = next((part for part in some if _is_face(part)), None)
        if in_order or face is None:
            # Lines come last: they lie on faces of the same plane.
            done += sorted(some, key=lambda part: (len(part.corners) == 2, _depth(part, towards)))
            continue
        normal = _normal(face.corners)
        normal = normal * np.copysign(1.0, normal @ towards)
        behind, within, before = list[Part[Paint]](), list[Part[Paint]](), list[Part[Paint]]()
        for part in some:
            height = (part.corners - face.corners[0]) @ normal
            height[np.abs(height) < thinnest] = 0
            if part is face or not height.any():
                within.append(part)
            else:
                for side, there in ((behind, -height), (before, height)):
                    if there.max() > 0:
                        side.append(part._replace(corners=_part_above(part.corners, there)))
        todo += [(before, False), (within, True), (behind, False)]  # the last is next
    return done


def _depth(part: Part[Paint], towards: Array) -> float:
    return float(part.corners.mean(axis=0) @ towards)


def _is_face(part: Part[Paint]) -> bool:
    return len(part.corners) > 2 and bool(_normal(part.corners).any())


def _normal(corners: Array) -> Array:
    """Return the direction (3,) across a face, of length 1; zeros if it has no area."""
    ways = corners[1:] - corners[0]
    across = np.cross(ways[:-1], ways[1:]).sum(axis=0)
    length = np.linalg.norm(across)
    return np.asarray(across / length if length > 0 else 0 * across)


def _part_above(corners: Array, height: Array) -> Array:
    """Cut off what has a height below 0, of a line or a face."""
    kept = []
    for i, (p, h) in enumerate(zip(corners, height, strict=True)):
        j = (i + 1) % len(corners)
        if h >= 0:
            kept.append(p)
        if h * height[j] < 0:
            kept.append(p + h / (h - height[j]) * (corners[j] - p))
    return np.array(kept[:2] if len(corners) == 2 else kept)
