"""Explore the finding of a camera: one photograph's misses on the way from the closed form."""

from functools import cached_property, partial

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration import (
    constraints,
    extrinsics,
    intrinsics_from_b,
    radial_distortion,
    solve_b,
)
from cvnotes.calibration.refinement import Problem, State, solve_by_schur, take_step
from cvnotes.camera import Camera, Lens, move, pose, rotation_from_vector
from cvnotes.homography import dlt
from cvnotes.pictures import course
from cvnotes.show.explorations.boards import around, draw_measured, draw_sheet, paper_and_squares
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.space.directions import onto
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, LENS, WORLD, mixed

_STEPS = 3
_LONGEST = 0.12  # of the board's width in the photograph: so long is a frame's longest arrow
_ROOM, _PHOTO, _CURVE = (430, 372), (394, 200), (394, 144)  # px
_FLOOR, _TILES, _JOINTS, _SHADOW = 190.0, "#EFE7D9", "#FBFAF7", "#E0D8CB"  # mm below the camera
_PANE = 60 * np.array([[-1, -0.75, 2.2], [1, -0.75, 2.2], [1, 0.75, 2.2], [-1, 0.75, 2.2]])
_ROUND = [0, 1, 2, 3, 0]
_from_aside = onto((rotation_from_vector([0.45, 0, 0]) @ rotation_from_vector([0, 0.95, 0]))[:2])


class Finding:
    """Corners of twelve photographs, the course's, and the camera after each Gauss–Newton step."""

    def __init__(self, corners: Array | None = None) -> None:
        self.m = course.measured_corners() if corners is None else corners
        self.size = course.camera().size
        W, m = course.board().points, self.m
        H = dlt(W[:, :2], m)
        A = intrinsics_from_b(solve_b(constraints(H)))
        G = extrinsics(A, H)
        k1, k2 = radial_distortion(A, G, W, m, terms=2)
        self.problem = Problem(W, m, size=self.size)
        start = self.problem.state(Camera(A, lens=Lens((k1, k2))), G)
        self.states = [start]
        self._strides: list[tuple[Array, Array]] = []
        for _ in range(_STEPS):
            stride, _ = solve_by_schur(self.problem.linearise(self.states[-1])[1], 0.0)
            self._strides.append(stride)
            self.states.append(take_step(self.states[-1], stride))

    def at(self, step: float) -> tuple[Camera, Array]:
        """Return the camera after so many steps, parts of them too, and m minus what it predicts.

        The misses are (views, corners, 2), in pixels.
        """
        x = self._state(step)
        camera = self.problem.camera_of(x.shared)
        return camera, self.problem.residuals(camera, x)

    def poses(self, step: float) -> Array:
        """Return the poses (views, 4, 4) of the boards before the camera, as found by then."""
        x = self._state(step)
        return np.array([pose(R, T) for R, T in zip(x.R, x.T, strict=True)])

    def _state(self, step: float) -> State:
        whole = min(int(step), _STEPS - 1)
        shared, poses = self._strides[whole]
        part = step - whole
        return take_step(self.states[whole], (part * shared, part * poses))

    @cached_property
    def way(self) -> Array:
        """Steps and the RMS there, (n, 2)."""
        steps = np.linspace(0, _STEPS, 30 * _STEPS + 1)
        return np.array([[step, rms(self.at(float(step))[1])] for step in steps])


def rms(misses: Array) -> float:
    """Return the root mean square of misses (..., 2), per point."""
    return float(np.sqrt(np.mean(np.sum(misses**2, axis=-1))))


def finding_model() -> Model:
    """Make the model of the boards in the room and the misses, while the camera is found."""
    finding = Finding()
    n = len(finding.m) - 1
    settings = (
        Setting("step", "step", 0, _STEPS, 0.05, 0, "steps of the refinement, parts of them too"),
        Setting("photograph", "photograph", 0, n, 1, 0, "which of the twelve photographs"),
    )
    about = """A camera in a room and its twelve boards, where they stood and where they are found,
    on the way from the closed form to the answer. Beside them the misses of one photograph, and how
    far all corners are missed: 3.73 px at the start, 0.374, 0.028 and 0.008 px then."""

    drags = {"step": placed("step")}
    return Model("finding", about, settings, partial(_draw, finding), drags)


def _draw(finding: Finding, paper: Paper, values: Values) -> Drawing:
    step, i = values["step"], int(values["photograph"])
    camera, misses = finding.at(step)
    found, true = finding.poses(step), course.poses()
    column = [_photo(paper, finding, i, misses[i]), _curve(paper, finding, step)]
    off = np.linalg.norm((found - true)[:, :3, 3], axis=-1).max()
    sentence = f"""After {step:g} of {_STEPS} steps the boards are misplaced by up to {off:.2g} mm,
    and k₁ = {camera.parameters["k1"]:+.3f}; the {misses[..., 0].size} corners are missed by
    {_digits(rms(misses))} px. Neighbouring arrows of all photographs agree by {alike(misses):.2f}
    of 1."""
    return Drawing(paper.join((_room(paper, _sheets(found), _sheets(true), i), column)), sentence)


def _sheets(G: Array) -> Array:
    """Return the corners (n, 4, 3) of the boards' paper before the camera, from poses (n, 4, 4)."""
    border, _ = paper_and_squares(course.board())
    return np.array([move(pose, border) for pose in G])


def _room(paper: Paper, found: Array, true: Array, i: int) -> Panel:
    """Draw the camera, its boards where they stood, and orange where they are found: one whole."""
    x, z = np.meshgrid(range(-300, 301, 100), range(-100, 801, 100), indexing="ij")
    floor = np.stack([x, np.full_like(x, _FLOOR), z], axis=-1)
    whole = np.array([floor[0, 0], floor[0, -1], floor[-1, -1], floor[-1, 0]])
    shown = _from_aside(np.concatenate([whole, true.reshape(-1, 3)]))
    (left, top), (right, bottom) = around(shown.min(0), shown.max(0), _ROOM, 1.02)
    panel = paper.panel(_ROOM, (left, right), (top, bottom), "the room: twelve boards")
    panel.polygons([_from_aside(whole)], _TILES)
    for joints in (floor[:, [0, -1]], floor[[0, -1]].swapaxes(0, 1)):
        panel.segments(_from_aside(joints), _JOINTS, 1)
    panel.polygons(_from_aside(true * [1, 0, 1] + [0, _FLOOR, 0]), _SHADOW)
    for boards, ink in ((true, WORLD), (found, ESTIMATED)):
        for sheet in _from_aside(boards):
            panel.line(sheet[_ROUND], mixed(ink, "#FFFFFF", 0.55), 0.8)
    eye, pane = _from_aside(np.zeros(3)), _from_aside(_PANE)
    panel.segments([[eye, corner] for corner in _from_aside(true[i])], CAMERA, 0.8)
    G = course.poses()[i]
    draw_sheet(panel, *(_from_aside(move(G, each)) for each in paper_and_squares(course.board())))
    both = (true, WORLD, "as it stood"), (found, ESTIMATED, "as it is found")
    for k, (boards, ink, word) in enumerate(both):
        panel.line(_from_aside(boards[i])[_ROUND], ink, 2.4)
        at = [left + 12 * panel.pixel, top + (18 + 22 * k) * panel.pixel]
        panel.text(at, word, ink, size=15)
    panel.polygons([pane], mixed(CAMERA, "#FFFFFF", 0.6))
    panel.segments([[eye, corner] for corner in pane], CAMERA, 1.8)
    panel.line(pane[_ROUND], CAMERA, 1.8)
    return panel


def _photo(paper: Paper, finding: Finding, i: int, misses: Array) -> Panel:
    """Draw a photograph's corners, with arrows to where they are predicted, enlarged."""
    m = finding.m[i]
    low, high = around(m.min(axis=0), m.max(axis=0), _PHOTO, 1.16)
    times = _LONGEST * np.ptp(m, axis=0).max() / np.linalg.norm(misses, axis=-1).max()
    tens = 10 ** np.floor(np.log10(times))
    times = tens * np.rint(times / tens)  # a number of one digit, and noughts
    title = f"photograph {i}: its misses × {times:.0f}"
    panel = paper.panel(_PHOTO, (low[0], high[0]), (low[1], high[1]), title)
    draw_measured(panel, m, course.board())
    panel.arrows(m, -times * misses, ESTIMATED, 1.2)
    return panel


def _digits(pixels: float) -> str:
    return f"{pixels:.2f}" if pixels >= 1 else f"{pixels:.3f}"


def alike(misses: Array) -> float:
    """Return how far neighbouring misses (n, 54, 2) agree along the rows: 1 if alike, 0 if not."""
    rows = misses.reshape(len(misses), *course.board().corners[::-1], 2)
    one, next_ = rows[:, :, :-1], rows[:, :, 1:]
    return float((one * next_).sum() / np.sqrt((one**2).sum() * (next_**2).sum()))


def _curve(paper: Paper, finding: Finding, step: float) -> Panel:
    """Draw the RMS over the steps, with a logarithmic scale."""
    title = "RMS of all corners (px) against steps"
    panel = paper.panel(_CURVE, (-0.35, _STEPS + 0.5), (1.3, -2.9), title)
    for power in range(-2, 2):
        panel.segments([[[panel.x[0], power], [panel.x[1], power]]], "#DDDDDD", 0.5)
        panel.text([panel.x[0] + 0.04, power], f"{10.0**power:g}", size=12)
    panel.ticks(x=range(_STEPS + 1), size=12)
    way = np.column_stack([finding.way[:, 0], np.log10(finding.way[:, 1])])
    panel.segments(np.stack([way[:-1], way[1:]], axis=1), LENS, 2.2)
    for k, at in enumerate(way[::30]):
        panel.mark(at, "lens", 5)  # its number beside the curve and the grip's ring
        by, anchor = ((0.13, 0.12), "ls") if k < _STEPS else ((0.04, 0.26), "ms")
        panel.text(at + by, _digits(10 ** float(at[1])), IDEAL, anchor=anchor)
    here = [step, np.interp(step, *way.T)]
    panel.grip("step", "the step, to be moved along the curve", here, 4, "estimated", 7)
    return panel
