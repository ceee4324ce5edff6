"""Explore the pinhole: a wide hole throws a wide shadow, and behind a small one light spreads."""

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
_PALE = "#BBBBBB"  # of curves that do not count
_FRAME = 96  # px around the picture, so that nothing comes round from the other side


def pinhole_model() -> Model:
    """Make the model of a room, photographed through a hole or a lens."""
    settings = (
        Setting("hole", "hole (mm)", 0.01, _WIDEST, 0.001, 0.2, "the diameter of the hole"),
        Setting("lens", f"a lens of {_LENS:g} mm", 0, 1, 1, 0, "a lens in place of the hole"),
    )
    about = (
        "A room through a hole; beside it how many pixels wide the spot of a far lamp is, against "
        "the diameter: the hole's shadow, the spread of light, and their sum, which has a lowest "
        "point."
    )

    @lru_cache(maxsize=1)
    def sharp() -> tuple[Drawn, Spectrum]:
        """Photograph the room as a lens would; as a picture, and as its spectrum."""
        k = _SHOWN[0] / _SIZE[0]
        A = intrinsics(k * _F / _PIXEL, k * _F / _PIXEL, (_SHOWN[0] - 1) / 2, (_SHOWN[1] - 1) / 2)
        photo = render_scene(room(), Camera(A, size=_SHOWN), samples=16)
        framed = np.pad(photo.astype(float), ((_FRAME, _FRAME), (_FRAME, _FRAME), (0, 0)), "edge")
        return photo, np.fft.rfft2(framed, axes=(0, 1))

    def draw(paper: Paper, values: Values) -> Drawing:
        d, (photo, spectrum) = values["hole"], sharp()
        through = "a lens" if values["lens"] else f"a hole of {d:g} mm"
        panel = paper.picture_panel(_SHOWN, _SHOWN, f"the room through {through}")
        panel.image(photo if values["lens"] else behind_a_hole(d, spectrum))
        return Drawing(
            paper.join((panel, _spots(paper, d, bool(values["lens"])))),
            _sentence(d, bool(values["lens"])),
        )

    def pulled(_: Values, at: Array) -> Values:
        return {"hole": float(at[0]), "lens": 0}

    return Model("pinhole", about, settings, draw, {"hole": pulled})


def spot(d: Array | float) -> tuple[Array, Array]:
    """Return how wide a hole's shadow and the spread of its light are on the sensor, in pixels."""
    d = np.asarray(d, dtype=float)
    return d / _PIXEL, 2.44 * _LIGHT * _F / d / _PIXEL


def behind_a_hole(d: float, spectrum: Spectrum) -> Drawn:
    """Spread a picture by a hole's shadow and by diffraction: both weaken its fine patterns."""
    h, w = spectrum.shape[0], 2 * (spectrum.shape[1] - 1)
    a_millimetre = _SHOWN[0] / _SIZE[0] / _PIXEL  # in pixels of what is shown
    waves = np.hypot(np.fft.fftfreq(h)[:, None], np.fft.rfftfreq(w)) * a_millimetre
    rho, turn = np.linspace(0, waves.max(), 600)[1:], np.linspace(0, 2 * np.pi, 400, endpoint=False)
    x, nu = np.pi * d * rho, np.minimum(rho * _LIGHT * _F / d, 1)
    bessel = np.cos(turn - x[:, None] * np.sin(turn)).mean(axis=1)  # J1, by Bessel's integral
    kept = 2 * bessel / x * 2 / np.pi * (np.arccos(nu) - nu * np.sqrt(1 - nu**2))
    kept = np.interp(waves, np.append(0, rho), np.append(1, kept))
    picture = np.fft.irfft2(spectrum * kept[..., None], (h, w), axes=(0, 1))
    inner = picture[_FRAME:-_FRAME, _FRAME:-_FRAME]
    return np.asarray(np.rint(inner.clip(0, 255)).astype(np.uint8))


def _spots(paper: Paper, d: float, lens: bool) -> Panel:
    panel = paper.panel(
        (410, 330), (-0.02, 0.43), (_HIGHEST, -8), "width of the spot (px) against the hole (mm)"
    )
    panel.ticks(x=(0, 0.1, 0.2, 0.3, 0.4), y=(0, 40, 80))
    holes = np.linspace(0.008, 0.43, 400)
    shadow, spread = spot(holes)
    for name, curve, colour, at in (
        ("shadow", shadow, LENS, (0.34, 58)),
        ("diffraction", spread, CAMERA, (0.25, 10)),
        ("both", shadow + spread, IDEAL, (0.27, 72)),
    ):
        panel.line(np.column_stack([holes, curve]), _PALE if lens else colour, 1.8)
        panel.text(at, name, colour, size=12)
    here = [d, float(sum(spot(d)))]
    panel.grip("hole", "the diameter of the hole", here, 4)
    if lens:
        return panel
    panel.mark(here, "estimated", 9)
    aside, anchor = (-0.008, "rm") if d > 0.1 else (0.012, "lm")
    panel.text([d + aside, here[1] + 9], f"{here[1]:.0f} px", ESTIMATED, anchor=anchor, size=13)
    return panel


def _sentence(d: float, lens: bool) -> str:
    if lens:
        blur = _LENS * _F * (1 / 2500 - 1 / 4000) / _PIXEL
        return (
            f"A lens of {_LENS:g} mm brings the light of each point at one depth together again: "
            f"focused at 4 m, it makes a point at 2.5 m only {blur:.1f} px wide."
        )
    shadow, spread = spot(d)
    return (
        f"A hole of {d:g} mm: its shadow is {shadow:.0f} px wide, and diffraction adds "
        f"{spread:.0f} px. A lens of {_LENS:g} mm has {(_LENS / d) ** 2:,.0f} times its light."
    )
