"""Ambient occlusion: even light comes from all around, and less of it to where faces meet.

A face that stands on another one hides a part of the light from the strip beside it: the more the
nearer, no farther than it is high, and the less the narrower it is and the more it is seen edge-on.
That is worked out on a grid over each face, and read off between the nodes.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera

Indices = npt.NDArray[np.intp]

_HIDDEN = 0.32  # of the light, by an upright face right beside
_STEPS = 5  # of a grid, within the smallest reach; along a side no more than
_MOST = 400
_LEAST = 0.04  # of the reach: what stands no higher dims nothing that one would see
_TINY = 1e-9  # of the reach: rounding


class Occlusion(NamedTuple):
    """What is left of the light (0 to 1) on a grid over each face, and where the grids lie."""

    left: Array  # (n,) the grids, one after the other, row after row
    first: Indices  # (f,) where each one begins
    steps: Indices  # (2, f) along its rows and columns
    forms: Array  # (2, 4, f) (a, d): a point M lies in column a·M + d, and in a row alike

    @classmethod
    def seen_by(cls, camera: Camera, faces: Array, reach: float) -> "Occlusion":
        """Work out what rectangles (f, 4, 3) in the WRF hide, each on the side that is seen."""
        normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 3] - faces[:, 0])
        away = ((camera.centre - faces[:, 0]) * normals).sum(axis=-1) < 0
        left, first, steps, forms = _grids(faces.tobytes(), away.tobytes(), reach)
        return cls(left, first, steps, (forms @ np.linalg.inv(camera.G)).swapaxes(1, 2).copy())

    def along(self, face: npt.NDArray[np.int32], depth: Array, x: Array, y: Array) -> Array:
        """Return what is left of the light where rays (x, y, 1) end on faces; all (n,)."""
        steps = self.steps[:, face]
        a, b, c, d = np.moveaxis(self.forms[..., face], 1, 0)
        place = (depth * (a * x + b * y + c) + d).clip(0, steps)
        node = np.minimum(place.astype(np.intp), steps - 1)
        s, t = place - node
        width = steps[0] + 1
        start = self.first[face] + node[1] * width + node[0]
        above, below = (
            (1 - s) * self.left[k] + s * self.left[k + 1] for k in (start, start + width)
        )
        return np.asarray((1 - t) * above + t * below)


@lru_cache(maxsize=8)
def _grids(corners: bytes, turned: bytes, reach: float) -> tuple[Array, Indices, Indices, Array]:
    """Work out the grids, once for all cameras that see the same sides of the same faces."""
    faces = np.frombuffer(corners).reshape(-1, 4, 3)
    origin = faces[:, 0]
    sides = np.stack([faces[:, 1] - origin, faces[:, 3] - origin])
    squared = np.maximum((sides**2).sum(axis=-1), 1e-300)
    normals = np.cross(*sides) / np.sqrt(squared.prod(axis=0))[:, None]
    seen = np.where(np.frombuffer(turned, dtype=bool)[:, None], -normals, normals)
    # Normals of a box point inwards. If the whole scene is on that side, it is seen from within.
    heights = faces.reshape(-1, 3) @ normals.T - (origin * normals).sum(axis=-1)
    within = (heights >= -_TINY * reach).all(axis=0)
    free = np.where(within[:, None], normals, -normals)
    low, high = faces.min(axis=1), faces.max(axis=1)
    across = sides / squared[..., None]
    grids, steps = [], np.ones((2, len(faces)), dtype=np.intp)
    for f, normal in enumerate(seen):
        reaches = np.minimum(((faces - origin[f]) @ normal).max(axis=1), reach)
        gap = np.maximum(low - high[f], low[f] - high).max(axis=1)
        along = np.cross(normals, normal)  # where both planes meet, as long as the sine
        upright = (along**2).sum(axis=-1)
        width = np.ptp((faces @ along[..., None])[..., 0], axis=1)
        near = np.flatnonzero((gap < reaches) & (reaches > _LEAST * reach) & (upright > 0.1))
        if len(near):
            fine = reaches[near].min() / _STEPS
            steps[:, f] = np.ceil(np.sqrt(squared[:, f]) / fine).clip(1, _MOST)
        s, t = (np.linspace(0, 1, n + 1) for n in steps[:, f])
        hidden = np.zeros((len(t), len(s)))
        step = np.sqrt(squared[:, f] / steps[:, f] ** 2).max()  # the foot lies between two nodes
        for g in near:
            # 1. the part of the grid within reach
            middle = ((faces[g] - origin[f]) @ across[:, f].T).T
            far = reaches[g] / np.sqrt(squared[:, f])
            i, j = (
                slice(*np.searchsorted(x, [m.min() - r, m.max() + r]))
                for x, m, r in zip((s, t), middle, far, strict=True)
            )
            # 2. from the nearest point of the other face
            apart = (
                origin[f] + s[i, None] * sides[0, f] + t[j, None, None] * sides[1, f] - origin[g]
            )
            for side, length in zip(sides[:, g], squared[:, g], strict=True):
                apart = apart - (apart @ side / length).clip(0, 1)[..., None] * side
            distance = np.sqrt((apart**2).sum(axis=-1))
            # 3. nothing behind it; round a corner two faces hide what one does: cos² + sin² = 1
            facing = (apart @ free[g] + step).clip(0) / (distance + step)
            weight = upright[g] * facing**2 * width[g] / (width[g] + distance)
            hidden[j, i] += weight * (1 - distance / reaches[g]).clip(0) ** 2
        grids.append(1 / (1 + _HIDDEN / (1 - _HIDDEN) * hidden.ravel()))
    first = np.cumsum([0] + [len(grid) for grid in grids[:-1]])
    columns = steps[..., None] * across
    forms = np.dstack([columns, -(columns * origin).sum(axis=-1)])
    return np.concatenate(grids), first, steps, forms
