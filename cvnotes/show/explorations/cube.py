"""Explore a calibrated camera: a tower stands on a photographed board, and with a wrong one not."""

from functools import lru_cache
from itertools import product

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

from cvnotes.base import Array
from cvnotes.calibration import pose_from_view
from cvnotes.camera import Camera, Lens, intrinsics, inverse, look_at, move, xy_from_px
from cvnotes.pictures import course, desk, render_scene
from cvnotes.pictures.scenes import DESK_LIGHT
from cvnotes.projective import to_homogeneous
from cvnotes.show.explorations.boards import draw_sheet, paper_and_squares, pinhole
from cvnotes.show.explorations.model import Drag, Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, hexed, mixed
from cvnotes.targets import refine_subpixel

_BOARD = course.board()
_SQUARE = _BOARD.square  # mm
_ALPHA, _PANE = 1150, 130  # px, the focal length; mm, how far before the camera its pane is drawn
_CAMERA = Camera(
    intrinsics(_ALPHA, _ALPHA, 639.5, 479.5),
    look_at([165, 400, -300], [95, 70, -22]),
    lens=Lens(k=(-0.25, 0.1)),
    size=(1280, 960),
)
_BESIDE = Camera(  # the same from the side
    intrinsics(1500, 1500, 539.5, 404.5),
    look_at([1080, 560, -430], [118, 205, -128], up=(0, 0, -1)),
    size=(1080, 810),
)
_GLASS, _EDGE = "#E3F1FB", mixed("#FFFFFF", CAMERA, 0.8)
_BORDER, _SQUARES = paper_and_squares(_BOARD)
_LIGHT = np.array(DESK_LIGHT) / np.linalg.norm(DESK_LIGHT)
_SUN, _SKY = np.array([0.80, 0.72, 0.60]), np.array([0.54, 0.54, 0.60])  # warm and cool light
_BRICK, _STONE = np.array([246.0, 132, 54]), np.array([228.0, 172, 116])
_PANES, _FRAME = np.array([44.0, 60, 84]), np.array([255.0, 226, 190])
_ARCH = np.array([[-3.2, -5], [3.2, -5], [3.2, 2], [2.3, 4.3], [0, 5.2], [-2.3, 4.3], [-3.2, 2]])
_COURSE, _STOREY = 5, 24  # mm, how high a row of bricks is, and a row of windows
_EDGES = [(i, (i + 1) % 4 + i // 4 * 4) for i in range(8)] + [(i, i + 4) for i in range(4)]
_SIDES = [[i + 3, i + 4, i, i - 1] for i in range(1, 4)]
_FACES = np.array([[4, 5, 6, 7], [7, 4, 0, 3], *_SIDES])  # the roof, and the sides
_SHADED, _SOFT = 0.42, 8  # what a shadow leaves of the light; px of its edge


@lru_cache(maxsize=2)
def photo(aside: bool = False) -> Image.Image:
    """Photograph the desk, by the camera or from the side."""
    return Image.fromarray(render_scene(desk(_BOARD), _BESIDE if aside else _CAMERA))


@lru_cache(maxsize=2)
def found(lens: bool) -> Camera:
    """Return the camera with the pose that is found from its photograph, with or without its lens.

    On a page there is no OpenCV, and so no finder of boards: whole pixels are its start.
    """
    grey = np.asarray(photo()).mean(axis=2)
    m = refine_subpixel(grey, _CAMERA.project(_BOARD.points).round())
    bare = Camera(_CAMERA.A, lens=_CAMERA.lens if lens else Lens(), size=_CAMERA.size)
    return bare.moved(pose_from_view(bare, _BOARD.points, m))


def believed(values: Values) -> Camera:
    """Return the camera that draws: as it is found, or pulled along its axis, or longer."""
    right = found(bool(values["lens"]))
    G, k = right.G.copy(), values["alpha"] / _ALPHA
    G[2, 3] += values["away"]
    A = right.A * [[k, 1, 1], [1, k, 1], [1, 1, 1]]
    return Camera(A, G, lens=right.lens, size=right.size)


def cube_model() -> Model:
    """Make the model of a desk with a board, and a tower on it."""
    columns, rows = _BOARD.corners
    settings = (
        Setting("x", "x (mm)", -50, columns * _SQUARE + 25, 1, 50, "where the tower stands"),
        Setting("y", "y (mm)", -50, rows * _SQUARE + 25, 1, 25, "where the tower stands"),
        Setting("height", "height (mm)", 20, 150, 1, 100, "how high the tower is"),
        Setting("away", "camera (mm)", -200, 60, 1, 0, "how much too far away the camera is"),
        Setting("alpha", "α (px)", 600, 1700, 10, _ALPHA, "the focal length"),
        Setting("lens", "with the lens", 0, 1, 1, 1, "whether the camera's lens is used"),
    )
    about = """A photograph of a desk with a board, and a tower that stands on the board, drawn by
    the camera that was found from the board's corners. Beside it desk, tower and camera from the
    side, with lines of sight to foot and top through the pane of its picture."""

    def draw(paper: Paper, values: Values) -> Drawing:
        camera = believed(values)
        foot, h = np.array([values["x"], values["y"]]), values["height"]
        base = foot + _SQUARE * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        panel = paper.picture_panel((540, 405), _CAMERA.size, "the photograph: pull the tower")
        panel.image(_in_the_shade(photo(), camera, base, h))
        corners = _draw_tower(panel, camera, base, h)
        off = np.linalg.norm(camera.project(corners) - _CAMERA.project(corners), axis=1)
        for i, j in _outline(_CAMERA.project(corners)):  # where it belongs
            edge = corners[i] + np.linspace(0, 1, 9)[:, None] * (corners[j] - corners[i])
            panel.line(_CAMERA.project(edge), "white", 1.6)
            panel.line(_CAMERA.project(edge), IDEAL, 1.6, dash=4)
        panel.grip("foot", "the foot of the tower", camera.project([*foot, 0]), 5)
        panel.grip("top", "the top of the tower", camera.project([*foot, -h]), 12)
        u, v = ((0, 1080), (95, 665)) if paper.narrow else ((160, 960), (0, 810))
        shown = (np.ptp(u) // 2, np.ptp(v) // 2)  # px of the page
        title = "from the side: pull the camera, or its glass pane"
        aside = paper.picture_panel(shown, (np.ptp(u), np.ptp(v)), title, (u[0], v[0]))
        beside = _in_the_shade(photo(aside=True), _BESIDE, base, h)
        aside.image(beside[slice(*v), slice(*u)])
        _draw_tower(aside, _BESIDE, base, h)
        _draw_camera(aside, camera, corners)
        return Drawing(paper.join((panel, aside)), _sentence(values, off))

    def carried(values: Values, at: Array) -> Values:
        return dict(zip("xy", on_board(believed(values), at), strict=True))

    def stretched(values: Values, at: Array) -> Values:
        """Make the tower as high as the place over its foot that is level with the hand."""
        h = np.arange(20, 151.0)
        over = np.column_stack([np.full_like(h, values["x"]), np.full_like(h, values["y"]), -h])
        seen = believed(values).project(over)
        return {"height": float(h[np.abs(seen[:, 1] - at[1]).argmin()])}

    def longer(values: Values, at: Array) -> Values:
        return {"alpha": _ALPHA * (_along_the_axis(at) + values["away"]) / _PANE}

    drags: dict[str, Drag] = {"foot": carried, "top": stretched, "pane": longer}
    drags["camera"] = lambda _, at: {"away": -_along_the_axis(at)}
    return Model("cube", about, settings, draw, drags)


def on_board(camera: Camera, m: Array) -> Array:
    """Return the place (2,) of the board that a pixel shows: undo sensor and lens, then Z = 0."""
    H = camera.G[:3, [0, 1, 3]]
    x, y, w = np.linalg.solve(H, [*camera.ideal(m), 1])
    return np.array([x / w, y / w])


def _along_the_axis(at: Array) -> float:
    """Return how far (mm) from the true camera a hand is, of the places of its axis the nearest."""
    far = np.arange(-200, 400.0)
    seen = _BESIDE.project(_CAMERA.centre + far[:, None] * _CAMERA.R[2])
    return float(far[np.linalg.norm(seen - at, axis=1).argmin()])


def _shadow(boxes: Array) -> Array:
    """Return polygons (n, 4, 2) of the board that together are in the shadow of boxes."""
    corners = boxes[:, [[0, 0], [1, 0], [1, 1], [0, 1]], [0, 1]]
    ends = [corners - boxes[:, z, 2, None, None] * _LIGHT[:2] / _LIGHT[2] for z in (0, 1)]
    swept = np.concatenate([np.stack([one, np.roll(one, 1, axis=1)], 2) for one in ends], 2)
    return np.concatenate([ends[0], swept[:, :, [0, 1, 3, 2]].reshape(-1, 4, 2)])


def _in_the_shade(lit: Image.Image, camera: Camera, base: Array, h: float) -> Drawn:
    """Darken what lies in the tower's shadow, and what lies close round its foot."""
    fallen = [*_shadow(tower(base.mean(axis=0), h)), base]
    mask = Image.new("L", (camera.size[0] // 2, camera.size[1] // 2))
    for corners in camera.project(np.insert(fallen, 2, 0, axis=-1)) / 2:
        ImageDraw.Draw(mask).polygon(corners.ravel().tolist(), 255)
    soft = mask.filter(ImageFilter.GaussianBlur(_SOFT / 2)).resize(camera.size)
    return np.asarray(Image.composite(lit.point(lambda level: _SHADED * level), lit, soft))


def tower(foot: Array, h: float) -> Array:
    """Return the boxes (n, 2, 3) of a tower from below: its base, wall, ledge and battlements."""
    base, ledge = min(6, 0.15 * h), min(16, 0.5 * h)
    low = [(25, 0, base), (21, base, h - ledge), (25, h - ledge, h - 0.55 * ledge)]
    boxes = [[[-w, -w, -top], [w, w, -bottom]] for w, bottom, top in low]
    for i, j in product((-19, 0, 19), repeat=2):
        if i or j:
            boxes += [[[i - 6, j - 6, -h], [i + 6, j + 6, 0.55 * ledge - h]]]
    return np.add(boxes, [*foot, 0])


def _draw_tower(panel: Panel, camera: Camera, base: Array, h: float) -> Array:
    """Draw the sides of a tower that are seen; returns the corners (8, 3) of all of it."""
    boxes, eye = tower(base.mean(axis=0), h), camera.centre
    far = np.linalg.norm(boxes.mean(axis=1) - eye, axis=1)
    for k in (0, 1, 2, *(3 + np.argsort(-far[3:]))):
        for axis, side in product((0, 1, 2), (0, 1)):
            out = 2 * side - 1
            if out * (eye[axis] - boxes[k, side, axis]) > 0:
                _draw_side(panel, camera, boxes[k], axis, out, bricks=k == 1)
    return np.concatenate([np.insert(base, 2, z, axis=1) for z in (0, -h)])


def _draw_side(
    panel: Panel, camera: Camera, ends: Array, axis: int, out: int, *, bricks: bool
) -> None:
    """Draw one side of a box, of stone or of bricks; it is darker near the ground."""
    across, up = [k for k in (0, 1, 2) if k != axis]
    width, high = np.ptp(ends, axis=0)[[across, up]].tolist()
    shapes, paint = _wall(width, high) if bricks else (_tiles(width, high, 4, 1), [_STONE] * 4)
    corner = ends[0].copy()
    corner[axis], corner[2] = ends[(out + 1) // 2, axis], ends[int(axis < 2), 2]
    flat = np.concatenate(shapes)
    W = np.tile(corner, (len(flat), 1))
    W[:, across] += flat[:, 0]
    W[:, up] += flat[:, 1] * (-1 if up == 2 else 1)
    parts = np.cumsum([len(one) for one in shapes])[:-1]
    near = [0.3 * np.exp(z.mean() / 12) for z in np.split(W[:, 2], parts)]
    light = _SKY + _SUN * max(out * float(_LIGHT[axis]), 0)
    inks = [hexed((light * p * (1 - k)).clip(0, 255)) for p, k in zip(paint, near, strict=True)]
    panel.polygons(np.split(camera.project(W), parts), inks)


def _outline(m: Array) -> list[tuple[int, int]]:
    """Return those edges of a tower, seen at m (8, 2), of which it lies to one side."""
    sides = [((m - m[i]) @ [m[i, 1] - m[j, 1], m[j, 0] - m[i, 0]], (i, j)) for i, j in _EDGES]
    return [edge for side, edge in sides if side.min() > -1 or side.max() < 1]


def _tiles(width: float, high: float, rows: int, columns: int) -> list[Array]:
    """Divide a rectangle, from below, into tiles (4, 2)."""
    one = np.array([width / columns, high / rows])
    tile = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    return [one * (tile + [j, i]) for i, j in product(range(rows), range(columns))]


def _wall(width: float, high: float) -> tuple[list[Array], list[Array]]:
    """Return a wall's bricks, the shadow of what is above it, and its windows, with colours."""
    rows = max(round(high / _COURSE), 1)
    shapes = _tiles(width, high, rows, 4)
    paint = [_BRICK * (0.9 + 0.05 * (k * 2 % 5)) for k in range(4 * rows)]
    shapes, paint = [*shapes, _tiles(width, high, 1, 1)[0]], [*paint, 0.62 * _BRICK]
    shapes[-1][:2, 1] = high - 4
    for v, u in product(np.arange(12, high - 9, _STOREY), (0.28 * width, 0.72 * width)):
        shapes += [1.35 * _ARCH + [u, v], _ARCH + [u, v]]
        paint += [_FRAME, _PANES]
    return shapes, paint


def _draw_camera(panel: Panel, camera: Camera, tower: Array) -> None:
    """Draw a camera, its picture with board and tower (8, 3), and its lines of sight to both ends.

    The board is in the picture where it was photographed, the tower where it is drawn.
    """
    back, C = inverse(camera.G), camera.centre
    w, h = camera.size

    def on_pane(m: Array) -> Array:
        plane = to_homogeneous(xy_from_px(camera.A, m))
        return _BESIDE.project(move(back, _PANE * camera.A[0, 0] / _ALPHA * plane))

    centre, right = _BESIDE.project(np.array([C, _CAMERA.centre]))
    x, y = (_BESIDE.project(C + 50 * camera.R[2]) - centre).tolist()
    if np.linalg.norm(centre - right) > 5:  # the way back
        panel.mark(right, "camera", 8, (x, y))
        panel.text(right + [24, -46], "here it stood", CAMERA)
    *pane, top = on_pane(np.array([[0, 0], [w, 0], [w, h], [0, h], [w / 2, 0]]) - 0.5)
    sides = np.stack([np.broadcast_to(centre, (4, 2)), pane, np.roll(pane, -1, axis=0)], axis=1)
    panel.polygons([np.array(pane)], _GLASS)
    photographed, drawn = (pinhole(one).moved(one.G).project for one in (_CAMERA, camera))
    draw_sheet(panel, *(on_pane(photographed(part)) for part in (_BORDER, _SQUARES)))
    panel.polygons(on_pane(drawn(tower))[_FACES], ESTIMATED)
    panel.segments(sides[:, [[0, 1], [1, 2]]].reshape(-1, 2, 2), _EDGE, 1.4)
    ends = np.stack([tower[:4].mean(axis=0), tower[4:].mean(axis=0)])
    for end in _BESIDE.project(ends):
        panel.line([centre, end], ESTIMATED, 1.2, dash=6)
    panel.mark(on_pane(drawn(ends)), "estimated", 4)
    panel.mark(centre, "camera", 13, (x, y))
    panel.grip("camera", "the camera, nearer or farther", centre, 4)
    panel.grip("pane", "its glass pane: a longer or a shorter focal length", top, 4)


def _sentence(values: Values, off: Array) -> str:
    away, alpha = values["away"], values["alpha"]
    wrong = []
    if away:
        wrong += [f"{abs(away):.0f} mm too {'near' if away < 0 else 'far'}"]
    if alpha != _ALPHA:
        wrong += [f"with a focal length of {alpha:.0f} px in place of {_ALPHA}"]
    if not values["lens"]:
        wrong += ["without its lens"]
    where = f"A tower {values['height']:.0f} mm high at ({values['x']:.0f}, {values['y']:.0f}) mm"
    if not wrong:
        return f"""{where}, by the camera that calibration found: each of its corners is where it
        belongs, to {off.max():.2f} px."""
    return f"""{where}, by a camera {" and ".join(wrong)}: up to {off[:4].max():.1f} px off at its
    foot, and {off[4:].max():.1f} px at its top."""
