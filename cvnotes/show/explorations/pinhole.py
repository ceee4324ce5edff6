"""Explore the pinhole: a wide hole makes wide spots, and behind a small one light spreads."""

from functools import lru_cache

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from cvnotes.base import Array, luma
from cvnotes.camera import Camera, intrinsics, pose, rotation_from_vector
from cvnotes.pictures import render_scene, room
from cvnotes.pictures.posters import chart
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper, circle
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, LENS, MUTED

Spectrum = npt.NDArray[np.complex128]

_F, _PIXEL, _LIGHT = 4.0, 0.005, 0.00055  # mm: behind the hole, a pixel, green light
_LENS = 2.0  # mm, as wide as the lens
_SIZE, _SHOWN = (640, 480), (440, 330)
_WIDEST, _HIGHEST = 0.4, 120.0  # mm, px
_ROOM = 2.5, 10.0, 5.0  # m: the nearest and the farthest that is seen, and one between
_CARD = 0.2  # m: its depth
_DEEPEST = 17.0  # px
_PALE, _LIT = "#EFEFEF", "#D7E7F3"
_HOLE, _SENSOR, _EDGE = 150, 330, 34  # px of the side view: where they are; half of the lens
_ACROSS = 0.85, 3  # px there for a pixel of the sensor, behind a hole and behind the lens
# px around the picture, so that nothing comes round from the other side; 540 and 640 in all, whose
# Fourier transforms are quick.
_FRAME = (105, 105), (100, 100)


def pinhole_model() -> Model:
    """Make the model of a room, photographed through a hole or a lens."""
    settings = (
        Setting("hole", "hole (mm)", 0.01, _WIDEST, 0.001, 0.2, "the diameter of the hole"),
        Setting("lens", f"a lens {_LENS:g} mm wide", 0, 1, 1, 0, "a lens in place of the hole"),
        Setting("focus", "focus of the lens (m)", 0.1, 10, 0.05, 4,
                "the depth that the lens makes sharp; a hole has none"),
    )  # fmt: skip
    about = """A room and a near card through a hole; beside it how many pixels wide the spot of a
    far lamp is, against the diameter: the hole itself, the spread of light, and their sum, which
    has a lowest point. With a lens: how wide the spot of a lamp is, against its depth. Below, the
    rays that make the spot, from the side."""

    def draw(paper: Paper, values: Values) -> Drawing:
        d, focus = values["hole"], values["focus"]
        through = f"a hole of {d:g} mm"
        if values["lens"]:
            through, d = "a lens", _LENS
            patches = disc(np.array([_ROOM[2], _CARD]), focus) * _PIXEL
        else:
            patches = np.array([d, d])
        panel = paper.picture_panel(_SHOWN, _SHOWN, f"the room through {through}")
        panel.image(photographed(patches, d))
        beside = _discs(paper, focus) if values["lens"] else _spots(paper, d)
        said = _said_of_a_lens(focus) if values["lens"] else _said_of_a_hole(d)
        side = paper.panel((410, 105), (0, 410), (52.5, -52.5), "from the side, stretched across")
        side.line([[_SENSOR, -60], [_SENSOR, 60]], MUTED, 2)
        side.text([_SENSOR + 12, -42], "sensor", MUTED, size=13)
        if values["lens"]:
            _draw_lens(side, focus)
        else:
            _draw_hole(side, d)
        return Drawing(paper.join((panel, [beside, side])), said)

    drags = {
        "hole": lambda _, at: {"hole": float(at[0]), "lens": 0},
        "focus": lambda _, at: {"focus": float(10 ** np.clip(at[0], -1, 1))},
    }
    return Model("pinhole", about, settings, draw, drags)


def spot(d: Array | float) -> tuple[Array, Array]:
    """Return how wide a hole and the spread of its light are on the sensor, in pixels."""
    d = np.asarray(d, dtype=float)
    return d / _PIXEL, 2.44 * _LIGHT * _F / d / _PIXEL


def disc(s: Array | float, focus: float) -> Array:
    """Return how wide (px) the lens makes a point s metres away, focused at others."""
    return np.asarray(_LENS * _F / 1000 * np.abs(1 / np.asarray(s) - 1 / focus) / _PIXEL)


@lru_cache(maxsize=1)
def _sharp() -> tuple[Spectrum, Spectrum]:
    """Photograph room and card as an ideal lens would; gives the spectra of both, (channels, …).

    The card is grey, and has a second channel: how much of each pixel it covers.
    """
    k = _SHOWN[0] / _SIZE[0]
    A = intrinsics(k * _F / _PIXEL, k * _F / _PIXEL, (_SHOWN[0] - 1) / 2, (_SHOWN[1] - 1) / 2)
    # A chart of 594 mm ten times as far away looks like a card of 59 mm.
    held = pose(rotation_from_vector([0, 0, -0.12]), [-720, -10, 10_000 * _CARD])
    card = Camera(A, held, size=_SHOWN)
    corners = card.project(chart().vertices[:4])
    mask = Image.new("L", (4 * _SHOWN[0], 4 * _SHOWN[1]))
    ImageDraw.Draw(mask).polygon((4 * corners + 2).ravel().tolist(), fill=255)
    covered = np.asarray(mask.resize(_SHOWN, Image.Resampling.BOX)) / 255
    layers = (
        np.moveaxis(render_scene(room(), Camera(A, size=_SHOWN)), 2, 0),
        np.stack([covered * luma(render_scene(chart(), card)), covered]),
    )
    far, near = (np.fft.rfft2(np.pad(x.astype(float), ((0, 0), *_FRAME), "edge")) for x in layers)
    return far, near


def photographed(patches: Array, d: float) -> Drawn:
    """Photograph the room, and before it the card: each with its own patch of light."""
    lights = zip(patches.tolist(), _sharp(), strict=True)
    room, card = (spread_out(patch, d, each) for patch, each in lights)
    seen = room * (1 - card[1]) + card[0]
    return np.moveaxis(np.rint(seen.clip(0, 255)).astype(np.uint8), 0, 2)


def spread_out(patch: float, d: float, spectrum: Spectrum) -> Array:
    """Spread each point by a patch, and by the diffraction of a hole: both weaken fine patterns."""
    h, w = spectrum.shape[-2], 2 * (spectrum.shape[-1] - 1)
    a_millimetre = _SHOWN[0] / _SIZE[0] / _PIXEL  # in pixels of what is shown
    waves = np.hypot(np.fft.fftfreq(h)[:, None], np.fft.rfftfreq(w)) * a_millimetre
    rho, turn = np.linspace(0, waves.max(), 600)[1:], np.linspace(0, 2 * np.pi, 200, endpoint=False)
    x, nu = np.pi * max(patch, 1e-6) * rho, np.minimum(rho * _LIGHT * _F / d, 1)
    bessel = np.cos(turn - x[:, None] * np.sin(turn)).mean(axis=1)  # J1, by Bessel's integral
    kept = 2 * bessel / x * 2 / np.pi * (np.arccos(nu) - nu * np.sqrt(1 - nu**2))
    kept = np.interp(waves, np.append(0, rho), np.append(1, kept))
    (top, _), (left, _) = _FRAME
    picture = np.fft.irfft2(spectrum * kept)
    return np.asarray(picture[..., top:-top, left:-left])


def _spots(paper: Paper, d: float) -> Panel:
    """Draw how wide a spot is behind each hole."""
    title = "width of the spot (px) against the hole (mm)"
    panel = paper.panel((410, 197), (-0.02, 0.43), (_HIGHEST, -18), title)
    panel.ticks(x=(0, 0.1, 0.2, 0.3, 0.4), y=(0, 40, 80), size=12)
    holes = np.linspace(0.008, 0.43, 400)
    patch, spread = spot(holes)
    for name, curve, colour, at in (
        ("the hole", patch, LENS, (0.34, 58)),
        ("diffraction", spread, CAMERA, (0.25, 10)),
        (f"both: {sum(spot(d)):.0f} px", patch + spread, IDEAL, (0.3, 100)),
    ):
        panel.line(np.column_stack([holes, curve]), colour, 1.8)
        panel.text(at, name, colour, size=13)
    here = [d, float(sum(spot(d)))]
    panel.grip("hole", "the diameter of the hole", here, 4)
    panel.mark(here, "estimated", 9)
    return panel


def _discs(paper: Paper, focus: float) -> Panel:
    """Draw how wide the lens makes a point at each depth."""
    title = "width of the spot (px) against depth (m)"
    panel = paper.panel((410, 197), (-1.14, 1.1), (_DEEPEST, -3.4), title)
    near, far = np.log10(_ROOM[:2])
    panel.polygons([[[near, 0], [far, 0], [far, _DEEPEST], [near, _DEEPEST]]], _PALE)
    panel.text([(near + far) / 2, 13], "the room", anchor="mm", size=13)
    panel.ticks(y=(5, 10), size=12)
    panel.line([[-1.14, 1], [1.1, 1]], IDEAL, 0.8, dash=3)
    at, anchor = ((1.05, 1.6), "rm") if focus < 2 else ((-1.1, 1.6), "lm")
    panel.text(at, "1 px", IDEAL, anchor=anchor, size=13)
    panel.line(np.log10(_CARD) + np.array([[0, 0], [0, _DEEPEST]]), _PALE, 8)
    panel.text([np.log10(_CARD), 15.5], "the card", anchor="mm", size=13)
    for s in (0.1, 0.2, 0.5, 1, 2, 5, 10):
        panel.text([np.log10(s), -2.2], f"{s:g} m", anchor="mm", size=12)
    s = np.geomspace(0.09, 12, 400)
    panel.line(np.column_stack([np.log10(s), disc(s, focus)]), LENS, 2)
    here = [np.log10(focus), 0]
    panel.mark(here, "estimated", 9)
    panel.text([min(here[0], 0.96), 2.6], "sharp", ESTIMATED, anchor="mm", size=13)
    panel.grip("focus", "the depth that is sharp", here, 4)
    return panel


def _draw_hole(panel: Panel, d: float) -> None:
    """Draw the light of a far lamp, and how it spreads behind the hole."""
    patch, spread = (_ACROSS[0] / 2 * float(width) for width in spot(d))
    panel.polygons([np.array([[0, -1], [_SENSOR, -1], [_SENSOR, 1], [0, 1]]) * [1, patch]], _LIT)
    for side in (-1, 1):
        panel.line([[0, side * patch], [_SENSOR, side * patch]], LENS, 1)
        ends = [[_HOLE, side * patch], [_SENSOR, side * (patch + spread)]]
        panel.line(ends, CAMERA, 1.2, dash=4)
        panel.line([[_HOLE, side * patch], [_HOLE, side * 60.0]], IDEAL, 4)
    panel.line([[_SENSOR, -patch - spread], [_SENSOR, patch + spread]], ESTIMATED, 7)
    panel.text([6, -42], "light of a far lamp", LENS, size=13)


def _draw_lens(panel: Panel, focus: float) -> None:
    """Draw the rays through the lens's edges, of a point of the card and of one in the room."""
    rim = circle(61) * [8, _EDGE + 6]
    panel.polygons([rim + [_HOLE, 0]], _PALE)
    points = ((_CARD, CAMERA, (14.0, 0.0)), (_ROOM[2], ESTIMATED, (0.0, _EDGE)))
    for s, colour, (x, y) in sorted(points, key=lambda point: -disc(point[0], focus)):
        # What is farther than the focus meets before the sensor: there its rays have crossed.
        end = _ACROSS[1] / 2 * float(disc(s, focus)) * np.sign(focus - s)
        for side in (-1, 1):
            way = np.array([[x, y], [_HOLE, _EDGE], [_SENSOR, end]])
            panel.line(way * [1, side], colour, 1.2)
        panel.line([[_SENSOR, -abs(end) - 1], [_SENSOR, abs(end) + 1]], colour, 7)
    panel.line(rim + [_HOLE, 0], LENS, 1.5)
    panel.text([6, -44], f"the room, {_ROOM[2]:g} m", ESTIMATED, size=13)
    panel.text([22, 0], "the card", CAMERA, size=13)


def _said_of_a_lens(focus: float) -> str:
    near, far = (float(disc(np.array(s), focus).max()) for s in (_CARD, _ROOM))
    return f"""A lens {_LENS:g} mm wide, focused at {focus:g} m: the card, {_CARD:g} m away, becomes
    discs of {near:.2f} px, the room, 2.5 to 10 m away, of at most {far:.2f} px. Diffraction adds
    {spot(_LENS)[1]:.1f} px."""


def _said_of_a_hole(d: float) -> str:
    patch, spread = spot(d)
    return f"""A hole of {d:g} mm: its patch of light is {patch:.1f} px wide, and diffraction adds
    {spread:.1f} px. A lens {_LENS:g} mm wide has {(_LENS / d) ** 2:,.0f} times its light."""
