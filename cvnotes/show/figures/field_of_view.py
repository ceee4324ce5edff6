"""The figure of the field of view: what cameras see of a room from one spot."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.camera import Camera
from cvnotes.camera.model import is_camera
from cvnotes.pictures import render_scene, room
from cvnotes.pictures.meshes import from_above
from cvnotes.show.axes import beside, halo, panels
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, LENS, MUTED, WORLD

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_OWN = (CAMERA, LENS, IDEAL, WORLD, ESTIMATED)
_WALL, _BACK = 10_000, 400  # mm, from the camera to the room's far wall, and what is behind it


def draw_field_of_view(cameras: Mapping[str, Camera]) -> "Axes":
    """Draw the course's room from above, what each camera sees of it, and the pictures below.

    Parameters
    ----------
    cameras : mapping from names to Camera
        Up to five. They stand in the origin of `room`, and look along its z axis; of the pictures,
        the middle rows are shown. Lenses are left out.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> ax = draw_field_of_view({"wide": Camera(intrinsics(320, 320, 319.5, 240))})
    >>> [text.get_text() for text in ax.texts]
    ['wide: 90.0°']
    """
    from matplotlib.patches import Rectangle

    if not isinstance(cameras, Mapping) or not 1 <= len(cameras) <= len(_OWN):
        raise CvnotesError(f"cameras: expected one to {len(_OWN)} by name")
    ax: Axes = panels(height=500)
    walls = Rectangle((-_BACK, -3000), _WALL + _BACK, 6000, fc="white", ec=MUTED, lw=3)
    ax.add_patch(walls)
    for corners, colour in zip(*from_above(room(), -1500), strict=True):
        ax.fill(*corners.T[::-1], fc=colour, zorder=2)[0].set_clip_path(walls)
    ax.plot([9960, 9960], [-600, 600], color="#3A6A66", lw=3, solid_capstyle="butt")  # blackboard
    across = (_WALL + _BACK) / len(cameras)
    for i, ((name, camera), own) in enumerate(zip(cameras.items(), _OWN, strict=False)):
        (left, right), (w, h) = _sides(is_camera(camera, "camera")), camera.size
        sides = _WALL * np.array([[1, left], [0, 0], [1, right]])
        ax.fill(*sides.T, fc=own, alpha=0.16)[0].set_clip_path(walls)
        ax.plot(*sides.T, color=own, lw=1.6, zorder=3)[0].set_clip_path(walls)
        arc, reach = np.linspace(np.arctan(left), np.arctan(right), 50), 1500 + 2100 * i
        ax.plot(reach * np.cos(arc), reach * np.sin(arc), color=own, lw=2)
        words = f"{name}: {np.degrees(np.ptp(arc)):.1f}°"
        beside(ax, words, (reach, 0), (8, 0), own, va="center", path_effects=halo())
        rows = Camera(camera.A, size=(w, h)).cropped((0, h // 4), (w, h // 2))
        x0, x1 = -_BACK + across * i + 60, -_BACK + across * (i + 1) - 60
        span = (x0, x1, 3300 + (x1 - x0) * (h // 2) / w, 3300)
        ax.imshow(render_scene(room(), rows), extent=span)
        ax.add_patch(Rectangle((x0, 3300), x1 - x0, span[2] - 3300, fc="none", ec=own, lw=2))
    ax.plot(0, 0, ">", color=CAMERA, ms=11)
    ax.set(xlim=(-_BACK - 100, _WALL + 100), ylim=(span[2] + 100, -3100), aspect="equal")
    ax.axis("off")
    return ax


def _sides(camera: Camera) -> Array:
    """Return x / z at the left and the right border of a picture, in the row of its (u0, v0)."""
    borders = [[-0.5, camera.A[1, 2]], [camera.size[0] - 0.5, camera.A[1, 2]]]
    return np.asarray(camera.ideal(borders)[:, 0])
