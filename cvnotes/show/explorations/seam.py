"""Explore a turn on the spot: a second photograph is laid over the first, and α closes the seam.

With a step aside no α closes it: what is near moves farther than what is far.
"""

from functools import cache, lru_cache

import numpy as np
import numpy.typing as npt
from PIL import Image

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, pose, rotation_from_vector
from cvnotes.pictures import Scene, radiance, room
from cvnotes.pictures.meshes import box, join
from cvnotes.projective import apply
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, nearest
from cvnotes.show.explorations.paper import Drawn, Paper, Range
from cvnotes.show.style import ESTIMATED, LENS, MUTED

Seen = tuple[Drawn, npt.NDArray[np.bool_]]  # colours, and where there are any

ALPHA, SIZE, MIDDLE = 500, (640, 480), (319.5, 239.5)
TURN = rotation_from_vector([0.1, -0.35, 0.05])  # second camera ← first
_LOWEST, _HIGHEST, _STEP = 200, 1200, 5
_FARTHEST, _STRIDE = 400, 200  # mm aside
_SHEET, _LOUPE, _CURVE = (480, 309), (216, 150), (216, 131)  # px of the panels
_SHOWN, _CLOSE = ((-40, 1160), (-170, 602.5)), ((300, 444), (225, 325))  # their u and v
_COARSE, _HIGHEST_OFF = (160, 103), 62  # px of a sheet for the curve; grey levels, its top
_BORDER = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]) * SIZE - 0.5
_TRIED = (*range(_LOWEST, 440, 20), *range(440, 560, 5), *range(560, _HIGHEST + 1, 20))
_FINE = 2  # so many times photographs are enlarged, smoothly, before pixels are looked up


def homography_of(alpha: float) -> Array:
    """Return H (3, 3), second picture ← first, of a camera with this α that turns by `TURN`."""
    A = intrinsics(alpha, alpha, *MIDDLE)
    return np.asarray(A @ TURN @ np.linalg.inv(A))


def seam_model() -> Model:
    """Make the model of two photographs of a room, between which the camera has only turned."""
    settings = (
        Setting("alpha", "α (px)", _LOWEST, _HIGHEST, _STEP, 300, "of the camera that is assumed"),
        Setting("aside", "step aside (mm)", 0, _FARTHEST, _STRIDE, 0,
                "how far to the right the camera stepped between the photographs"),
    )  # fmt: skip
    about = """Two photographs of a room by a camera that has turned to the right, and perhaps
    stepped aside; a green post stands near. The second is laid over the first as a camera with the
    chosen focal length would have it; beside it a part of both, enlarged, and by how much they
    differ, against the focal length."""
    tried = np.arange(_LOWEST, _HIGHEST + 1.0, _STEP)
    drags = {"middle": nearest("alpha", tried, lambda _, tried: np.array([*map(_place, tried)]))}
    return Model("seam", about, settings, _draw, drags)


def scene() -> Scene:
    """Return the room, and near in it a green post."""
    return join(room(), box((480, 580), (70, 1600), (3000, 3100), (0.30, 0.62, 0.36)))


def _place(alpha: float) -> Array:
    """Return where the middle of the second photograph comes to lie on the first."""
    return apply(np.linalg.inv(homography_of(alpha)), MIDDLE)


def _draw(paper: Paper, values: Values) -> Drawing:
    alpha, aside, k = values["alpha"], values["aside"], paper.sharpness
    over = paper.panel(_SHEET, *_SHOWN, "the second photograph over the first: pull its middle")
    close = paper.panel(_LOUPE, *_CLOSE, "enlarged")
    border = apply(np.linalg.inv(homography_of(alpha)), _BORDER)
    for panel, (w, h), shown in ((over, _SHEET, _SHOWN), (close, _LOUPE, _CLOSE)):
        panel.image(_laid_over(alpha, aside, (k * w, k * h), shown)[0])
        panel.line(_BORDER, LENS, 1.5)
        panel.line(border, ESTIMATED, 1.5)
    over.mark(_place(alpha), "estimated", 7)
    over.grip("middle", "the middle of the second photograph", _place(alpha), _STEP / 2)
    apart = _apart(alpha, aside)
    curve = paper.panel(_CURVE, (50, 1250), (_HIGHEST_OFF, -14), "how far they differ, against α")
    curve.ticks(x=(500, 1000), y=(20, 40))
    curve.line([[50, 0], [1250, 0]], MUTED, 0.8)
    curve.line([(tried, _apart(tried, aside)) for tried in _TRIED], ESTIMATED, 1.5)
    curve.mark([alpha, apart], "estimated", 7)
    sentence = f"""With α = {alpha:.0f} px the two photographs differ, where one lies over the
    other, by {apart:.1f} grey levels on average."""
    return Drawing(paper.join((over, [close, curve])), sentence)


@cache
def _apart(alpha: float, aside: float) -> float:
    """Return by how many grey levels the photographs differ where one lies over the other."""
    return _laid_over(alpha, aside, _COARSE, _SHOWN)[1]


@cache
def _photograph(number: int, aside: float) -> Drawn:
    """Take the first photograph, or the second one from so many mm to the right of the first."""
    turn = TURN if number else np.eye(3)
    camera = Camera(intrinsics(ALPHA, ALPHA, *MIDDLE), size=SIZE)
    light = radiance(scene(), camera.moved(pose(turn, -turn @ [aside, 0, 0])))
    photo = Image.fromarray(light.clip(0, 255).astype(np.uint8))
    return np.asarray(photo.resize((_FINE * SIZE[0], _FINE * SIZE[1])))


@lru_cache(maxsize=6)  # both photographs on three sheets
def _seen(
    number: int, alpha: float, aside: float, size: tuple[int, int], shown: tuple[Range, Range]
) -> Seen:
    """Return what a photograph shows at each place of a sheet."""
    u, v = (np.linspace(*ends, 2 * n + 1)[1::2] for ends, n in zip(shown, size, strict=True))
    H = homography_of(alpha) if number else np.eye(3)
    x, y, w = (a * u + b * v[:, None] + c for a, b, c in H)
    photo = _photograph(number, aside)
    column, line = (np.rint(_FINE * (at / w + 0.5) - 0.5).astype(int) for at in (x, y))
    inside = (column >= 0) & (line >= 0) & (column < photo.shape[1]) & (line < photo.shape[0])
    return photo[line * inside, column * inside], inside & (w > 0)


def _laid_over(
    alpha: float, aside: float, size: tuple[int, int], shown: tuple[Range, Range]
) -> tuple[Drawn, float]:
    """Lay the second photograph over the first; returns also by how many grey levels they differ.

    Where both are, each pixel is their mean.
    """
    first, in_first = _seen(0, 0.0, 0.0, size, shown)
    second, in_second = _seen(1, alpha, aside, size, shown)
    sheet = np.where(in_first[..., None], first, np.uint8(255))
    sheet[in_second] = second[in_second]
    both = in_first & in_second
    one, other = first[both].astype(np.int16), second[both].astype(np.int16)
    sheet[both] = (one + other) // 2
    return sheet, float(np.abs(one - other).mean())
