"""What a ray sees of a scene: the colour in its light, the checker's square, haze and sky."""

from typing import NamedTuple

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, move
from cvnotes.pictures.antialiasing import Mask
from cvnotes.pictures.meshes import Scene, Surroundings
from cvnotes.pictures.raycast import Indices, depth_along, edge_functions, search


class Surfaces(NamedTuple):
    """A scene in a camera's frame, with the light already on it."""

    corners: Array  # (m, 3, 3) in the CRF
    forms: Array  # (9, m): coefficients of u w, v w and w along a ray (x, y, 1)
    checkered: Mask  # (m,)
    palette: Array  # (3, 2 m): both colours of each triangle
    extent: Array  # (2, m)
    around: Surroundings
    down: Array  # (3,) the world's y axis in the CRF

    @classmethod
    def seen_by(cls, camera: Camera, scene: Scene) -> "Surfaces":
        """Carry a scene into a camera's frame, and shade it."""
        corners = move(camera.G, scene.vertices)[scene.triangles]
        n, _ = edge_functions(corners)
        # The barycentric weights are e_i / Σ e_i; u and v are mixed by them.
        uv1 = np.concatenate([scene.uv, np.ones_like(scene.uv[..., :1])], axis=-1)
        forms = (uv1.swapaxes(1, 2) @ n).reshape(-1, 9).T.copy()
        colours = scene.colours * _shade(scene, camera)[:, None, None]
        return cls(
            corners,
            forms,
            (scene.colours[:, 0] != scene.colours[:, 1]).any(axis=1),
            colours.reshape(-1, 3).T.copy(),
            scene.extent.T.copy(),
            scene.around,
            camera.R[:, 1],
        )

    def colours_along(self, xy: Array) -> tuple[Array, Array]:
        """Return the colours (3, groups, k) that rays (groups, k, 2) see, and squares (2, …)."""
        triangle = search(self.corners, xy)
        x, y = np.moveaxis(xy, -1, 0).copy()
        none = triangle < 0
        square = self._squares(triangle, x, y)
        odd = square.sum(axis=0).astype(np.intp) & 1
        colour = np.take(self.palette, np.where(none, 0, 2 * triangle + odd), axis=1)
        if np.isfinite(self.around.haze):
            depth = depth_along(self.corners, triangle, xy)
            clear = np.exp(-depth * np.sqrt(1 + x * x + y * y) / self.around.haze)
            horizon = np.array(self.around.horizon)[:, None, None]
            colour = horizon + clear * (colour - horizon)
        colour[:, none] = self._sky(x[none], y[none])
        return colour, square

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


def _shade(scene: Scene, camera: Camera) -> Array:
    """Return the brightness (m,) of the side of each triangle that the camera sees.

    Lambert's cosine law, softened: it falls to the ambient light only on the far side.
    """
    light, ambient = np.array(scene.around.light), scene.around.ambient
    towards = np.einsum("ij,ij->i", camera.centre - scene.corners[:, 0], scene.normals)
    cosine = scene.normals @ (light / np.linalg.norm(light)) * np.where(towards < 0, -1, 1)
    return np.asarray(ambient + (1 - ambient) * (1 + cosine) / 2)
