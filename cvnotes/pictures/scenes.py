"""Scenes to photograph: rails, blocks on a plain, a corridor, a room, a desk, a target."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from cvnotes.base import MOST, number
from cvnotes.camera import pose, rotation_from_vector
from cvnotes.pictures.faces import is_target
from cvnotes.pictures.meshes import Colour, Scene, Surroundings, box, join, quads
from cvnotes.targets import Chessboard, ThreePlanes, TwoPlanes
from cvnotes.targets.chessboard import PrintedBoard

Span = tuple[float, float]  # from, to

GROUND = 1600.0
DESK_LIGHT = (-0.5, 0.35, -1.0)

_OUTDOORS = Surroundings(
    (0.90, 0.93, 0.95), (0.36, 0.58, 0.84), haze=3e6, light=(-0.9, -0.9, -0.6), ambient=0.45
)
INDOORS = Surroundings(occlusion=800)
_FAR = 1e8
PALE = (0.86, 0.88, 0.88)  # paint of walls


def rails() -> Scene:
    """Build a straight railway along z, to the horizon.

    The middles of the rail heads are the lines x = ±750, y = 1600. Poles 6 m high stand every
    25 m along x = −4000.

    Examples
    --------
    >>> rails().vertices[:, 1].max()
    np.float64(1950.0)
    """
    ground = _floor((-_FAR, _FAR), 1950, (-_FAR, _FAR), (0.47, 0.55, 0.33))
    ballast = _floor((-2300, 2300), 1770, (-_FAR, _FAR), (0.56, 0.53, 0.49))
    # A checker that is one square wide is a row of sleepers, as wide as their gaps.
    sleepers = _floor((-1300, 1300), 1750, (0, _FAR), ((0.36, 0.29, 0.24), (0.56, 0.53, 0.49)))
    sleepers = replace(sleepers, uv=sleepers.corners[..., [0, 2]] / (2600, 300) + (0.5, 0))
    steel = np.full((6, 1, 3), 0.36)
    steel[4] = 0.80, 0.83, 0.87  # the heads shine
    pair = [box((x - 35, x + 35), (1600, 1750), (-_FAR, _FAR), steel) for x in (-750, 750)]
    poles = [
        box((-4090, -3910), (-4050, 1950), (z - 90, z + 90), (0.42, 0.33, 0.26))
        for z in range(15_000, 500_000, 25_000)
    ]
    return replace(join(ground, ballast, sleepers, *pair, *poles), around=_OUTDOORS)


def blocks() -> Scene:
    """Build three blocks on a plain that reaches to the horizon, for vanishing points.

    All their edges keep to three directions: the vertical, and two level ones that are turned by
    35° about it, (cos 35°, 0, −sin 35°) and (sin 35°, 0, cos 35°). Tiles are 1 m wide. The first
    8 vertices are the corners of the block in the middle, 4 m × 5 m × 4 m.

    Examples
    --------
    >>> edge = blocks().vertices[1] - blocks().vertices[0]
    >>> (edge / np.cos(np.deg2rad(35))).round(9)[0]
    np.float64(4000.0)
    """
    turn = rotation_from_vector([0, np.deg2rad(35), 0])
    sides = [
        ((0, 4000), (-3400, GROUND), (0, 4000)),
        ((-7000, -3000), (-1400, GROUND), (3000, 9000)),
    ]
    sides += [((4700, 7700), (-400, GROUND), (3000, 6000))]
    colours = [((0.72, 0.42, 0.30), (0.86, 0.60, 0.45)), ((0.36, 0.50, 0.58), (0.55, 0.68, 0.74))]
    colours += [((0.70, 0.62, 0.38), (0.87, 0.80, 0.58))]
    walls = [box(*side, pair, 1000) for side, pair in zip(sides, colours, strict=True)]
    town = join(*walls).moved(pose(turn, [-2300, 0, 12_500]))
    ground = _floor((-_FAR, _FAR), GROUND, (-_FAR, _FAR), (0.62, 0.60, 0.53))
    return replace(join(town, ground), around=_OUTDOORS)


def corridor() -> Scene:
    """Build a corridor 2.4 m wide and 30 m long, with tiles of 600 mm, handrails and doors.

    The first 8 vertices are its corners. The handrails run along x = ±1120, y = 700.

    Examples
    --------
    >>> corridor().vertices[:8].max(axis=0)
    array([ 1200.,  1600., 30000.])
    """
    tiles = ((0.36, 0.45, 0.50), (0.80, 0.83, 0.82))
    shell = _shell((-1200, 1200), (-1100, GROUND), (-3000, 30_000), PALE, tiles, 600)
    wood, door, lamp = (0.62, 0.42, 0.24), (0.27, 0.45, 0.52), (1.4, 1.4, 1.4)
    parts = []
    for side in (-1, 1):
        parts += [
            _beside(side, (1090, 1150), (670, 730), (-3000, 30_000), wood),
            _beside(side, (1185, 1200), (1480, 1600), (-3000, 30_000), wood),
        ]
        parts += [
            _beside(side, (1190, 1200), (-500, 1600), (z, z + 950), door)
            for z in range(3500 + 1500 * (side > 0), 29_000, 5000)
        ]
    # Flat, and looking down: what shines casts no shadow.
    parts += [_floor((250, -250), -1080, (z, z + 1200), lamp) for z in range(2000, 29_000, 3000)]
    lamps = Surroundings(light=(0, -1, 0), ambient=0.7, occlusion=500)
    return replace(join(shell, *parts), around=lamps)


def room(right: Colour = (1.06, 1.06, 1.04)) -> Scene:
    """Build a room of 6 m by 12 m whose walls, tiles and furniture all keep to three directions.

    The first 8 vertices are its corners; `right` is the colour of its right wall.

    Examples
    --------
    >>> room().vertices[:8].max(axis=0)
    array([ 3000.,  1600., 10000.])
    """
    tiles = ((0.66, 0.48, 0.34), (0.88, 0.79, 0.66))
    sides = [PALE], [right]  # the right one has its light from the left one
    shell = _shell((-3000, 3000), (-1600, GROUND), (-2000, 10_000), sides, tiles, 500)
    table, plinth = (0.84, 0.56, 0.29), (0.93, 0.93, 0.90)
    furniture = [
        box((-2900, -1300), (800, 860), (6400, 8800), table),
        *(
            box((x, x + 100), (860, GROUND), (z, z + 100), table)
            for x in (-2850, -1450)
            for z in (6450, 8650)
        ),
        box((-2500, -1900), (420, 800), (7000, 7600), (0.33, 0.55, 0.62)),
        box((1900, 3000), (-500, GROUND), (7600, 9600), (0.55, 0.36, 0.27)),
        box((300, 1000), (900, GROUND), (7300, 8000), plinth),
        box((450, 850), (500, 900), (7450, 7850), (0.78, 0.33, 0.28)),
    ]
    hung = [
        box((-700, 700), (-800, 300), (9950, 10_000), (0.96, 0.94, 0.90)),
        box((-600, 600), (-700, 200), (9940, 9950), (0.23, 0.42, 0.40)),
        box((-3000, -2980), (-900, 300), (6300, 8900), (1.0, 1.0, 1.0)),
    ]
    wood = (0.55, 0.36, 0.27)
    skirting = [  # shadows end on it, not a finger's breadth up the wall
        box((x, x + 15), (1510, GROUND), (-2000, 10_000), wood) for x in (-3000, 2985)
    ]
    skirting += [box((-2985, 2985), (1510, GROUND), (9985, 10_000), wood)]
    behind = [  # which only a fisheye sees: a door and a window, flat, for light falls through
        quads([[x, y, -1950] for x, y in corners], [[0, 1, 2, 3]], colour)
        for corners, colour in (
            (_rectangle((-2900, -1900), (-500, GROUND)), (0.55, 0.36, 0.27)),
            (_rectangle((1700, 2900), (-1300, -300)), (0.62, 0.78, 0.90)),
        )
    ]
    return replace(join(shell, *furniture, *hung, *skirting, *behind), around=INDOORS)


def room_with(target: Chessboard | TwoPlanes | ThreePlanes, G: npt.ArrayLike) -> Scene:
    """Build the room with a calibration target held in it, G (4, 4) leading from target to WRF.

    Examples
    --------
    >>> held = room_with(TwoPlanes(), pose(np.eye(3), [0, 0, 1000]))
    >>> len(held.vertices) - len(room().vertices)
    24
    """
    return join(room(), target_scene(target, G))


def _shell(
    x: Span, y: Span, z: Span, sides: npt.ArrayLike, tiles: npt.ArrayLike, tile: float
) -> Scene:
    """Build the walls, the ceiling and the tiled floor of a room; sides are left and right."""
    walls = np.empty((6, 2, 3))
    walls[:2], walls[2:4], walls[5] = (0.95, 0.92, 0.85), sides, tiles
    walls[4] = 1.22, 1.20, 1.15  # brighter than white: it has the light of floor and walls
    return box(x, y, z, walls, [np.inf] * 5 + [tile])


def _floor(x: Span, y: float, z: Span, colours: npt.ArrayLike) -> Scene:
    return quads([[X, y, Z] for X, Z in _rectangle(x, z)], [[0, 1, 2, 3]], colours)


def _rectangle(x: Span, y: Span) -> list[Span]:
    return [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])]


def _beside(side: int, x: Span, y: Span, z: Span, colours: npt.ArrayLike) -> Scene:
    """Build a box on the right (side 1) or, mirrored, on the left (side −1)."""
    low, high = sorted(side * value for value in x)
    return box((low, high), y, z, colours)


def desk(target: Chessboard) -> Scene:
    """Build a desk with a board lying on it, beside a book and a box; its WRF is the board's.

    Examples
    --------
    >>> from cvnotes.targets import Chessboard
    >>> desk(Chessboard((9, 6), 25.0))
    Scene(116 vertices, 104 triangles)
    """
    parts = join(
        box((-3000, 3000), (-1500, -1450), (-2500, 700), (0.90, 0.88, 0.83)),  # the wall
        _boards_of_wood((-700, 900), (-450, 600), (_THICK, 43)),
        box((-330, -130), (-60, 230), (-38, _THICK), (0.24, 0.40, 0.46)),
        box((-326, -128), (-58, 232), (-32, -4), (0.95, 0.93, 0.88)),  # its pages
        box((300, 385), (-150, -65), (-95, _THICK), (0.78, 0.33, 0.28)),
        target_scene(target),
    )
    return replace(parts, around=Surroundings(light=DESK_LIGHT, occlusion=50))


def _boards_of_wood(x: Span, y: Span, z: Span) -> Scene:
    """Build the top of a desk: boards of two pieces each, no two of one tone, on a dark ground."""
    rng = np.random.default_rng(3)
    along = np.linspace(*y, 9)
    along[1:-1] += rng.uniform(-15, 15, 7)
    pieces = [
        _rectangle((left, right - _JOINT), (low, high - _JOINT))
        for low, high in pairwise(along)
        for left, right in pairwise([x[0], rng.uniform(*x), x[1]])
    ]
    tops = np.insert(np.array(pieces).reshape(-1, 2), 2, z[0], axis=1)
    tones = _WOOD * rng.uniform(0.9, 1.1, (len(pieces), 1, 1))
    loops = np.arange(len(tops)).reshape(-1, 4)
    return join(quads(tops, loops, tones), box(x, y, (z[0] + 1, z[1]), 0.55 * _WOOD))


_JOINT = 1.2  # mm between boards
_WOOD = np.array([0.78, 0.57, 0.36])
_PRINT = ((0.06, 0.06, 0.07), (0.98, 0.98, 0.97))
_PLATE = (0.62, 0.64, 0.66)
_THICK = 3.0


def target_scene(
    target: Chessboard | TwoPlanes | ThreePlanes,
    world_from_target: npt.ArrayLike | None = None,
    *,
    margin: float = 1.0,
) -> Scene:
    """Build a calibration target: boards printed on paper, on plates 3 mm thick.

    Parameters
    ----------
    target : Chessboard, TwoPlanes or ThreePlanes
        Its corners are ``target.points``, in the target's frame.
    world_from_target : array_like, shape (4, 4), optional
        Where it stands; by default in the origin.
    margin : float
        White paper around the squares, in squares.

    Examples
    --------
    >>> target_scene(TwoPlanes())
    Scene(24 vertices, 24 triangles)
    """
    is_target(target)
    margin = number(margin, "margin", at_least=0, at_most=MOST)
    boards = [_board(board, margin).moved(G) for G, board in target.faces]
    return join(*boards).moved(np.eye(4) if world_from_target is None else world_from_target)


def _board(board: PrintedBoard, margin: float) -> Scene:
    """Build one board in its own frame: the print, and the plate behind it."""
    columns, rows = board.squares
    low, high = -1 - margin, np.array([columns, rows]) - 1 + margin
    square = board.square
    (x0, y0), (x1, y1) = (low * square, low * square), high * square
    plate = box((x0, x1), (y0, y1), (0, _THICK), _PLATE)
    behind = replace(  # all faces but the front
        plate,
        **{name: getattr(plate, name)[2:] for name in ("triangles", "colours", "uv", "extent")},
    )
    paper = quads(
        [[x0, y0, 0], [x1, y0, 0], [x1, y1, 0], [x0, y1, 0]], [[0, 1, 2, 3]], _PRINT, square
    )
    paper = replace(paper, uv=paper.uv - margin, extent=np.full((2, 2), (columns, rows)))
    return join(paper, behind)
