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
from cvnotes.camera import Camera, Lens
from cvnotes.homography import dlt
from cvnotes.pictures import course
from cvnotes.show.explorations.boards import draw_measured
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.strokes import clipped
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED, mixed

_STEPS = 3
_LONGEST = 0.12  # of the board's width in the photograph: so long is a frame's longest arrow
_PALE = mixed(ESTIMATED, "#FFFFFF", 0.55)  # of arrows that leave their frame
_FRAMES, _CURVE = (456, 304), (394, 304)


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
        whole = min(int(step), _STEPS - 1)
        shared, poses = self._strides[whole]
        part = step - whole
        x: State = take_step(self.states[whole], (part * shared, part * poses))
        camera = self.problem.camera_of(x.shared)
        return camera, self.problem.residuals(camera, x)

    @cached_property
    def enlarged(self) -> Array:
        """How much longer than true the arrows of each photograph are after each step, (12, 4)."""
        missed = np.array([self.at(step)[1] for step in range(_STEPS + 1)])
        longest = _LONGEST * np.ptp(self.m, axis=1).max(axis=-1)
        times = longest[:, None] / np.linalg.norm(missed, axis=-1).max(axis=-1).T
        tens = 10 ** np.floor(np.log10(times))
        return np.asarray(tens * np.rint(times / tens))  # a number of one digit, and noughts

    @cached_property
    def way(self) -> Array:
        """Steps and the RMS there, (n, 2)."""
        steps = np.linspace(0, _STEPS, 30 * _STEPS + 1)
        return np.array([[step, rms(self.at(float(step))[1])] for step in steps])


def rms(misses: Array) -> float:
    """Return the root mean square of misses (..., 2), per point."""
    return float(np.sqrt(np.mean(np.sum(misses**2, axis=-1))))


def finding_model() -> Model:
    """Make the model of a photograph's misses while the camera is found."""
    finding = Finding()
    n = len(finding.m) - 1
    settings = (
        Setting("step", "step", 0, _STEPS, 0.05, 0, "steps of the refinement, parts of them too"),
        Setting("photograph", "photograph", 0, n, 1, 2, "which of the twelve photographs"),
    )
    about = (
        "The corners of one photograph, four times on the way from the closed form to the answer, "
        "with arrows to where the camera predicts them. Beside them how far all corners are "
        "missed: 3.73 px at the start, 0.374, 0.028 and 0.008 px after the steps."
    )

    drags = {"step": lambda _, at: {"step": float(at[0])}}
    return Model("finding", about, settings, partial(_draw, finding), drags)


def _draw(finding: Finding, paper: Paper, values: Values) -> Drawing:
    step, i = values["step"], int(values["photograph"])
    camera, misses = finding.at(step)
    frames = _frames(paper, finding, step, i)
    curve = _curve(paper, finding, step, camera)
    value = camera.parameters
    missed = rms(misses)
    sentence = (
        f"After {step:g} of {_STEPS} steps k₁ = {value['k1']:+.3f} and u₀ = {value['u0']:.1f} px; "
        f"the {misses[..., 0].size} corners are missed by {_digits(missed)} px. "
        f"Neighbouring arrows of all photographs agree by {alike(misses):.2f} of 1."
    )
    return Drawing(paper.join((frames, curve)), sentence)


def _frames(paper: Paper, finding: Finding, step: float, i: int) -> Panel:
    """Draw a photograph's corners four times: what is missed at the start and after each step.

    A frame whose step has begun shows how far it has come; later ones have no arrows yet. Each
    keeps its scale, so that its arrows become shorter.
    """
    panel = paper.panel(_FRAMES, (0, 4), (0, 4), f"photograph {i} four times: its misses enlarged")
    panel.segments([[[2, 0], [2, 4]], [[0, 2], [4, 2]]], MUTED, 1)
    low, high = finding.m[i].min(axis=0), finding.m[i].max(axis=0)
    unit = 1.47 * ((high - low) / _FRAMES).max() * np.array(_FRAMES) / 2  # half a frame
    for frame in range(_STEPS + 1):
        middle = np.array([1 + 2 * (frame % 2), 1.09 + 2 * (frame // 2)])
        m = middle + (finding.m[i] - (low + high) / 2) / unit
        draw_measured(panel, m, course.board())
        if step > frame - 1:
            camera, misses = finding.at(min(step, frame))
            times = finding.enlarged[i, frame]
            corner = middle // 2 * 2
            _draw_within(panel, (corner, corner + 2), m, -times * misses[i] / unit)
            k1 = f"k₁ = {camera.parameters['k1']:+.3f}".replace("-", "−")
            panel.text(
                middle + [-0.96, -0.9], f"all: {_digits(rms(misses))} px", ESTIMATED, size=16
            )
            panel.text(middle + [0.96, -0.9], k1, anchor="rm", size=14)
            panel.text(middle + [-0.96, 0.82], f"× {times:.0f}", size=12)
        else:
            panel.text(middle + [-0.96, -0.9], f"step {frame}: not yet", size=14)
    return panel


def _draw_within(panel: Panel, frame: tuple[Array, Array], starts: Array, ways: Array) -> None:
    """Draw arrows in a frame; those that lead beyond it are pale, and end at its border."""
    low, high = frame
    ends = starts + ways
    within = ((ends > low) & (ends < high)).all(axis=1)
    panel.segments(clipped(starts[~within], ends[~within], frame), _PALE, 1)
    panel.arrows(starts[within], ways[within], ESTIMATED, 1.2)


def _digits(pixels: float) -> str:
    return f"{pixels:.2f}" if pixels >= 1 else f"{pixels:.3f}"


def alike(misses: Array) -> float:
    """Return how far neighbouring misses (n, 54, 2) agree along the rows: 1 if alike, 0 if not."""
    rows = misses.reshape(len(misses), *course.board().corners[::-1], 2)
    one, next_ = rows[:, :, :-1], rows[:, :, 1:]
    return float((one * next_).sum() / np.sqrt((one**2).sum() * (next_**2).sum()))


def _curve(paper: Paper, finding: Finding, step: float, camera: Camera) -> Panel:
    """Draw the RMS over the steps, with a logarithmic scale, and the camera of this step."""
    panel = paper.panel(
        _CURVE, (-0.35, _STEPS + 0.5), (1.3, -2.9), "RMS of all corners (px) against steps"
    )
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
    panel.mark(here, "estimated", 7)
    panel.grip("step", "the step, to be moved along the curve", here, 4)
    names = (("αᵤ", "alpha_u", ".1f"), ("u₀", "u0", ".1f"), ("k₁", "k1", "+.3f"))
    for row, (label, name, how) in enumerate(names):
        number = f"{camera.parameters[name]:{how}}".replace("-", "−")
        colour = ESTIMATED if name == "k1" else MUTED
        panel.text([1.7, 1.0 - 0.34 * row], f"{label} = {number}", colour, size=15)
    return panel
