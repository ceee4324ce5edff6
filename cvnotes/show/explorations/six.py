"""Explore the six numbers of a camera: what each does to the picture of a room."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens, intrinsics
from cvnotes.show.explorations.lens import bent_room
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED

_SIZE, _K2, _SIDE = (640, 480), 0.10, 0.2  # px of picture and panel; m, of a square 1 m away
_FAR = np.linspace(-1.2, 1.2, 97)
_NET = [line for at in _SIDE * np.arange(-6, 7) for line in ((_FAR, at), (at, _FAR))]
_CORNER = _SIDE * np.array([-2, -1])  # which crossing of the net is taken hold of
_FOOT, _TOP = np.array([0, 0, 1]), _SIDE * np.array([1, -1, 1 / _SIDE])  # of the square


def six_model() -> Model:
    """Make the model of a room, and of a net of squares, as a camera with five numbers sees them.

    The sixth, k2, stays: what it moves here cannot be seen.
    """
    px = "the focal length along the {}, px"
    settings = (
        Setting("alpha_u", "αᵤ (px)", 400, 900, 2, 800, px.format("rows")),
        Setting("alpha_v", "αᵥ (px)", 400, 900, 2, 804, px.format("columns")),
        Setting("u0", "u₀ (px)", 265, 385, 1, 325, "the principal point, from the left"),
        Setting("v0", "v₀ (px)", 188, 288, 1, 238, "the principal point, from above"),
        Setting("k1", "k₁", -0.4, 0.3, 0.01, -0.25, "how the lens bends"),
    )
    about = """The photograph of a room, and over it a net of squares of 20 cm, 1 m away: grey
    without the lens, blue with it. One square is orange, a cross marks the principal point."""

    def draw(paper: Paper, values: Values) -> Drawing:
        bare, camera = cameras(values)
        title = "grey without the lens, blue with it: pull the three rings"
        panel = paper.picture_panel(_SIZE, _SIZE, title)
        low, high = bare.ideal([[-0.5, -0.5], [_SIZE[0] - 0.5, _SIZE[1] - 0.5]]).tolist()
        x, y = zip(low, high, strict=True)
        panel.image(bent_room(camera.lens, x, y, _SIZE, paper.sharpness, 0.55))
        foot, top = bare.project([_FOOT, _TOP])
        square = np.array([foot, [top[0], foot[1]], top, [foot[0], top[1]]])
        panel.veil([square], ["#FBD9BF"])
        for eye, ink, width in ((bare, MUTED, 1), (camera, LENS, 2)):
            for line in _NET:
                points = np.stack([*np.broadcast_arrays(*line), 0 * _FAR + 1], axis=-1)
                panel.line(eye.project(points), ink, width)
        panel.line(square[[0, 1, 2, 3, 0]], ESTIMATED, 2.5)
        width, height = (top - foot) * [1, -1]
        panel.text((foot + top) / 2, f"{width:.0f} × {height:.0f} px", IDEAL, anchor="mm", size=18)
        crossing, bent = (eye.project([*_CORNER, 1]) for eye in (bare, camera))
        _pulled(panel, foot, top, bent)
        return Drawing(paper.join((panel,)), _sentence(values, camera, crossing, bent))

    def enlarged(values: Values, at: Array) -> Values:
        return placed("alpha_u", "alpha_v")(values, (at - [values["u0"], values["v0"]]) / _TOP[:2])

    def bending(values: Values, at: Array) -> Values:
        """Choose the k1 that shows the crossing where the hand is, along its ray."""
        bare, _ = cameras(values)
        r2 = float(_CORNER @ _CORNER)
        return {"k1": (float(bare.ideal(at) @ _CORNER) / r2 - 1 - _K2 * r2**2) / r2}

    drags = {"square": enlarged, "cross": placed("u0", "v0"), "net": bending}
    return Model("six", about, settings, draw, drags)


def cameras(values: Values) -> tuple[Camera, Camera]:
    """Return the camera without its lens, and with it."""
    A = intrinsics(*(values[name] for name in ("alpha_u", "alpha_v", "u0", "v0")))
    return Camera(A, size=_SIZE), Camera(A, lens=Lens(k=(values["k1"], _K2)), size=_SIZE)


def _pulled(panel: Panel, foot: Array, top: Array, crossing: Array) -> None:
    """Mark what can be pulled, with its name."""
    panel.mark(foot, "ideal", 13)
    panel.mark(top, "estimated", 9)
    panel.mark(crossing, "lens", 7)
    panel.text(foot + [0, 30], "principal point", IDEAL, anchor="mm", size=18)
    px = panel.pixel
    by, anchor = (18, "lm") if top[0] < _SIZE[0] - 140 * px else (-18, "rm")
    panel.text(top + [by * px, 0], "focal lengths", ESTIMATED, anchor=anchor, size=18)
    panel.text(np.maximum(crossing, 4) + [18 * px, 0], "k₁", LENS, size=18)
    panel.grip("square", "the corner of the square: both focal lengths", top, 2)
    panel.grip("cross", "the principal point", foot, 4)
    panel.grip("net", "a crossing of the bent net: k₁", crossing, 1)


def _sentence(values: Values, camera: Camera, bare: Array, bent: Array) -> str:
    middle = camera.A[:2, 2]
    far, seen = (float(np.linalg.norm(at - middle)) for at in (bare, bent))
    bends = f"{abs(far - seen):.0f} px {'inwards' if seen < far else 'outwards'}"
    return f"""Focal lengths {values["alpha_u"]:.0f} and {values["alpha_v"]:.0f} px, principal point
    ({values["u0"]:.0f}, {values["v0"]:.0f}) px, k₁ = {values["k1"]:g} and k₂ = {_K2:.2f}: the lens
    moves the blue crossing {bends}."""
