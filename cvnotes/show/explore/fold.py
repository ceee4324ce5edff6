"""Explore the fold: every eye on a half circle sees both right angles of a photographed board."""

from typing import NamedTuple

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, look_at
from cvnotes.homography import dlt
from cvnotes.pictures import course
from cvnotes.show.explore.model import Drawing, Model, Setting, Values
from cvnotes.show.explore.paper import Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, LENS, MUTED, WORLD

SIZE = (640, 480)
ALPHA, MIDDLE = 400, ((SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2)
# Where two photographs of a board on a desk were taken, and what was up in them.
_EYES = (([226, 345, -185], (0, 0, -1)), ([-60, 330, -210], (0.35, 0, -1)))
_SPACE, _DIALS = (500, 400), (350, 400)
_VIEW = look_at([1700, 1500, 1000], [250, 150, 0], up=(0, 0, 1))[:2, :3]
_LOWEST, _HIGHEST = 20, 130  # degrees, of the fold
_SHOWN = ((-640, 640), (-570, 454))  # x and y of the sheet on which space is drawn
_FROM, _TO = 75, 105  # degrees, of the angles


class Circle(NamedTuple):
    """All places from which a photograph's two right angles are seen as such.

    Pixels are square. Places are (u, v, w): w px before the picture, whose plane is w = 0.
    """

    foot: Array  # (2,) on the horizon, under the middle of the circle
    up: Array  # (2,) unit vector in the picture, from the horizon to the board
    radius: float

    def place(self, fold: float) -> Array:
        """Return the place at an angle from the picture, in degrees: (u0, v0, α)."""
        phi = np.radians(fold)
        in_plane = self.foot + self.radius * np.cos(phi) * self.up
        return np.array([*in_plane, self.radius * np.sin(phi)])


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


def fold_model() -> Model:
    """Make the model of the eye before a photograph, and before two."""
    W = course.board().points
    cameras = photographs()
    H = [dlt(W[:, :2], camera.project(W)) for camera in cameras]
    circles = [circle_of(h) for h in H]
    settings = (
        Setting("fold", "fold (°)", _LOWEST, _HIGHEST, 0.5, 50,
                "the angle of the eye over the photograph, about its horizon"),
        Setting("second", "a second photograph", 0, 1, 1, 0, "of the same board, same camera"),
    )  # fmt: skip
    about = (
        "A photograph of a board lies flat, and an eye hangs over it on a half circle about the "
        "horizon; beside it the angles at which the eye sees the square's sides and diagonals."
    )

    def draw(paper: Paper, values: Values) -> Drawing:
        eye = circles[0].place(values["fold"])
        shown = 1 + int(values["second"])
        space = _space(paper, cameras[:shown], H[:shown], circles[:shown], eye)
        dials = _dials(paper, H[:shown], circles[0], values["fold"])
        return Drawing(paper.join((space, dials)), _sentence(H[:shown], eye))

    def turned(_: Values, at: Array) -> Values:
        folds = np.arange(_LOWEST, _HIGHEST + 0.5, 0.5)
        way = np.array([_on_sheet(circles[0].place(float(fold))) for fold in folds])
        return {"fold": float(folds[np.linalg.norm(way - at, axis=1).argmin()])}

    drags = {"eye": turned, "fold": lambda _, at: {"fold": float(at[0])}}
    return Model("fold", about, settings, draw, drags)


def _sentence(H: list[Array], eye: Array) -> str:
    said = f"An eye at α = {eye[2]:.0f} px over (u0, v0) = ({eye[0]:.1f}, {eye[1]:.1f}) sees both "
    first = angles(H[0], eye)
    said += f"right angles of the photograph: {first[0]:.2f}° and {first[1]:.2f}°."
    if len(H) == 1:
        return f"{said} So does every other place on the half circle."
    sides, diagonals = angles(H[1], eye)
    said += f" In the second one it sees {sides:.1f}° and {diagonals:.1f}°"
    near = max(abs(sides - 90), abs(diagonals - 90)) < 0.2
    return f"{said}: this is the camera." if near else f"{said}: this is not the camera."


def _on_sheet(place: Array) -> Array:
    """Project places (u, v, w), (..., 3), in parallel onto the sheet (..., 2)."""
    return np.asarray(place @ _VIEW.T)


def _flat(xy: Array) -> Array:
    """Put points (..., 2) of a picture on the sheet."""
    return _on_sheet(np.concatenate([xy, np.zeros((*xy.shape[:-1], 1))], axis=-1))


def _space(
    paper: Paper, cameras: list[Camera], H: list[Array], circles: list[Circle], eye: Array
) -> Panel:
    panel = paper.panel(_SPACE, *_SHOWN, "the photograph, and the eye over it")
    w, h = SIZE
    frame = np.array([[-0.5, -0.5], [w - 0.5, -0.5], [w - 0.5, h - 0.5], [-0.5, h - 0.5]])
    panel.polygons(_flat(frame)[None], "#F4F4F0")
    panel.line(_flat(frame[[0, 1, 2, 3, 0]]), MUTED, 1)
    colours = (IDEAL, WORLD)
    for camera, circle, ink in zip(cameras, circles, colours, strict=False):
        _draw_board(panel, camera, ink)
        along = np.array([circle.up[1], -circle.up[0]])
        ends = circle.foot + np.array([[-3000.0], [3000.0]]) * along
        panel.line(_flat(ends), ink, 0.8, dash=5)
        arc = np.array([circle.place(float(fold)) for fold in range(0, 181, 3)])
        panel.line(_on_sheet(arc), ink, 2)
        panel.line(_on_sheet(arc[[0, -1]]), ink, 0.8)
    points = np.column_stack([vanishing_points(H[0]), np.zeros(4)])
    for point, colour in zip(points, (ESTIMATED, ESTIMATED, LENS, LENS), strict=True):
        panel.line(_on_sheet(np.array([eye, point])), colour, 1.4)
        panel.mark(_on_sheet(point), "estimated" if colour == ESTIMATED else "lens", 5)
    for corner in frame:
        panel.line(_on_sheet(np.array([eye, [*corner, 0]])), CAMERA, 0.8)
    below = np.array([eye, [*eye[:2], 0]])
    panel.line(_on_sheet(below), MUTED, 1, dash=3)
    panel.mark(_on_sheet(below[1]), "ideal", 6)
    panel.mark(_on_sheet(eye), "camera", 9)
    panel.grip("eye", "the eye, to be turned about the horizon", _on_sheet(eye), 4)
    return panel


def _draw_board(panel: Panel, camera: Camera, ink: str) -> None:
    """Draw the squares between the corners of the board, where the photograph shows them."""
    columns, rows = course.board().corners
    grid = camera.project(course.board().points).reshape(rows, columns, 2)
    for line in (*grid, *grid.transpose(1, 0, 2)):
        panel.line(_flat(line), ink, 0.8)


def _dials(paper: Paper, H: list[Array], circle: Circle, fold: float) -> Panel:
    """Draw the angles at which the eye sees sides and diagonals, over the fold."""
    panel = paper.panel(
        _DIALS, (_LOWEST - 8, _HIGHEST + 4), (_TO, _FROM), "the two right angles (°) over the fold"
    )
    panel.ticks(x=(30, 60, 90, 120), y=(80, 85, 90, 95, 100))
    folds = np.arange(_LOWEST, _HIGHEST + 1, 2.0)
    for h, width in zip(H, (1.2, 2.2), strict=False):
        seen = np.array([angles(h, circle.place(float(f))) for f in folds])
        for way, colour, dash in zip(seen.T, (ESTIMATED, LENS), (0, 6), strict=True):
            panel.line(np.column_stack([folds, way]), colour, width, dash=dash)
    panel.line([[fold, _FROM], [fold, _TO]], MUTED, 1)
    for h in H:
        both = angles(h, circle.place(fold))
        panel.mark([[fold, both[0]]], "estimated", 6)
        panel.mark([[fold, both[1]]], "lens", 6)
    panel.grip("fold", "the fold", [fold, 90], 4)
    panel.text([_LOWEST - 6, 78.9], "orange: sides", ESTIMATED)
    panel.text([_LOWEST - 6, 77.9], "blue: diagonals", LENS)
    return panel
