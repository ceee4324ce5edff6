"""A board found without OpenCV: saddle points of the grey levels, joined into a lattice.

Where four squares meet, the smoothed grey levels have a saddle: light along one diagonal, dark
along the other. The matrix H of second derivatives says there how much of a saddle it is, by its
determinant, and which quadrants are light. The directions of the two edges it does not tell: around
a crossing of straight edges its trace is 0, whatever their angle. The gradients around tell them
(`cvnotes.targets.subpixel.gradient_axes`).
"""

from collections import deque
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, Image
from cvnotes.targets.grey import smoothed
from cvnotes.targets.harris_corners import local_maxima
from cvnotes.targets.lattice import Mask, trimmed
from cvnotes.targets.subpixel import gradient_axes

SCALES = (1.5, 2.5, 4.0)  # px: what is blurred or noisy shows at the larger ones
_WEAK = 0.01  # of the strongest saddle; the square of a contrast, which light and slant reduce
_MOST = 3000  # saddle points that are looked at
_SEEDS = 40  # of these, tried as a beginning
_NEAR = 12  # neighbours among which the next corners are
_HALF = 4  # half a window, px, whose gradients tell the directions of the edges
_ASIDE = 0.3  # sine of the angle between an edge and the way to the next corner
_QUADRANT = 0.3  # of both steps: there the grey levels of the quadrants are looked at
_ALIKE = 0.3  # of the contrast: so much is the darker light quadrant lighter than the lighter dark
_FAR = 0.3  # of a step: farther from where it was expected, it is another corner


class Saddles(NamedTuple):
    """Saddle points m (n, 2) in pixels, the strongest first, and their Hessians H (n, 2, 2).

    Their `strength` (n,), √(−det H), is proportional to the contrast. L are the smoothed grey
    levels.
    """

    m: Array
    H: Array
    strength: Array
    L: Image


def saddle_points(grey: Image, sigma: float) -> Saddles:
    """Find where smoothed grey levels L have a saddle: det H < 0 and smallest around.

    Parameters
    ----------
    grey : ndarray, shape (height, width)
        The picture.
    sigma : float
        Standard deviation of the Gaussian that smoothes it, px.

    Returns
    -------
    Saddles
        With H = [[L_uu, L_uv], [L_uv, L_vv]], and m = pixel − H⁻¹ [L_u, L_v], where the slope ends.

    Examples
    --------
    >>> v, u = np.indices((21, 21)) - 10.0
    >>> saddle_points(np.sign(u * v), 1.5).m[0].round(6)
    array([10., 10.])
    """
    L = np.pad(smoothed(np.asarray(grey, dtype=np.float32), sigma), 1, mode="edge")
    L_u, L_v = (L[1:-1, 2:] - L[1:-1, :-2]) / 2, (L[2:, 1:-1] - L[:-2, 1:-1]) / 2
    L_uu = L[1:-1, 2:] - 2 * L[1:-1, 1:-1] + L[1:-1, :-2]
    L_vv = L[2:, 1:-1] - 2 * L[1:-1, 1:-1] + L[:-2, 1:-1]
    L_uv = (L[2:, 2:] - L[2:, :-2] - L[:-2, 2:] + L[:-2, :-2]) / 4
    response = L_uv**2 - L_uu * L_vv
    m = local_maxima(response, radius=max(int(1.5 * sigma), 1), threshold=_WEAK, count=_MOST)
    u, v = m.astype(np.intp).T
    H = np.stack([L_uu[v, u], L_uv[v, u], L_uv[v, u], L_vv[v, u]], axis=-1, dtype=np.float64)
    H = H.reshape(-1, 2, 2)
    slope = np.stack([L_u[v, u], L_v[v, u]], axis=-1)[..., None]
    m = m - np.linalg.solve(H, slope)[..., 0].clip(-1, 1)
    return Saddles(m, H, np.sqrt(response[v, u]), L[1:-1, 1:-1])


def find_saddles(grey: Image, corners: tuple[int, int]) -> Array | None:
    """Look for a board; corners (n, 2) row by row, NaN for hidden ones, or None.

    Examples
    --------
    >>> find_saddles(np.zeros((40, 40)), (9, 6)) is None
    True
    """
    columns, rows = corners
    best: Array | None = None
    for sigma in SCALES:
        lattice = _largest(saddle_points(grey, sigma))
        for turned in (lattice, lattice.transpose(1, 0, 2)):
            window = _strongest(turned, rows, columns)
            if window is not None and (best is None or _seen(window) > _seen(best)):
                best = window
        if best is not None and _seen(best) == rows * columns:
            break
    if best is None or _seen(best) < 0.75 * rows * columns:
        return None
    return best[..., :2].reshape(-1, 2)


def saddle_lattice(grey: Image) -> Array | None:
    """Look for a board of any count; corners (rows, columns, 2), NaN for hidden ones, or None.

    Examples
    --------
    >>> saddle_lattice(np.zeros((40, 40))) is None
    True
    """
    best = max((_largest(saddle_points(grey, sigma)) for sigma in SCALES), key=_seen)
    return best[..., :2] if min(best.shape[:2]) >= 3 else None


def _largest(found: Saddles) -> Array:
    """Grow lattices from the strongest saddles; gives that with most corners: u, v, strength."""
    best, used = np.full((0, 0, 3), np.nan), np.zeros(len(found.m), dtype=bool)
    if len(found.m) < 9:
        return best
    seeds = found.m[:_SEEDS]
    edges = gradient_axes(found.L, seeds, _HALF)
    near = np.argsort(np.linalg.norm(found.m - seeds[:, None], axis=-1))[:, :_NEAR]
    for seed in range(len(seeds)):
        if used[seed]:
            continue
        places = _grown(found, seed, _first_steps(found, edges, near, seed))
        used[list(places.values())] = True
        lattice = trimmed(_as_lattice(places, found))
        if _seen(lattice) > _seen(best):
            best = lattice
        if 2 * _seen(best) > np.count_nonzero(~used):  # no other can have more of them
            break
    return best


def _first_steps(
    found: Saddles, edges: Array, near: npt.NDArray[np.intp], seed: int
) -> list[Array]:
    """Give the steps from a saddle to the next ones along its two edges, those that there are."""
    steps = []
    others = near[seed][near[seed] != seed]
    ways = found.m[others] - found.m[seed]
    lengths = np.linalg.norm(ways, axis=-1)
    for t in edges[seed]:
        aside = np.abs(ways @ [-t[1], t[0]]) / lengths
        along = np.flatnonzero(aside < _ASIDE)
        if len(along):
            steps.append(ways[along[np.argmin(lengths[along])]])
    return steps


def _grown(found: Saddles, seed: int, steps: list[Array]) -> dict[tuple[int, int], int]:
    """Go from a saddle to its neighbours and theirs; gives which stands at each (row, column)."""
    at = {(0, 0): seed}
    if len(steps) < 2:
        return at
    light = np.sign(steps[0] @ found.H[seed] @ steps[1])  # of the quadrant between both
    first = steps[0], steps[1]
    if not _is_crossing(found, seed, first, light):
        return at
    ways = {(0, 0): first}  # to the next column and to the next row
    taken, todo = {seed}, deque([(0, 0)])
    while todo:
        i, j = here = todo.popleft()
        p, (a, b) = at[here], ways[here]
        for (di, dj), way in (((0, 1), a), ((0, -1), -a), ((1, 0), b), ((-1, 0), -b)):
            there, back = (i + di, j + dj), (i - di, j - dj)
            if there in at:
                continue
            if back in at:
                way = found.m[p] - found.m[at[back]]
            away = np.hypot(*(found.m - found.m[p] - way).T)
            q = int(away.argmin())
            if q in taken or away[q] > _FAR * np.linalg.norm(way):
                continue
            way = found.m[q] - found.m[p]
            onward = (way * dj, b) if dj else (a, way * di)
            if not _is_crossing(found, q, onward, light * (-1) ** (there[0] + there[1])):
                continue
            at[there], ways[there] = q, onward
            taken.add(q)
            todo.append(there)
    return at


def _is_crossing(found: Saddles, i: int, ways: tuple[Array, Array], light: float) -> bool:
    """Tell whether both quadrants between two ways are light (or dark), and the others are not.

    Where only one of four quadrants is dark, as at the end of a board, is a saddle too.
    """
    (a, b), (height, width) = ways, found.L.shape
    places = found.m[i] + _QUADRANT * np.stack([a + b, -a - b, a - b, b - a])
    u, v = np.rint(places).astype(np.intp).T.clip(0, [[width - 1], [height - 1]])
    one, other = light * found.L[v, u].reshape(2, 2)
    return bool(one.min() - other.max() > _ALIKE * np.ptp([one, other]))


def _as_lattice(places: dict[tuple[int, int], int], found: Saddles) -> Array:
    where = np.array(list(places))
    where -= where.min(0)
    lattice = np.full((*(where.max(0) + 1), 3), np.nan)
    points = np.column_stack([found.m, found.strength])
    lattice[tuple(where.T)] = points[list(places.values())]
    return lattice


def _strongest(lattice: Array, rows: int, columns: int) -> Array | None:
    """Give the part of that many rows and columns whose corners are strongest together.

    Where a board's outer squares end is a row of saddles too, but of weak ones.
    """
    parts = [
        lattice[i : i + rows, j : j + columns]
        for i in range(lattice.shape[0] - rows + 1)
        for j in range(lattice.shape[1] - columns + 1)
    ]
    return max(parts, key=lambda part: float(np.nansum(part[..., 2])), default=None)


def _there(lattice: Array) -> Mask:
    return np.asarray(np.isfinite(lattice).all(-1))


def _seen(lattice: Array) -> int:
    return int(np.count_nonzero(_there(lattice)))
