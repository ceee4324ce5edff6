"""Explore the pinhole: a wide hole makes wide spots, and behind a small one light spreads."""

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics
from cvnotes.pictures import render_scene, room
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, LENS

Spectrum = npt.NDArray[np.complex128]

_F, _PIXEL, _LIGHT = 4.0, 0.005, 0.00055  # mm: behind the hole, a pixel, green light
_LENS = 2.0  # mm, as wide as the lens
_SIZE, _SHOWN = (640, 480), (440, 330)
_WIDEST, _HIGHEST = 0.4, 120.0  # mm, px
_ROOM = 2.5, 10.0, 5.0  # m: the nearest and the farthest that is seen, and one between
_DEEPEST = 17.0  # px
_PALE = "#EFEFEF"
_FRAME = 96  # px around the picture, so that nothing comes round from the other side


def pinhole_model() -> Model:
    """Make the model of a room, photographed through a hole or a lens."""
    settings = (
        Setting("hole", "hole (mm)", 0.01, _WIDEST, 0.001, 0.2, "the diameter of the hole"),
        Setting("lens", f"a lens of {_LENS:g} mm", 0, 1, 1, 0, "a lens in place of the hole"),
        Setting("focus", "focused at (m)", 0.1, 10, 0.05, 4, "the depth that the lens makes sharp"),
    )
    about = (
        "A room through a hole; beside it how many pixels wide the spot of a far lamp is, against "
        "the diameter: the hole itself, the spread of light, and their sum, which has a lowest "
        "point. With a lens: how wide the spot of a lamp is, against its depth."
    )

    @lru_cache(maxsize=1)
    def sharp() -> Spectrum:
        """Photograph the room as an ideal lens would; gives the picture's spectrum."""
        k = _SHOWN[0] / _SIZE[0]
        A = intrinsics(k * _F / _PIXEL, k * _F / _PIXEL, (_SHOWN[0] - 1) / 2, (_SHOWN[1] - 1) / 2)
        photo = render_scene(room(), Camera(A, size=_SHOWN), samples=16)
        framed = np.pad(photo.astype(float), ((_FRAME, _FRAME), (_FRAME, _FRAME), (0, 0)), "edge")
        return np.fft.rfft2(framed, axes=(0, 1))

    def draw(paper: Paper, values: Values) -> Drawing:
        d, focus = values["hole"], values["focus"]
        through = f"a hole of {d:g} mm"
        if values["lens"]:
            through, patch, d = "a lens", float(disc(_ROOM[2], focus)) * _PIXEL, _LENS
        else:
            patch = d
        panel = paper.picture_panel(_SHOWN, _SHOWN, f"the room through {through}")
        panel.image(spread_out(patch, d, sharp()))
        beside = _discs(paper, focus) if values["lens"] else _spots(paper, d)
        said = _said_of_a_lens(focus) if values["lens"] else _said_of_a_hole(d)
        return Drawing(paper.join((panel, beside)), said)

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


def spread_out(patch: float, d: float, spectrum: Spectrum) -> Drawn:
    """Spread each point by a patch, and by the diffraction of a hole: both weaken fine patterns."""
    h, w = spectrum.shape[0], 2 * (spectrum.shape[1] - 1)
    a_millimetre = _SHOWN[0] / _SIZE[0] / _PIXEL  # in pixels of what is shown
    waves = np.hypot(np.fft.fftfreq(h)[:, None], np.fft.rfftfreq(w)) * a_millimetre
    rho, turn = np.linspace(0, waves.max(), 600)[1:], np.linspace(0, 2 * np.pi, 400, endpoint=False)
    x, nu = np.pi * max(patch, 1e-6) * rho, np.minimum(rho * _LIGHT * _F / d, 1)
    bessel = np.cos(turn - x[:, None] * np.sin(turn)).mean(axis=1)  # J1, by Bessel's integral
    kept = 2 * bessel / x * 2 / np.pi * (np.arccos(nu) - nu * np.sqrt(1 - nu**2))
    kept = np.interp(waves, np.append(0, rho), np.append(1, kept))
    picture = np.fft.irfft2(spectrum * kept[..., None], (h, w), axes=(0, 1))
    inner = picture[_FRAME:-_FRAME, _FRAME:-_FRAME]
    return np.asarray(np.rint(inner.clip(0, 255)).astype(np.uint8))


def _spots(paper: Paper, d: float) -> Panel:
    """Draw how wide a spot is behind each hole."""
    panel = paper.panel(
        (410, 330), (-0.02, 0.43), (_HIGHEST, -8), "width of the spot (px) against the hole (mm)"
    )
    panel.ticks(x=(0, 0.1, 0.2, 0.3, 0.4), y=(0, 40, 80))
    holes = np.linspace(0.008, 0.43, 400)
    patch, spread = spot(holes)
    for name, curve, colour, at in (
        ("the hole", patch, LENS, (0.34, 58)),
        ("diffraction", spread, CAMERA, (0.25, 10)),
        ("both", patch + spread, IDEAL, (0.27, 72)),
    ):
        panel.line(np.column_stack([holes, curve]), colour, 1.8)
        panel.text(at, name, colour, size=12)
    here = [d, float(sum(spot(d)))]
    panel.grip("hole", "the diameter of the hole", here, 4)
    panel.mark(here, "estimated", 9)
    aside, anchor = (-0.008, "rm") if d > 0.1 else (0.012, "lm")
    panel.text([d + aside, here[1] + 9], f"{here[1]:.0f} px", ESTIMATED, anchor=anchor, size=13)
    return panel


def _discs(paper: Paper, focus: float) -> Panel:
    """Draw how wide the lens makes a point at each depth."""
    panel = paper.panel(
        (410, 330), (-1.14, 1.1), (_DEEPEST, -2.4), "width of the spot (px) against depth (m)"
    )
    near, far = np.log10(_ROOM[:2])
    panel.polygons([[[near, 0], [far, 0], [far, _DEEPEST], [near, _DEEPEST]]], _PALE)
    panel.text([(near + far) / 2, 13], "the room", anchor="mm", size=12)
    panel.ticks(y=(0, 5, 10))
    for s in (0.1, 0.2, 0.5, 1, 2, 5, 10):
        panel.text([np.log10(s), -1], f"{s:g} m", anchor="mm", size=10)
    s = np.geomspace(0.09, 12, 400)
    panel.line(np.column_stack([np.log10(s), disc(s, focus)]), LENS, 2)
    here = [np.log10(focus), 0]
    panel.mark(here, "estimated", 9)
    panel.text([here[0], 1.4], "sharp", ESTIMATED, anchor="mm", size=13)
    panel.grip("focus", "the depth that is sharp", here, 4)
    return panel


def _said_of_a_lens(focus: float) -> str:
    most = float(disc(np.array(_ROOM), focus).max())
    return (
        f"A lens of {_LENS:g} mm, focused at {focus:g} m: what is seen of the room lies between "
        f"2.5 and 10 m and becomes discs of at most {most:.1f} px. Diffraction adds "
        f"{spot(_LENS)[1]:.1f} px."
    )


def _said_of_a_hole(d: float) -> str:
    patch, spread = spot(d)
    return (
        f"A hole of {d:g} mm: its patch of light is {patch:.0f} px wide, and diffraction adds "
        f"{spread:.0f} px. A lens of {_LENS:g} mm has {(_LENS / d) ** 2:,.0f} times its light."
    )
