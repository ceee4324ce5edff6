"""Explore twelve folds: half circles that meet only if the lens is undone and boards turn."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.calibration import constraints, intrinsics_from_b, solve_b
from cvnotes.camera import Lens, px_from_xy, rotation_from_vector, vector_from_rotation, xy_from_px
from cvnotes.homography import dlt
from cvnotes.pictures import course
from cvnotes.show.explorations.boards import draw_squares
from cvnotes.show.explorations.fold import Circle, behind_sheet, circle_of, on_sheet
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED, mixed

_Of = tuple[float, float]  # k1, and how far the boards are turned

_SPACE, _CLOSE, _CURVE = (508, 421), (340, 262), (340, 131)
_SHOWN = ((-2150, 2725), (-2480, 1556))  # x and y of the sheet: all half circles, for each k1
_LOWEST, _HIGHEST, _STEP = -0.4, 0.1, 0.005
_NEAR = 100.0  # px about the camera, that are shown enlarged
_MOST = 90.0  # px, of the curve
_DEEP = 4000  # px from the palest half circles to the strongest, with the camera between
_FAR, _TONES = "#B0CEE4", 8  # the palest blue; how many there are
_FADES = 5  # steps in which a half circle fades out, where it leaves what is shown enlarged


class _Tangle:
    """The half circles of the course's photographs, with as much lens undone as k1 says."""

    def __init__(self) -> None:
        camera = course.camera()
        self.A, self.size = camera.A, camera.size
        self.camera, self.poses, self.board = camera, course.poses(), course.board()
        self.noise = course.measured_corners() - self._exact(self.poses)
        # One slider for both coefficients: it passes the course's lens.
        k1, k2 = camera.lens.k[:2]
        self.bend = k2 / k1**2
        self.W = self.board.points[:, :2]
        # Rows are stretched until pixels are square, as the geometry of the fold asks.
        self.square = np.array([1, self.A[0, 0] / self.A[1, 1]])
        self.eye = np.array([*(self.A[:2, 2] * self.square), self.A[0, 0]])
        self.circles = lru_cache(maxsize=None)(self._circles)
        self.found = lru_cache(maxsize=None)(self._found)
        self.seen = lru_cache(maxsize=None)(self._seen)

    def _exact(self, poses: Array) -> Array:
        return np.array([self.camera.moved(G).project(self.board.points) for G in poses])

    def _seen(self, turned: float) -> Array:
        """Return the corners (12, 54, 2), each board turned from the first by a part of its own."""
        first, poses = self.poses[0, :3, :3], self.poses.copy()
        middle = self.board.points.mean(axis=0)
        places = poses[:, :3, :3] @ middle + poses[:, :3, 3]
        away = turned * vector_from_rotation(first.T @ poses[:, :3, :3])
        poses[:, :3, :3] = first @ rotation_from_vector(away)
        poses[:, :3, 3] = places - poses[:, :3, :3] @ middle
        return self._exact(poses) + self.noise

    def _homographies(self, k1: float, turned: float) -> Array:
        lens = Lens(k=(k1, self.bend * k1**2))
        ideal = px_from_xy(self.A, lens.undistort(xy_from_px(self.A, self.seen(turned))))
        return dlt(self.W, ideal * self.square)

    def _circles(self, k1: float, turned: float) -> list[Circle]:
        return [circle_of(H) for H in self._homographies(k1, turned)]

    def _found(self, k1: float, turned: float) -> Array:
        """Return (u0, v0, α) that Zhang's equations find, in stretched rows; NaN if none."""
        try:
            A = intrinsics_from_b(solve_b(constraints(self._homographies(k1, turned))))
        except CvnotesError:
            return np.full(3, np.nan)
        return np.array([*A[:2, 2], A[0, 0]])

    def misses(self, k1: float, turned: float) -> Array:
        """Return how far each half circle passes beside the camera's true centre, in px."""
        return np.array([circle.distance(self.eye) for circle in self.circles(k1, turned)])


def folds_model() -> Model:
    """Make the model of the half circles of twelve photographs, whose lens is undone by k1."""
    tangle = _Tangle()
    settings = (
        Setting("k1", "k₁", _LOWEST, _HIGHEST, _STEP, 0,
                f"of the lens that is undone; k₂ = {tangle.bend:.1f} k₁²"),
        Setting("turned", "boards turned", 0, 1, 0.05, 1,
                "1: as they were photographed; 0: all parallel to the first"),
    )  # fmt: skip
    about = """Twelve half circles, one for each photograph: all places from which it shows right
    angles. Beside them what lies near the camera, enlarged, and how far they miss it, against
    k₁."""

    def draw(paper: Paper, values: Values) -> Drawing:
        of = values["k1"], values["turned"]
        beside = [_close(tangle, paper, of), _curve(tangle, paper, of)]
        panels = _space(tangle, paper, of), beside
        found = tangle.found(*of) / [*tangle.square, 1]
        return Drawing(paper.join(panels), _sentence(of, tangle.misses(*of), found))

    return Model("folds", about, settings, draw, {"k1": placed("k1")})


def _sentence(of: _Of, misses: Array, found: Array) -> str:
    k1, turned = of
    k = f"{k1:.3f}"
    said = f"With k₁ = {k} undone, the twelve half circles pass the camera at "
    if misses.max() >= 1:
        said += f"{misses.min():.0f} to {misses.max():.0f} px: no eye sees all right angles."
    elif turned:
        said += f"{misses.max():.1f} px at most: they meet, and where they do is the camera."
    else:
        said += f"{misses.max():.1f} px at most, but they are one: each of its places would do."
    if np.isnan(found).any():
        return f"{said} The equations determine no camera."
    u0, v0, alpha = found
    return f"{said} The equations find ({u0:.0f}, {v0:.0f}) and α = {alpha:.0f} px."


def _space(tangle: _Tangle, paper: Paper, of: _Of) -> Panel:
    w, h = tangle.size
    frame = np.array([[0, 0, 0], [w, 0, 0], [w, h, 0], [0, h, 0], [0, 0, 0]])
    seen = on_sheet(frame * [*tangle.square, 0] - [0.5, 0.5, 0])
    panel = paper.panel(_SPACE, *_SHOWN, "twelve half circles; the ring: 100 px about the camera")
    panel.polygons(seen[None, :-1], "#F4F4F0")
    panel.line(seen, MUTED, 1)
    m = np.column_stack([tangle.seen(1)[0] * tangle.square, np.zeros(len(tangle.W))])
    draw_squares(panel, on_sheet(m), tangle.board, "#B0B0B0")
    arcs = np.array([one.place(np.arange(0, 181, 1.5)) for one in tangle.circles(*of)])
    near = behind_sheet(tangle.eye - arcs) / _DEEP
    _draw_arcs(panel, on_sheet(arcs), near, (1, 2.2))
    for size in (2.5 * panel.pixel, _NEAR):
        panel.line(on_sheet(tangle.eye) + size * circle(33), IDEAL, 1)
    panel.polygons([on_sheet(tangle.eye) + 2.5 * panel.pixel * circle(17)], IDEAL)
    return panel


def _draw_arcs(
    panel: Panel, arcs: Array, near: Array, width: _Of, faded: Array | float = 0
) -> None:
    """Draw curves (n, k, 2) in pieces, from the farthest to the nearest: thicker and stronger.

    How near their points (n, k) are goes from −½ to ½, and how faded from 0 to 1.
    """
    pieces = np.stack([arcs[:, :-1], arcs[:, 1:]], axis=2)
    tone = _step(near + 0.5, _TONES)
    pale = _step(np.broadcast_to(faded, near.shape), _FADES)
    for i in range(_TONES):
        part = i / (_TONES - 1)
        for j in reversed(range(_FADES)):
            ink = mixed(mixed(_FAR, LENS, part), "#FFFFFF", j / _FADES)
            some = pieces[(tone == i) & (pale == j)]
            panel.segments(some, ink, width[0] + part * (width[1] - width[0]))


def _step(values: Array, steps: int) -> Array:
    """Return for each piece between two points, whose values go from 0 to 1, one of the steps."""
    middle = (values[:, :-1] + values[:, 1:]) / 2
    return np.asarray(np.rint(np.nan_to_num(middle).clip(0, 1) * (steps - 1)))


def _close(tangle: _Tangle, paper: Paper, of: _Of) -> Panel:
    """Draw what lies in a ball about the camera, from above: u to the right and v down."""
    eye, reach = tangle.eye[:2], _NEAR / 0.93 * np.array(_CLOSE) / _CLOSE[1]
    (left, top), (right, low) = eye - reach, eye + reach
    panel = paper.panel(_CLOSE, (left, right), (top, low), "within the ring, from above: u₀ and v₀")
    panel.line(eye + _NEAR * circle(129), IDEAL, 1)
    arcs = np.array([_inside(one, tangle.eye) for one in tangle.circles(*of)])
    up = (arcs[..., 2] - tangle.eye[2]) / _NEAR
    away = np.linalg.norm(arcs - tangle.eye, axis=-1) / _NEAR
    _draw_arcs(panel, arcs[..., :2], up / 2, (1.6, 3.2), (away - 0.8) / 0.2)
    pixel, inset = panel.pixel, 14 * panel.pixel
    for at in (eye, np.array([left + inset, top + inset])):
        panel.segments(at + 8 * pixel * np.array([[[-1, 0], [1, 0]], [[0, -1], [0, 1]]]), IDEAL, 2)
    panel.text([left + inset + 12 * pixel, top + inset], "camera", IDEAL, size=12)
    found = tangle.found(*of)[:2]
    words = "no camera" if np.isnan(found).any() else "found"
    if np.hypot(*(found - eye)) > _NEAR:
        words = "farther out"
    else:
        _draw_triangle(panel, found)
    _draw_triangle(panel, np.array([left + inset, low - inset]))
    panel.text([left + inset + 12 * pixel, low - inset], words, ESTIMATED, size=12)
    panel.segments([[[right - 50 - inset, low - inset], [right - inset, low - inset]]], IDEAL, 2)
    panel.text([right - inset, low - 2 * inset], "50 px", IDEAL, anchor="rm", size=12)
    return panel


def _inside(one: Circle, eye: Array) -> Array:
    """Return places (k, 3) of a half circle near the camera; NaN outside of the ball."""
    middle = np.degrees(np.arctan2(eye[2], (eye[:2] - one.foot) @ one.up))
    places = one.place(middle + np.degrees(1.1 * _NEAR / one.radius) * np.linspace(-1, 1, 45))
    places[np.linalg.norm(places - eye, axis=1) > _NEAR] = np.nan
    return places


def _draw_triangle(panel: Panel, at: Array) -> None:
    """Draw the camera that is found: hollow, so that it hides nothing."""
    corners = at + 9 * panel.pixel * np.array([[0, -1], [0.9, 0.7], [-0.9, 0.7]])
    panel.line(corners[[0, 1, 2, 0, 1]], ESTIMATED, 2)


def _curve(tangle: _Tangle, paper: Paper, of: _Of) -> Panel:
    """Draw how far the half circles miss the camera; the hand pulls along the curve."""
    (k1, turned), x, y = of, (_LOWEST - 0.07, _HIGHEST + 0.03), (_MOST, -0.2 * _MOST)
    panel = paper.panel(_CURVE, x, y, "RMS distance from camera (px) against k₁")
    panel.ticks(x=(-0.4, -0.2, 0), y=(0, 40, 80), size=12)
    tried = np.arange(_LOWEST, _HIGHEST + 0.01, 0.025)
    way = np.array([[k, np.sqrt(np.mean(tangle.misses(float(k), turned) ** 2))] for k in tried])
    panel.line(way, MUTED, 1.6)
    at = np.array([k1, np.sqrt(np.mean(tangle.misses(k1, turned) ** 2))])
    panel.mark(at, "estimated", 8)
    panel.text([-0.2, 66], f"{at[1]:.1f} px", ESTIMATED, anchor="mm", size=15)  # within the V
    panel.grip("k1", "how much of the lens is undone", at, 4)
    return panel
