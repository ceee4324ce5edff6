"""Explore the fold: every eye on a half circle sees both right angles of a photographed board."""

from typing import NamedTuple

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, look_at
from cvnotes.homography import dlt
from cvnotes.pictures import course
from cvnotes.show.explorations.boards import draw_net, draw_squares
from cvnotes.show.explorations.model import Drag, Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.paper import circle as ring
from cvnotes.show.space.directions import onto
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, LENS, MUTED

SIZE = (640, 480)
ALPHA, MIDDLE = 400, ((SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2)
# Where two photographs of a board on a desk were taken, and what was up in them.
_EYES = (([163, 203.5, -92.5], (0, 0, -1)), ([-15, 187, -120], (0.5, 0, 0.87)))
_SPACE, _FACE, _SIDE = (500, 420), (350, 150), (350, 242)  # px: the two stand below each other
_SCALE = 0.62  # of the hinge, face on
_VIEW = look_at([-850, 370, -370], [0, 0, 0], up=(0, 0, -1))[:3, :3]  # from the left, above
on_sheet = onto(_VIEW[:2] * [1, 1, -1])  # of places (u, v, w)
_LOWEST, _HIGHEST, _STEP = 20, 130, 0.05  # degrees, of the fold
_MEET, _NEAR = 59.15, 0.25  # where the second half circle is met; a hand so near takes it
_SHOWN = ((-360, 790), (-650, 316))  # x and y of the sheet on which space is drawn
_INKS = (IDEAL, MUTED)  # of the first photograph and of the second
_SQUARE, _PALE, _LID = "#B0B0B0", "#BDBDBD", "#E3EEF7"
PAIRS = (("sides", "estimated", ESTIMATED), ("diagonals", "lens", LENS))


class Circle(NamedTuple):
    """All places from which a photograph's two right angles are seen as such.

    Pixels are square. Places are (u, v, w): w px before the picture, whose plane is w = 0.
    """

    foot: Array  # (2,) on the horizon, under the middle of the circle
    up: Array  # (2,) unit vector in the picture, from the horizon to the board
    radius: float

    def place(self, fold: Array | float) -> Array:
        """Return the places (..., 3) at angles (...) from the picture, in degrees: (u0, v0, α)."""
        phi = np.radians(np.asarray(fold, dtype=float))[..., None]
        in_plane = self.foot + self.radius * np.cos(phi) * self.up
        return np.concatenate([in_plane, self.radius * np.sin(phi)], axis=-1)

    def distance(self, place: Array) -> float:
        """Return how far a place (u, v, w) is from the circle."""
        by = place[:2] - self.foot
        along = by @ self.up
        aside = np.linalg.norm(by - along * self.up)
        return float(np.hypot(aside, np.hypot(along, place[2]) - self.radius))


def photographs() -> list[Camera]:
    """Return the cameras that have taken the two photographs, without a lens."""
    A = intrinsics(ALPHA, ALPHA, *MIDDLE)
    target = [100, 62, 0]
    return [Camera(A, look_at(eye, target, up=up), size=SIZE) for eye, up in _EYES]


def vanishing_points(H: Array) -> Array:
    """Return the vanishing points (4, 2) of a square's sides and of its diagonals."""
    h1, h2 = H[:, 0], H[:, 1]
    columns = np.array([h1, h2, h1 + h2, h1 - h2])
    return np.asarray(columns[:, :2] / columns[:, 2:])


def circle_of(H: Array) -> Circle:
    """Return the circle of a homography H (3, 3) of the board.

    A place at the position s along the horizon and ρ away from it sees points a and b of the
    horizon at a right angle if (s − a)(s − b) + ρ² = 0. Two right angles give s and ρ.
    """
    v = vanishing_points(H)
    along = (v[1] - v[0]) / np.linalg.norm(v[1] - v[0])
    a, b, c, d = (v - v[0]) @ along
    s = (a * b - c * d) / (a + b - c - d)
    foot = v[0] + s * along
    up = np.array([-along[1], along[0]])
    board = H[:2, 2] / H[2, 2]
    return Circle(foot, up * np.sign(up @ (board - foot)), float(np.sqrt(-(s - a) * (s - b))))


def angles(H: Array, eye: Array) -> tuple[float, float]:
    """Return the angles, in degrees, at which an eye sees the two pairs of vanishing points."""
    rays = np.column_stack([vanishing_points(H), np.zeros(4)]) - eye
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    sides, diagonals = np.degrees(np.arccos([rays[0] @ rays[1], rays[2] @ rays[3]]))
    return float(sides), float(diagonals)


def two_photographs() -> tuple[list[Camera], list[Array], list[Circle]]:
    """Return the cameras of both photographs, their homographies and their circles."""
    W, cameras = course.board().points, photographs()
    H = [dlt(W[:, :2], camera.project(W)) for camera in cameras]
    return cameras, H, [circle_of(h) for h in H]


_HINGE = Setting(
    "fold", "hinge (°)", _LOWEST, _HIGHEST, _STEP, 50,
    "the angle of the eye over the photograph, about its horizon",
)  # fmt: skip
_SECOND = Setting("second", "second photograph", 0, 1, 1, 0, "of the same board, from elsewhere")


def _turned_to(circle: Circle, *, side: bool = False) -> Drag:
    """Return what turns the eye on its circle to where it is pulled, in space or from the side."""
    folds = np.arange(_LOWEST, _HIGHEST + _STEP, _STEP)
    way = circle.place(folds)
    places = way[:, 1:2] if side else on_sheet(way)  # from the side along the curve, by its x

    def pulled(_: Values, at: Array) -> Values:
        away = np.linalg.norm(places - at[: places.shape[1]], axis=1)
        fold = float(folds[away.argmin()])
        return {"fold": _MEET if abs(fold - _MEET) <= _NEAR else fold}

    return pulled


def fold_model() -> Model:
    """Make the model of the eye before two photographs."""
    cameras, H, circles = two_photographs()
    about = """A photograph of a board lies flat. An eye hangs over it on a half circle about the
    horizon, with lines to the vanishing points of the square's sides and of its diagonals; and, if
    wanted, the same of a second photograph. Beside it the plane of horizon and eye, with a half
    circle over each pair, and the eye's path from the side."""

    def draw(paper: Paper, values: Values) -> Drawing:
        eye, n = circles[0].place(values["fold"]), 1 + round(values["second"])
        space = _eye_over_sheet(paper, cameras[0], H[:n], circles[:n], eye)
        beside = [_face_on(paper, H[0], circles[0], eye), _side(paper, H[:n], circles[:n], eye)]
        return Drawing(paper.join((space, beside)), _sentence(H[:n], eye))

    drags = {"eye": _turned_to(circles[0]), "fold": _turned_to(circles[0], side=True)}
    return Model("fold", about, (_HINGE, _SECOND), draw, drags)


def _sentence(H: list[Array], eye: Array) -> str:
    """Say which angles the eye sees in one photograph, or in two."""
    said = f"An eye {eye[2]:.0f} px over pixel ({eye[0]:.1f}, {eye[1]:.1f}): "
    first = angles(H[0], eye)
    said += f"sides {first[0]:.2f}°, diagonals {first[1]:.2f}°."
    if len(H) == 1:
        return said
    sides, diagonals = angles(H[1], eye)
    said += f" Photograph 2: sides {sides:.1f}°, diagonals {diagonals:.1f}°"
    near = max(abs(sides - 90), abs(diagonals - 90)) < 0.2
    return f"{said}: this is the camera." if near else f"{said}: this is not the camera."


def behind_sheet(place: Array) -> Array:
    """Return how far behind the sheet places (u, v, w), (..., 3), are: larger is farther."""
    return np.asarray((place * [1, 1, -1]) @ _VIEW[2])


def _flat(xy: Array) -> Array:
    """Put points (..., 2) of a picture on the sheet."""
    return on_sheet(np.concatenate([xy, np.zeros((*xy.shape[:-1], 1))], axis=-1))


def _eye_over_sheet(
    paper: Paper, camera: Camera, H: list[Array], circles: list[Circle], eye: Array
) -> Panel:
    """Draw the photograph, the eye over it, and the half circles of all `circles`."""
    panel = paper.panel(_SPACE, *_SHOWN, "a photograph, the eye over it, and four vanishing points")
    (w, h), board = SIZE, course.board()
    frame = np.array([[-0.5, -0.5], [w - 0.5, -0.5], [w - 0.5, h - 0.5], [-0.5, h - 0.5]])
    panel.polygons(_flat(frame)[None], "#F4F4F0")
    lid = np.array([[*point, 0] for point in vanishing_points(H[0])[[0, 3]]] + [eye])
    panel.polygons(on_sheet(lid)[None], _LID)
    panel.line(_flat(frame[[0, 1, 2, 3, 0]]), MUTED, 1)
    m = _flat(camera.project(board.points))
    draw_squares(panel, m, board, _SQUARE)
    draw_net(panel, m, board, IDEAL, 0.8)
    for circle, ink in reversed([*zip(circles, _INKS, strict=False)]):
        along = np.array([[-3000.0], [3000.0]]) * [circle.up[1], -circle.up[0]]
        panel.line(_flat(circle.foot + along), ink, 0.8, dash=5)
        arc = circle.place(np.arange(0, 181.0, 3))
        panel.line(on_sheet(arc), ink, 2)
        panel.line(on_sheet(arc[[0, -1]]), ink, 0.8)
    _name(panel, on_sheet(circles[0].place(125.0)), (-6, -4), "the eye's path", IDEAL, "rd")
    below = np.array([*eye[:2], 0])
    panel.line(on_sheet(np.array([eye, below])), IDEAL, 1.4, dash=3)
    for second in H[1:]:
        others = _flat(vanishing_points(second))
        for point in others:
            panel.line(np.array([on_sheet(eye), point]), _PALE, 1.4)
            panel.line(point + 4 * panel.pixel * ring(13), MUTED, 1.4)
        _name(panel, others[0], (-6, 14), "horizon 2", MUTED, "ra")
    points = vanishing_points(H[0])
    for k, point in enumerate(points):
        name, meaning, colour = PAIRS[k // 2]
        panel.line(np.array([on_sheet(eye), _flat(point)]), colour, 1.4)
        panel.mark(_flat(point), meaning, 5)
        if k in (0, 3):  # the outer one of each pair
            _name(panel, _flat(point), (8, 6), name, colour, "la")
    beyond = _flat(points[3] + 0.12 * (points[3] - points[0]))
    _name(panel, beyond, (-20, -3), "horizon: the hinge", IDEAL, "rm")
    panel.mark(on_sheet(below), "ideal", 7)
    panel.grip("eye", "the eye, to be turned about the horizon", on_sheet(eye), 4, "camera", 9)
    _name(panel, on_sheet(eye), (24, 14), "eye", CAMERA, "lm")
    aside = on_sheet(below) + [0, 66 * panel.pixel]  # under the photograph
    panel.line(np.array([on_sheet(below), aside]), MUTED, 0.6)
    _name(panel, aside, (0, 2), "(u₀, v₀)", IDEAL, "ma")
    _name(panel, on_sheet((eye + below) / 2), (-7, 0), "α", IDEAL, "rm")
    return panel


def _name(
    panel: Panel, at: Array, by: tuple[float, float], words: str, colour: str, anchor: str
) -> None:
    """Write a name so many px beside a place: a grip's ring covers 14 px about it."""
    panel.text(at + panel.pixel * np.array(by), words, colour, anchor=anchor, size=13)


def _face_on(paper: Paper, H: Array, circle: Circle, place: Array) -> Panel:
    """Draw horizon and eye in their own plane: the eye is on two half circles, by Thales."""
    panel = paper.panel(_FACE, (-580, 960), (590, -70), "the lid, face on")
    along = np.array([circle.up[1], -circle.up[0]])
    s = (vanishing_points(H) - circle.foot) @ along
    shift = np.array([190 - _SCALE * (s.min() + s.max()) / 2, 0])
    eye = shift + [0, _SCALE * circle.radius]
    outer = shift + _SCALE * np.array([[s.min(), 0], [s.max(), 0]])
    panel.polygons([[*outer, eye]], _LID)
    panel.line(np.array([[-3000, 0], [3000, 0]]), IDEAL, 0.8, dash=5)
    turn = np.radians(np.arange(0, 181.0, 3))
    places = (-540, "ld"), (920, "rd")
    both = zip(PAIRS, s.reshape(2, 2), angles(H, place), places, strict=True)
    for (name, meaning, colour), (a, b), angle, (x, anchor) in both:
        thales = np.column_stack([a + b + (b - a) * np.cos(turn), abs(b - a) * np.sin(turn)]) / 2
        panel.line(shift + _SCALE * thales, colour, 0.8)
        ends = shift + _SCALE * np.array([[a, 0], [b, 0]])
        panel.line(np.array([ends[0], eye, ends[1]]), colour, 1.4)
        one, two = 80 * (ends - eye) / np.linalg.norm(ends - eye, axis=1, keepdims=True)
        panel.line(eye + np.array([one, one + two, two]), colour, 1.4)
        panel.mark(ends, meaning, 5)
        panel.text([x, 490], f"{name}: {angle:.1f}°", colour, anchor=anchor, size=14)
    panel.mark(eye, "camera", 9)
    return panel


def _side(paper: Paper, H: list[Array], circles: list[Circle], eye: Array) -> Panel:
    """Draw the half circles from the side, and say which angles the eye sees."""
    high, low = 875, -190  # one scale for both axes, so that a half circle is one
    panel = paper.panel(_SIDE, (-580, 960), (high, low), "height of the eye against v₀ (px)")
    panel.ticks(x=(-400, 0, 400, 800), y=(0, 200, 400), size=12)
    panel.polygons([[[-580, high], [960, high], [960, 560], [-580, 560]]], "#FFFFFF")
    for k in reversed(range(len(circles))):
        arc = circles[k].place(np.arange(0, 181.0, 2))
        panel.line(arc[:, 1:], _INKS[k], 2)
        if len(circles) == 1:  # its angles stand above
            continue
        row = 785 - 120 * k
        panel.text([-520, row], f"photograph {k + 1}:", _INKS[k], anchor="lm", size=14)
        for x, (_, _, colour), angle in zip((90, 480), PAIRS, angles(H[k], eye), strict=True):
            panel.text([x, row], f"{angle:.1f}°", colour, anchor="lm", size=16)
    panel.line(np.array([[eye[1], 0.0], eye[1:]]), IDEAL, 1.4, dash=3)
    panel.grip("fold", "the hinge", eye[1:], 4, "camera", 9)
    return panel
