"""Explore which photographs determine a camera: pull four boards upright, and watch the bars."""

import numpy as np

from cvnotes.base import Array, DegenerateError
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.refinement import Problem, covariance
from cvnotes.camera import Camera, move, pose, rotation_from_vector
from cvnotes.pictures import course
from cvnotes.show.explorations.boards import draw_board
from cvnotes.show.explorations.model import Drag, Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL

_SIZE, _BARS, _GAP = (504, 378), (350, 378), 16  # px of the page; px between photographs
_GREY = "#ECECEC"
_MOST, _START = 40, ((0, -30), (30, 0), (-30, 0), (0, 30))  # degrees, to the right and down
_AIMS = np.array([[285, 235], [365, 235], [285, 265], [365, 265]])  # px, of the boards' middles
_FAR, _NAIL, _UPRIGHT = 560.0, 130.0, 4.5  # mm: of the boards, of a nail, of a head that springs
_NOISE, _UNKNOWN = 0.1, 1000  # px: of the corners, and from where on nothing is known
_BEYOND = 0.4  # powers of ten: how long the arrow is to what is not known
_LABELS = ("αᵤ", "αᵥ", "u₀", "v₀")


def nails_model() -> Model:
    """Make the model of four photographs of a board, each turned by the nail upon it."""
    settings = tuple(
        Setting(f"{way}{i}", f"nail {i} {to}", -_MOST, _MOST, 1, start,
                f"how far, in degrees, the nail of photograph {i} leans {to}")
        for i, starts in enumerate(_START, start=1)
        for way, to, start in zip(("right", "down"), ("right", "down"), starts, strict=True)
    )  # fmt: skip
    settings += (Setting("lens", "with a lens", 0, 1, 1, 0, "whose k₁ and k₂ are estimated, too"),)
    about = """Four photographs of a board, each with a nail that stands upright on the board, and
    the standard deviations of the camera that they determine, on a scale of powers of ten."""
    drags = {f"nail {i}": _pulled(i) for i in range(1, 5)}
    return Model("nails", about, settings, _draw, drags)


def held(values: Values) -> Array:
    """Return the pose (4, 4, 4) of the board in each photograph."""
    W, A = course.board().points.mean(axis=0), course.camera().A
    rays = np.column_stack([(_AIMS - A[:2, 2]) / [A[0, 0], A[1, 1]], np.ones(4)])
    lean = np.radians([[values[f"down{i}"], -values[f"right{i}"], 0] for i in range(1, 5)])
    turns = rotation_from_vector(lean)
    return np.array([pose(R, _FAR * ray - R @ W) for R, ray in zip(turns, rays, strict=True)])


def camera_of(values: Values) -> Camera:
    """Return the course's camera, with its lens or without."""
    camera = course.camera()
    return camera if values["lens"] else Camera(camera.A, size=camera.size)


def known(values: Values) -> tuple[Array, float]:
    """Return the standard deviations (4,) of αu, αv, u0 and v0, and the RMS to expect, in px."""
    camera, G, W = camera_of(values), held(values), course.board().points
    data = Correspondences.in_unit_frame(W, np.stack([camera.moved(g).project(W) for g in G]))
    problem = Problem(
        data.W, data.m, coefficients=("k1", "k2") if values["lens"] else (), size=camera.size
    )
    rms = _NOISE * np.sqrt(problem.freedom / problem.n_seen)
    try:
        _, system = problem.linearise(problem.state(camera, data.pose_in_scaled_units(G)))
        return _NOISE * np.sqrt(np.diag(covariance(system))[:4]), rms
    except DegenerateError:
        return np.full(4, np.inf), rms


def _at(i: int) -> Array:
    """Return where on the sheet the photograph i, from 1 to 4, has its pixel (0, 0)."""
    return (np.array(course.camera().size) + _GAP) * [(i - 1) % 2, (i - 1) // 2]


def _pulled(i: int) -> Drag:
    def drag(values: Values, at: Array) -> Values:
        """Let the nail's head follow: on a sphere, it springs upright near 0°."""
        camera = camera_of(values)
        ray = np.append(camera.ideal(np.clip(at - _at(i), 0, np.subtract(camera.size, 1))), 1.0)
        middle = move(held(values)[i - 1], course.board().points.mean(axis=0))
        a, b = ray @ ray, ray @ middle
        near = b - np.sqrt(max(b * b - a * (middle @ middle - _NAIL**2), 0))  # or beside it
        x, y, z = near / a * ray - middle
        far = np.degrees(np.arctan2(out, -z)) / out if (out := np.hypot(x, y)) > _UPRIGHT else 0
        return {f"right{i}": float(far * x), f"down{i}": float(far * y)}

    return drag


def _draw(paper: Paper, values: Values) -> Drawing:
    camera, board = camera_of(values), course.board()
    sheet = 2 * camera.size[0] + _GAP, 2 * camera.size[1] + _GAP
    panel = paper.picture_panel(_SIZE, sheet, "four photographs: pull the nails")
    for i, G in enumerate(held(values), start=1):
        u, v = _at(i)
        frame = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * camera.size - 0.5
        panel.polygons([frame + _at(i)], _GREY)
        beside = Camera(camera.A + [[0, 0, u], [0, 0, v], [0, 0, 0]], G, camera.lens, sheet)
        draw_board(panel, beside, board)
        foot = board.points.mean(axis=0)
        nail = beside.project([foot, foot - [0, 0, _NAIL]])
        panel.line(nail, ESTIMATED, 3, rim=2)
        for size, ink in ((7.5, "white"), (6, ESTIMATED)):
            panel.polygons([nail[1] + size * panel.pixel * circle(33)], ink)
        panel.grip(f"nail {i}", f"the nail of photograph {i}", nail[1], 2)
        lean = np.hypot(values[f"right{i}"], values[f"down{i}"])
        panel.text([u + 22, v + 36], f"{i}: {lean:.0f}°", IDEAL, size=14, rim=_GREY)
    std, rms = known(values)
    said = ", ".join(f"{name} {_number(one)}" for name, one in zip(_LABELS, std, strict=True))
    sentence = f"Standard deviations: {said}. The RMS is {rms:.2f} px."
    return Drawing(paper.join((panel, _bars(paper, std, rms))), sentence)


def _bars(paper: Paper, std: Array, rms: float) -> Panel:
    """Draw a dot for each parameter, and the RMS of the residuals as a line beside them."""
    left, right = np.log10([0.04, 3000])
    title = f"standard deviation (px), with noise of {_NOISE:g} px"
    at = float(np.log10(rms))
    panel = paper.panel(_BARS, (left, right), (-0.85, 4.15), title)
    unit = np.array([panel.pixel, 5 / _BARS[1]])  # of a px of the page
    for power in range(-1, 4):
        panel.line([[power, -0.3], [power, 3.8]], "#E0E0E0", 0.8)
        panel.text([power, 3.98], f"{10.0**power:g}", anchor="mm", size=12)
    for i, (name, one) in enumerate(zip(_LABELS, std, strict=True)):
        end, y = min(np.log10(one), right), i + 0.14
        if one > _UNKNOWN:
            panel.arrows([end - _BEYOND, y], [_BEYOND, 0], CAMERA, 5)
        else:
            panel.polygons([[end, y] + 8 * circle(33) * unit], CAMERA)
        panel.text([left + 0.08, y], name, IDEAL, size=16)
        beside, anchor = (right - 0.06, "rd") if end > 2 else (end, "md")
        panel.text([beside, y - 12 * unit[1]], _number(one), IDEAL, anchor=anchor, size=14)
    panel.line([[at, -0.62], [at, 3.8]], IDEAL, 1.2, dash=4)
    panel.text([at + 0.08, -0.6], f"RMS of the residuals: {rms:.2f} px", IDEAL, size=13)
    return panel


def _number(std: float) -> str:
    """Write a standard deviation, or that there is none."""
    if std > _UNKNOWN:
        return "undetermined"
    return f"{std:.1f} px" if std < 99.95 else f"{std:.0f} px"
