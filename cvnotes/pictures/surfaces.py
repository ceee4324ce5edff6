"""What a ray sees of a scene: the colour in light or shadow, the checker's square, haze and sky.

What the light sees is lit: it is one more camera, so far away that its rays are nearly parallel.
"""

from typing import NamedTuple

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, look_at, move
from cvnotes.pictures.antialiasing import Mask
from cvnotes.pictures.meshes import Scene, Surroundings
from cvnotes.pictures.occlusion import Occlusion
from cvnotes.pictures.raycast import Indices, edge_functions, search

_FAR = 100  # how far away the light is, in sizes of what casts shadows
_HIDDEN = 5  # times as far as the haze, less than a hundredth of a colour is left
_TOUCHING = 1e-10  # of that distance: what is no farther apart throws no shadow


class Surfaces(NamedTuple):
    """A scene in a camera's frame, with the light already on it."""

    corners: Array  # (m, 3, 3) in the CRF
    forms: Array  # (9, m): coefficients of u w, v w and w along a ray (x, y, 1)
    checkered: Mask  # (m,)
    palette: Array  # (3, 4 m): both colours of each triangle in the light, then in a shadow
    bright: Mask  # (m,) the side that the camera sees is turned towards the light
    light: Array  # (4, 4) CRF → the light's frame
    shading: Array  # (k, 3, 3) the triangles that cast shadows, in the light's frame
    extent: Array  # (2, m)
    occlusion: Occlusion | None
    around: Surroundings
    down: Array  # (3,) the world's y axis in the CRF

    @classmethod
    def seen_by(cls, camera: Camera, scene: Scene) -> "Surfaces":
        """Carry a scene into a camera's frame, and shade it.

        Those faces of a body cast its shadow that look away from the light. So no lit face can
        stand in its own, and a room is lit from without through the walls that one looks through.
        """
        corners = move(camera.G, scene.vertices)[scene.triangles]
        n, _ = edge_functions(corners)
        # The barycentric weights are e_i / Σ e_i; u and v are mixed by them.
        uv1 = np.concatenate([scene.uv, np.ones_like(scene.uv[..., :1])], axis=-1)
        forms = (uv1.swapaxes(1, 2) @ n).reshape(-1, 9).T.copy()
        light = np.array(scene.around.light) / np.linalg.norm(scene.around.light)
        towards = np.einsum("ij,ij->i", camera.centre - scene.corners[:, 0], scene.normals)
        cosine = scene.normals @ light * np.where(towards < 0, -1, 1)
        shade = [_shade(c, scene.around.ambient) for c in (cosine, -np.abs(cosine))]
        colours = np.array(shade)[..., None, None] * scene.colours
        casting = scene.corners[scene.normals @ light > 0]
        from_light = _seen_from(light, _near(casting, camera.centre, scene.around.haze))
        reach = scene.around.occlusion
        return cls(
            corners,
            forms,
            (scene.colours[:, 0] != scene.colours[:, 1]).any(axis=1),
            colours.reshape(-1, 3).T.copy(),
            cosine > 0,
            from_light @ np.linalg.inv(camera.G),
            move(from_light, casting),
            scene.extent.T.copy(),
            Occlusion.seen_by(camera, scene.faces, reach) if reach else None,
            scene.around,
            camera.R[:, 1],
        )

    def colours_along(self, xy: Array) -> tuple[Array, Array, Array]:
        """Return the colours (3, groups, k) that rays (groups, k, 2) see, how dimmed, and where.

        Dimmed by occlusion, to a part (groups, k) of them; where (3, groups, k) is the square
        (i, j) of the checker, and whether it is in a shadow.
        """
        triangle, depth = search(self.corners, xy)
        x, y = np.moveaxis(xy, -1, 0).copy()
        none = triangle < 0
        square = self._squares(triangle, x, y)
        dark = self._in_shadow(triangle, depth, xy)
        odd = square.sum(axis=0).astype(np.intp) & 1
        which = 2 * (triangle + len(self.corners) * dark) + odd
        colour = np.take(self.palette, np.where(none, 0, which), axis=1)
        if np.isfinite(self.around.haze):
            clear = np.exp(-depth * np.sqrt(1 + x * x + y * y) / self.around.haze)
            horizon = np.array(self.around.horizon)[:, None, None]
            colour = horizon + clear * (colour - horizon)
        colour[:, none] = self._sky(x[none], y[none])
        left = np.ones(triangle.shape)
        if self.occlusion:
            on = np.append(self.occlusion.dimmed.repeat(2), False)[triangle]
            left[on] = self.occlusion.along(triangle[on] // 2, depth[on], x[on], y[on])
        return colour, left, np.stack([*square, dark])

    def _in_shadow(self, triangle: Indices, depth: Array, xy: Array) -> Mask:
        """Return where rays (groups, k, 2) end in a shadow: the light sees something else first."""
        asked = (triangle >= 0) & self.bright[triangle]
        if not len(self.shading):  # then the light has no frame, in which depths could be 0
            return np.zeros_like(asked)
        M = np.where(asked, depth, np.nan)[..., None] * np.dstack([xy, np.ones(xy.shape[:2])])
        M = M @ self.light[:3, :3].T + self.light[:3, 3]
        along = M[..., :2] / M[..., 2:]
        first = search(self.shading, along)
        return np.asarray(first.depth < (1 - _TOUCHING) * M[..., 2])

    def _squares(self, triangle: Indices, x: Array, y: Array) -> Array:
        """Return the square (i, j) of the checker, as (2, …): (0, 0) where there is none.

        Around the checker it is (−1, 0), which is odd: the second colour.
        """
        square = np.zeros((2, *x.shape))
        on = np.flatnonzero((triangle >= 0) & self.checkered[triangle])
        t, x, y = triangle.ravel()[on], x.ravel()[on], y.ravel()[on]
        f = np.take(self.forms, t, axis=1)
        w = f[6] * x + f[7] * y + f[8]
        u, v = (f[0] * x + f[1] * y + f[2]) / w, (f[3] * x + f[4] * y + f[5]) / w
        columns, rows = np.take(self.extent, t, axis=1)
        around = ((u < 0) | (u >= columns)) & np.isfinite(columns)
        around |= ((v < 0) | (v >= rows)) & np.isfinite(rows)
        square.reshape(2, -1)[:, on] = np.where(around, [[-1], [0]], np.floor([u, v]))
        return square

    def _sky(self, x: Array, y: Array) -> Array:
        """Return the background (3, n) along rays: from the horizon up to the zenith."""
        down = x * self.down[0] + y * self.down[1] + self.down[2]
        height = np.clip(-down / np.sqrt(1 + x * x + y * y), 0, 1)
        horizon, zenith = (np.array(c)[:, None] for c in (self.around.horizon, self.around.zenith))
        # Beyond the lens's validity there is no ray, and no light.
        return np.where(np.isnan(x), 0, (1 - height) * horizon + height * zenith)


def _shade(cosine: Array, ambient: float) -> Array:
    """Return how bright faces are by the cosine of their angle to the light, in 0 to 1.

    Lambert's law, softened: it falls to the ambient light only on the far side. A face in a
    shadow is as bright as one that is turned as far away from the light.
    """
    return ambient + (1 - ambient) * (1 + cosine) / 2


def _near(casting: Array, centre: Array, haze: float) -> Array:
    """Cut triangles off where haze hides them from the camera.

    A plain goes on; a light that is far from all of it would lose the digits that tell a shadow
    from what throws it.
    """
    low, high = centre - _HIDDEN * haze, centre + _HIDDEN * haze
    seen = ((casting.min(axis=1) < high) & (casting.max(axis=1) > low)).all(axis=1)
    return casting[seen].clip(low, high) if seen.any() else casting


def _seen_from(light: Array, casting: Array) -> Array:
    """Return the motion (4, 4) from the WRF into the frame of a light in that direction."""
    if not len(casting):
        return np.eye(4)
    low, high = casting.min(axis=(0, 1)), casting.max(axis=(0, 1))
    middle = (low + high) / 2
    up = np.eye(3)[np.abs(light).argmin()]  # any that is not along it
    return look_at(middle + _FAR * np.linalg.norm(high - low) * light, middle, up)
