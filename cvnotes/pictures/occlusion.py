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
from cvnotes.pictures.antialiasing import Mask

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
    dimmed: Mask  # (f,) whether anything hides a part of it
    forms: Array  # (2, 4, f) (a, d): a point M lies in column a·M + d, and in a row alike

    @classmethod
    def seen_by(cls, camera: Camera, faces: Array, reach: float) -> "Occlusion":
        """Work out what rectangles (f, 4, 3) in the WRF hide, each on the side that is seen."""
        normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 3] - faces[:, 0])
        away = ((camera.centre - faces[:, 0]) * normals).sum(axis=-1) < 0
        left, first, steps, dimmed, forms = _grids(faces.tobytes(), away.tobytes(), reach)
        in_crf = (forms @ np.linalg.inv(camera.G)).swapaxes(1, 2).copy()
        return cls(left, first, steps, dimmed, in_crf)

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
def _grids(
    corners: bytes, turned: bytes, reach: float
) -> tuple[Array, Indices, Indices, Mask, Array]:
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
    axes = np.stack([*across, free], axis=-1)  # (f, 3, 3): along both sides, and upright
    grids, steps = [], np.ones((2, len(faces)), dtype=np.intp)
    for f, normal in enumerate(seen):
        reaches = np.minimum(((faces - origin[f]) @ normal).max(axis=1), reach)
        gap = np.maximum(low - high[f], low[f] - high).max(axis=1)
        along = np.cross(normals, normal)  # where both planes meet, as long as the sine
        upright = (along**2).sum(axis=-1)
        width = np.ptp((faces @ along[..., None])[..., 0], axis=1)
        near = np.flatnonzero((gap < reaches) & (reaches > _LEAST * reach) & (upright > 0.1))
        lengths = np.sqrt(squared[:, f])
        if len(near):
            fine = reaches[near].min() / _STEPS
            steps[:, f] = np.ceil(lengths / fine).clip(1, _MOST)
        s, t = (np.linspace(0, 1, n + 1) for n in steps[:, f])
        hidden = np.zeros((len(t), len(s)))
        step = (lengths / steps[:, f]).max()  # the foot lies between two nodes
        # 1. the parts of the grid within reach
        shown = (faces[near] - origin[f]) @ axes[f, :, :2]
        far = reaches[near, None] / lengths
        ends = np.stack([shown.min(axis=1) - far, shown.max(axis=1) + far], axis=-1)
        columns, rows = (np.searchsorted(x, ends[:, k]) for k, x in enumerate((s, t)))
        # 2. where they lie for the other faces, each a rectangle
        away = origin[f] - origin[near]
        first_node, by_s, by_t = (
            (m[:, None] @ axes[near])[:, 0]
            for m in (away, *np.broadcast_to(sides[:, f, None], (2, *away.shape)))
        )
        for k, g in enumerate(near):
            i, j = slice(*columns[k]), slice(*rows[k])
            x, y, height = (
                start + s[i] * right + t[j, None] * down
                for start, right, down in zip(first_node[k], by_s[k], by_t[k], strict=True)
            )
            x, y = x - x.clip(0, 1), y - y.clip(0, 1)  # beyond the other face's edges
            distance = np.sqrt(x * x * squared[0, g] + y * y * squared[1, g] + height * height)
            # 3. nothing behind it; round a corner two faces hide what one does: cos² + sin² = 1
            facing = (height + step).clip(0) / (distance + step)
            weight = upright[g] * facing**2 * width[g] / (width[g] + distance)
            hidden[j, i] += weight * (1 - distance / reaches[g]).clip(0) ** 2
        grids.append(1 / (1 + _HIDDEN / (1 - _HIDDEN) * hidden.ravel()))
    first = np.cumsum([0] + [len(grid) for grid in grids[:-1]])
    columns = steps[..., None] * across
    forms = np.dstack([columns, -(columns * origin).sum(axis=-1)])
    dimmed = np.array([grid.min() < 1 for grid in grids])
    return np.concatenate(grids), first, steps, dimmed, forms
