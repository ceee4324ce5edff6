"""Explore whose fault it is: a lens has it in the picture, and a board takes it along."""

from functools import partial

import numpy as np

from cvnotes.base import Array
from cvnotes.pictures import course
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.sheets import Believed
from cvnotes.show.style import ESTIMATED, LENS, MUTED, mixed

CULPRITS = "a lens", "a lens, in rings", "the board"
_PHOTO, _SHEET = (520, 390), (324, 181)  # px
_SIZE, _SCALE = np.array([640, 480]), 1.55  # of the picture in px; px per mm of the board
_MIDDLE = (_SIZE - 1) / 2
_WAVE = 0.2  # px
_ACROSS = np.array([[-0.008, 0.007], [-0.023, 0.020]])  # by how much each wave runs on, per px
_RINGS = 45  # px from the middle to where the rings' wave has run on by 1
_MAGNIFIED = 100
_DARK, _PALE = "#C9C9C9", "#ECECEC"


class Suspects:
    """Two lenses with waves in them, and the real sheet of paper: what one picture says of each.

    A picture tells nothing of a fault that looks like another pose or another camera, so of all
    shifts that part is left out which a homography makes.
    """

    def __init__(self) -> None:
        real = course.real_corners()
        self.corners = real.board.points[:, :2] - real.board.points[:, :2].mean(axis=0)  # mm
        (x, y), one, none = self.corners.T, np.ones(54), np.zeros(54)
        along_x = [one, x, y, none, none, none, x * x, x * y]
        along_y = [none, none, none, one, x, y, x * y, y * y]
        columns = np.stack([along_x, along_y], axis=-1).reshape(8, -1).T
        self._taken = np.linalg.qr(columns / np.linalg.norm(columns, axis=0))[0]
        self._paper = Believed(real.right).off["its shifts"][:, :2]

    def pixels(self, turn: float, aside: float = 0) -> Array:
        """Return where the corners (54, 2) of the board are seen, turned and moved so far."""
        return np.asarray(self.corners @ _turned(turn) * _SCALE + _MIDDLE + [aside, 0])

    def shifts(self, culprit: str, turn: float, aside: float = 0) -> Array:
        """Return how far one picture says that each corner (54, 2) lies beside its place, in mm."""
        if culprit == "the board":
            shifts = self._paper
        else:
            shifts = wave(culprit, self.pixels(turn, aside)) @ _turned(turn).T / _SCALE
        flat = shifts.ravel() - self._taken @ (self._taken.T @ shifts.ravel())
        return np.asarray(flat.reshape(-1, 2))

    def agreement(self, culprit: str, turn: float, aside: float = 0) -> Array:
        """Return how the shifts of a picture and of the first one are correlated, along X and Y."""
        first, told = self.shifts(culprit, 0), self.shifts(culprit, turn, aside)
        return np.array([np.corrcoef(first[:, axis], told[:, axis])[0, 1] for axis in (0, 1)])


def wave(culprit: str, m: Array) -> Array:
    """Return how far a bad lens shifts pixels (..., 2), in one of two ways."""
    x = m - _MIDDLE
    if culprit == "a lens":
        return np.asarray(_WAVE * np.sin(x @ _ACROSS + np.pi / 4))
    r = np.linalg.norm(x, axis=-1, keepdims=True)
    return np.asarray(_WAVE * np.sin(r / _RINGS) * x / r)  # (no pixel is at the middle)


def _turned(degrees: float) -> Array:
    """Return the matrix that turns rows, clockwise in a picture, whose v points down."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, s], [-s, c]])


def whose_model() -> Model:
    """Make the model of a board that is turned before a bad lens, or is bad itself."""
    suspects = Suspects()
    settings = (
        Setting("turn", "board turned by (°)", 0, 180, 1, 60, "clockwise in the picture"),
        Setting("aside", "moved by (px)", -120, 120, 5, 0, "to the right in the picture"),
        Setting("culprit", "to blame", 1, 3, 1, 1, "what shifts the corners", names=CULPRITS),
    )
    about = """A picture of a board, arrows from where its corners should be to where they are seen,
    a hundred times as long. Beside it the sheet of paper as a first picture tells it, at 0° in the
    middle, blue, and as this picture tells it, orange."""

    def pulled(values: Values, at: Array) -> Values:
        (x0, y0), (x, y) = suspects.corners[0], at - _MIDDLE - [values["aside"], 0]
        turn = np.degrees(np.arctan2(y, x) - np.arctan2(y0, x0))
        return {"turn": float((turn + 90) % 360 - 90)}  # what is beyond an end is held there

    drags = {"corner": pulled, "middle": lambda _, at: {"aside": float(at[0] - _MIDDLE[0])}}
    return Model("whose", about, settings, partial(_draw, suspects), drags)


def _draw(suspects: Suspects, paper: Paper, values: Values) -> Drawing:
    culprit, *placed = CULPRITS[int(values["culprit"]) - 1], values["turn"], values["aside"]
    first, told = suspects.shifts(culprit, 0), suspects.shifts(culprit, *placed)
    m = suspects.pixels(*placed)
    photo = paper.picture_panel(_PHOTO, (640, 480), f"the picture; arrows × {_MAGNIFIED}")
    _squares(photo, m, _DARK)
    if culprit != "the board":
        every = np.reshape(np.meshgrid(*(np.arange(20, n, 40) for n in _SIZE)), (2, -1)).T
        shifts = _MAGNIFIED * wave(culprit, every)
        photo.arrows(every, shifts, mixed(LENS, "#FFFFFF", 0.6), 1)
    photo.arrows(m, _MAGNIFIED * _SCALE * told @ _turned(placed[0]), ESTIMATED, 1.6)
    photo.grip("corner", "the board's first corner, to be pulled round", m[0], 3)
    photo.grip("middle", "the board's middle, to be pulled aside", m.mean(axis=0), 3)
    column = []
    for shifts, ink, name in (
        (first, LENS, "the sheet, by the first picture: 0°, in the middle"),
        (told, ESTIMATED, "the sheet, by this picture"),
    ):
        panel = paper.panel(_SHEET, (-180, 180), (-100.5, 100.5), name)
        _squares(panel, suspects.corners + _MAGNIFIED * shifts, ink)
        panel.line(suspects.corners[[0, 8, 53, 45, 0]], MUTED, 1, dash=3)
        column.append(panel)
    along_x, along_y = suspects.agreement(culprit, *placed)
    alike = f"{along_x:.2f} along X and {along_y:.2f} along Y"
    said = f"At {placed[0]:g}° and {placed[1]:g} px the two sheets are correlated by {alike}."
    return Drawing(paper.join((photo, column)), said)


def _squares(panel: Panel, corners: Array, ink: str) -> None:
    """Draw the squares between corners (54, 2): dark ones in ink, and light ones."""
    grid = corners.reshape(6, 9, 2)
    for j, i in np.ndindex(5, 8):
        square = grid[[j, j, j + 1, j + 1], [i, i + 1, i + 1, i]]
        panel.polygons([square], ink if (i + j) % 2 == 0 else _PALE)
