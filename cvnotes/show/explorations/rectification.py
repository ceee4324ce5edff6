"""Explore rectification: two cameras turn on the spot until their pictures share their rows."""

from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera, pose, rotation_from_vector, vector_from_rotation
from cvnotes.pictures import depth_map, room
from cvnotes.show.explorations.epipolar import cameras, photographs
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Paper
from cvnotes.show.style import ESTIMATED, IDEAL
from cvnotes.stereo import epipole
from cvnotes.warping import backward_warp, homography_map

_SHOWN = 400, 300  # px
_ROWS = range(30, 480, 60)  # of the first picture, at its middle: where lines are begun
_APART = 200.0  # px between two points of a row that any turned camera sees
_UNSEEN = 110
_INFINITE = 1e9  # px


def rectification_model() -> Model:
    """Make the model of the two cameras of chapter 10, which turn."""
    settings = (
        Setting("turned", "turned (%)", 0, 100, 1, 0, "how far to the attitude that both share"),
        Setting("u", "u (px)", 60, 620, 1, 449, "a pixel of the first picture as it was taken"),
        Setting("v", "v (px)", 30, 450, 1, 205, "and its row"),
        Setting("slid", "first slid over (%)", 0, 100, 1, 15, "how much of the second it covers"),
    )
    about = """Two pictures of a room, and epipolar lines that belong together. The cameras turn on
    the spot until all these lines are rows that both pictures share. The first picture is slid over
    the second: then no line breaks at the seam."""

    def pulled(values: Values, at: Array) -> Values:
        old, new = cameras()[0], turned(values["turned"] / 100)[0]
        return dict(zip("uv", old.project(old.centre + new.ray(at)), strict=True))

    drags = {"pixel": pulled, "seam": lambda _, at: {"slid": at[0] / 6.4}}
    return Model("rectification", about, settings, _draw, drags)


def turned(part: float) -> tuple[Camera, Camera]:
    """Return both cameras after a part of their turns, on the spot, to the attitude they share."""
    first, second = cameras()
    e1 = second.centre - first.centre
    e2 = np.cross(first.R[2] + second.R[2], e1)
    R = np.array([x / np.linalg.norm(x) for x in (e1, e2, np.cross(e1, e2))])
    ways = (part * vector_from_rotation(R @ camera.R.T) for camera in (first, second))
    both = zip((first, second), ways, strict=True)
    one, other = (_attitude(camera, rotation_from_vector(way) @ camera.R) for camera, way in both)
    return one, other


def _attitude(camera: Camera, R: Array) -> Camera:
    """Turn a camera on the spot."""
    return camera.moved(pose(R, -R @ camera.centre))


@lru_cache(maxsize=1)
def _depths() -> Array:
    return depth_map(room(), cameras()[0])


def _draw(paper: Paper, values: Values) -> Drawing:
    m = np.array([values["u"], values["v"]])
    first, _ = cameras()
    M = first.ideal(m)
    W = _depths()[int(m[1]), int(m[0])] * np.array([*M, 1])  # the first camera's frame is the WRF
    now, whole = turned(values["turned"] / 100), turned(1)
    through = first.centre + first.ray([[first.A[0, 2], v] for v in _ROWS])
    rows = whole[0].project(through)[:, 1]
    row = whole[0].project(W)[1]
    m = np.array([camera.project(W) for camera in now])
    seam = round(6.4 * values["slid"])
    photos = [*map(_seen, cameras(), now, photographs())]
    photos[1] = np.hstack([photos[0][:, :seam], photos[1][:, seam:]])
    names = "the first camera", "the second camera: pull the seam"
    panels = [paper.picture_panel(_SHOWN, first.size, name) for name in names]
    for k, panel in enumerate(panels):
        panel.image(photos[k])
        for v, width in (*((v, 1) for v in rows), (row, 2)):
            lines = [_line(new, end, v) for new, end in zip(now, whole, strict=True)]
            parts = [_until(lines[0], seam), _until(lines[1], seam, after=True)] if k else lines[:1]
            for part in parts:
                panel.line(part, ESTIMATED, width, rim=0.7)
        panel.line([[-9, m[0, 1]], [first.size[0] + 9, m[0, 1]]], IDEAL, 1, dash=5)
    left, right = panels
    left.grip("pixel", "a pixel of the first picture", m[0], 4, "ideal", 8)
    right.text([626, m[0, 1] + 9], "row of the plus", IDEAL, anchor="ra", size=12, rim="white")
    if m[1, 0] > seam:
        right.mark(m[1], "ideal", 8)
        side = -1 if m[1, 0] > seam + 130 else 1  # its name has room there
        anchor = "rd" if side < 0 else "ld"
        right.text(m[1] + [14 * side, -10], "partner", IDEAL, anchor=anchor, size=12, rim="white")
    right.line([[seam, -9], [seam, 490]], "#FFFFFF", 2)
    right.grip("seam", "the seam between both pictures", [seam, 440], 6)
    return Drawing(paper.join((left, right)), _sentence(now, m))


def _seen(old: Camera, new: Camera, photo: npt.NDArray[Any]) -> Drawn:
    """Return what a camera shows after its turn of what it took before."""
    H = old.A @ old.R @ new.R.T @ np.linalg.inv(new.A)  # pixel as taken from pixel as turned
    photo = photo.clip(0, 255).astype(np.uint8)
    return np.asarray(backward_warp(photo, homography_map(H), fill=_UNSEEN), np.uint8)


def _until(line: Array, u: float, after: bool = False) -> Array:
    """Return the part of a line (2, 2) to the left of a column, or to its right."""
    a, b = line[line[:, 0].argsort()]
    cut = a + (b - a) * (u - a[0]) / (b[0] - a[0])
    return np.array([cut, b] if after else [a, cut])


def _line(new: Camera, end: Camera, v: float) -> Array:
    """Return where a turned camera shows what its picture has in row v after the whole turn."""
    middle = end.A[0, 2]
    m = new.project(new.centre + end.ray([[middle - _APART, v], [middle + _APART, v]]))
    return np.asarray(m + 9 * np.array([[-1], [1]]) * (m[1] - m[0]))


def _sentence(now: tuple[Camera, Camera], m: Array) -> str:
    own, partner = m[:, 1]
    said = f"The pixel stands in row {own:.1f}, its partner in row {partner:.1f}"
    (u1, v1, w), (u2, v2, _) = epipole(*now), epipole(*now[::-1])
    if abs(u1) > _INFINITE * abs(w):
        return f"{said}: both share their rows, and both epipoles lie at infinity."
    apart = f"{abs(partner - own):.1f} px {'lower' if partner > own else 'higher'}"
    return f"""{said}, {"the same row" if round(abs(partner - own), 1) == 0 else apart}. The
    epipoles lie at ({u1:.0f}, {v1:.0f}) and ({u2:.0f}, {v2:.0f})."""
