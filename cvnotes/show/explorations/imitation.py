"""Explore what a pose imitates of the camera: what is left of its arrow, and the bowl it makes."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, INK, MUTED, WORLD, mixed

_CAMERA = np.array([1.0, 1.0])  # Jc: the residuals of a corner, when the camera's unknown is 1
_ACROSS, _DOWN, _SIDE = (-1.3, 1.7), (-1.3, 1.5), (420, 392)  # of the residuals; px
# Of the bowls: how far a goes, where their panel begins at the left, its top and its foot.
_FAR, _LEFT, _TOP, _FOOT = 2.2, -3.7, 4.3, -1.75
_VIEWS = ((1, mixed("#FFFFFF", ESTIMATED, 0.5), -0.76), (4, ESTIMATED, -1.38))  # ink, and its bar


def imitation_model() -> Model:
    """Make the model of a corner that a camera and a pose move, and of the squares left over."""
    settings = (
        Setting("turn", "direction of Jp (°)", -180, 180, 3, 0, "where the pose moves the corner"),
    )
    about = """A corner of a board, and three arrows: Jc, where the camera's unknown moves it, Jp,
    where the pose can move it, along a dashed line, and N, what the pose leaves of Jc. Beside it
    the squares left over, for one view and for four: two bowls, and bars as wide as they are at the
    height 1."""

    def draw(paper: Paper, values: Values) -> Drawing:
        J_p, answer, N = parted(values["turn"])
        corner = paper.panel(_SIDE, _ACROSS, _DOWN, "a corner of a board: pull the green arrow")
        _draw_corner(corner, J_p, answer, N)
        title = "the squares left, over a"
        bowls = paper.panel((440, _SIDE[1]), (_LEFT, _FAR), (_TOP, _FOOT), title)
        _draw_bowls(bowls, float(N @ N))
        return Drawing(paper.join((corner, bowls)), _sentence(values["turn"], N))

    drags = {"pose": lambda _, at: {"turn": np.degrees(np.arctan2(at[1], at[0]))}}
    return Model("imitation", about, settings, draw, drags)


def parted(turn: float) -> tuple[Array, Array, Array]:
    """Return Jp of length 1, the pose's answer to Jc, and N, what it leaves; (2,) each."""
    J_p = np.array([np.cos(np.radians(turn)), np.sin(np.radians(turn))])
    answer = -(_CAMERA @ J_p) * J_p
    N = np.where(np.abs(_CAMERA + answer) < 1e-12, 0, _CAMERA + answer)
    return J_p, answer, N


def _draw_corner(panel: Panel, J_p: Array, answer: Array, N: Array) -> None:
    """Draw the triangle of Jc, the answer and N over a pale corner; names stand outside of it."""
    right, down = np.array([[3.0, -0.4], [-0.5, 3.0]])
    panel.polygons([[[0, 0], right, down], [[0, 0], -right, -down]], "#EEEEE9")
    for name, way in (("u", (0.3, 0)), ("v", (0, 0.3))):
        panel.arrows([-1.21, -1.21], way, MUTED, 1.2)
        panel.text(np.array([-1.21, -1.21]) + 1.25 * np.array(way), name, anchor="mm", size=14)
    for start in (np.zeros(2), _CAMERA):
        panel.line(start + np.outer([-4, 4], J_p), INK[WORLD], 1, dash=5)
    panel.arrows([0, 0], _CAMERA, CAMERA, 6)
    panel.arrows([0, 0], J_p, WORLD, 4)
    panel.arrows(_CAMERA, answer, WORLD, 2.4)
    panel.arrows([0, 0], N, ESTIMATED, 5)
    across = np.array([-J_p[1], J_p[0]]) * (1 if _CAMERA @ [-J_p[1], J_p[0]] >= 0 else -1)
    for at, index, ink in ((1.13 * _CAMERA, "c", CAMERA), (J_p - 0.2 * across, "p", WORLD)):
        panel.text(at, "J", ink, anchor="rs", size=19)
        panel.text(at + [0.01, 0.04], index, ink, anchor="ls", size=15)
    back = _CAMERA @ J_p * J_p
    aside = -back / np.linalg.norm(back) if answer.any() else across[::-1] * [1, -1]
    if N.any():
        panel.text(N / 2 + 0.14 * aside, "N", ESTIMATED, anchor="mm", size=19)
    else:
        panel.text([-0.1, 0.14], "N = 0", ESTIMATED, anchor="rm", size=19)
    if np.linalg.norm(answer) > 0.5:
        anchor = "lm" if across[0] > 0.5 else "rm" if across[0] < -0.5 else "mm"
        panel.text(_CAMERA - back / 2 + 0.12 * across, "answer", WORLD, anchor=anchor, size=14)
    panel.grip("pose", "the tip of Jp, where the pose moves the corner", J_p, 7)


def _draw_bowls(panel: Panel, square: float) -> None:
    """Draw both bowls, and below them how wide they are at the height 1."""
    a = np.linspace(-_FAR, _FAR, 181)
    for views, ink, _ in _VIEWS:
        bowl = np.column_stack([a, np.minimum(views * square * a**2, _TOP)])
        panel.polygons([[[-_FAR, _TOP], *bowl, [_FAR, _TOP]]], mixed("#FFFFFF", ink, 0.2))
    for height in (0, 1):
        panel.line([[-_FAR, height], [_FAR, height]], MUTED, 1, dash=0 if height == 0 else 4)
        panel.text([-_FAR - 0.1, height], f"{height}", IDEAL, anchor="rm", size=14)
    for number in (-2, -1, 0, 1, 2):
        panel.text([number, -0.23], f"{number}", anchor="mm", size=13)
    for views, ink, row in _VIEWS:
        panel.line(np.column_stack([a, views * square * a**2]), ink, 2.6)
        wide = (views * square) ** -0.5 if square else np.inf
        if wide <= _FAR:
            for end in (-wide, wide):
                panel.line([[end, 1], [end, row]], ink, 1, dash=3)
        panel.line([[-min(wide, _FAR), row], [min(wide, _FAR), row]], ink, 17)
        name = "1 view" if views == 1 else f"{views} views"
        panel.text([_LEFT + 0.06, row], f"{name} ± {_told(wide)}", ESTIMATED, size=14)


def _told(wide: float) -> str:
    return "∞" if wide == np.inf else f"{wide:.2f}" if wide < 9.995 else f"{wide:.1f}"


def _sentence(turn: float, N: Array) -> str:
    if not N.any():
        return f"""Jp at {turn:g}°, along Jc: N = (0, 0). The pose imitates the camera, and a stays
        unknown, however many the views."""
    x, y = N.round(2) + 0.0
    wide = float(1 / np.linalg.norm(N))
    return f"""Jp at {turn:g}°: N = ({x:.2f}, {y:.2f}), its square {N @ N:.2f}. One view tells a to
    ± {_told(wide)}, four to ± {_told(wide / 2)}."""
