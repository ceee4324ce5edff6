"""Saddle points of the grey levels, joined into the lattices of boards.

Where four squares meet, the smoothed grey levels L have a saddle: light along one diagonal, dark
along the other. Two tests tell it from the many saddles along an edge or in a texture:

* the second derivatives H have no trace: around a crossing of straight edges it is 0, whatever
  their angle;
* on a ring around it, light and dark change four times. The places of the changes are the
  directions of the two edges.

From one such point the next ones are looked for along its edges, from those the next, and so on.
"""

from collections import deque
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, Image
from cvnotes.targets.harris_corners import local_maxima
from cvnotes.targets.lattice import trimmed

SIGMA = 1.0  # px: what is blurred or noisy shows in a reduced copy of the picture
_RING = 3.0  # of sigma; the squares are larger than this
_AROUND = np.exp(2j * np.pi * np.arange(16) / 16)
_TRACE = 1.5  # of √(−det H): 0.7 in the worst of 4,000 corners in photographs
_WEAK = 0.01  # of the strongest saddle; the square of a contrast, which light and slant reduce
_MOST = 3000  # saddle points that are looked at
_SEEDS = 60  # of these, tried as a beginning
_FEWEST = 9  # corners of a lattice: 3×3
_ASIDE = 0.3  # sine of the angle between an edge and the way to the next corner
_QUADRANT = 0.3  # of both steps: there the grey levels of the quadrants are looked at
_ALIKE = 0.3  # of the contrast: so much is the darker light quadrant lighter than the lighter dark
_FAR = 0.35  # of a step: farther from where it was expected, it is another corner


class Saddles(NamedTuple):
    """Saddle points at which two edges cross, the strongest first.

    Attributes
    ----------
    m : ndarray, shape (n, 2)
        Where they are, px.
    H : ndarray, shape (n, 2, 2)
        Second derivatives of the smoothed grey levels.
    edges : ndarray, shape (n, 2, 2)
        Unit vectors along both edges.
    L : ndarray, shape (height, width)
        The smoothed grey levels.
    """

    m: Array
    H: Array
    edges: Array
    L: npt.NDArray[np.float32]


def saddle_points(grey: Image, sigma: float = SIGMA) -> Saddles:
    """Find where two edges cross: saddles of the smoothed grey levels L, their det H smallest.

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
    >>> saddle_points(np.sign(u * v)).m.round(6)
    array([[10., 10.]])
    """
    L = smoothed(np.asarray(grey, dtype=np.float32), sigma)
    border = np.pad(L, 1, mode="edge")
    L_uu = border[1:-1, 2:] - 2 * L + border[1:-1, :-2]
    L_vv = border[2:, 1:-1] - 2 * L + border[:-2, 1:-1]
    L_uv = (border[2:, 2:] - border[2:, :-2] - border[:-2, 2:] + border[:-2, :-2]) / 4
    response = L_uv**2 - L_uu * L_vv
    m = local_maxima(response, radius=max(int(1.5 * sigma), 1), threshold=_WEAK)
    u, v = m.astype(np.intp).T
    untraced = np.abs(L_uu[v, u] + L_vv[v, u]) < _TRACE * np.sqrt(response[v, u])
    m, u, v = m[untraced], u[untraced], v[untraced]
    H = np.stack([L_uu[v, u], L_uv[v, u], L_uv[v, u], L_vv[v, u]], axis=-1, dtype=np.float64)
    H = H.reshape(-1, 2, 2)
    slope = np.stack(
        [border[v + 1, u + 2] - border[v + 1, u], border[v + 2, u + 1] - border[v, u + 1]], axis=-1
    )
    m = m - np.linalg.solve(H, slope[..., None] / 2)[..., 0].clip(-1, 1)
    crossing, edges = _rings(L, m, _RING * sigma)
    crossing = crossing[:_MOST]
    return Saddles(m[crossing], H[crossing], edges[:_MOST], L)


def smoothed(grey: npt.NDArray[np.float32], sigma: float) -> npt.NDArray[np.float32]:
    """Smooth with a Gaussian of `sigma` pixels; beyond its border the picture is mirrored.

    Examples
    --------
    >>> smoothed(np.array([[0, 0, 1, 0, 0]], dtype=np.float32), 0.5).round(2)
    array([[0.  , 0.11, 0.79, 0.11, 0.  ]], dtype=float32)
    """
    try:
        from cv2 import BORDER_REFLECT, GaussianBlur
    except ImportError:
        from scipy.ndimage import gaussian_filter

        return np.asarray(gaussian_filter(grey, sigma), dtype=np.float32)
    blurred = GaussianBlur(grey, (0, 0), sigma, borderType=BORDER_REFLECT)
    return np.asarray(blurred, dtype=np.float32)


def _rings(
    L: npt.NDArray[np.float32], m: Array, radius: float
) -> tuple[npt.NDArray[np.intp], Array]:
    """Return around which points light and dark change four times, and the edges' directions.

    The rings end within the picture: what is nearer to its border is no crossing.
    """
    height, width = L.shape
    within = ((m >= radius) & (m <= np.array([width, height]) - 1 - radius)).all(-1)
    where = np.flatnonzero(within)
    places = (m[where] @ [1, 1j])[:, None] + radius * _AROUND
    u, v = (np.rint(x).astype(np.intp) for x in (places.real, places.imag))
    ring = L[v, u].astype(np.float64)
    if not ring.size:
        return where, np.empty((0, 2, 2))
    ring -= (ring.max(1, keepdims=True) + ring.min(1, keepdims=True)) / 2
    before = np.roll(ring, 1, axis=1)
    change = (ring > 0) != (before > 0)
    four = change.sum(1) == 4
    n, k = np.nonzero(change & four[:, None])
    # Between two pixels of the ring, where the grey levels pass their middle.
    angle = (k - ring[n, k] / (ring[n, k] - before[n, k])) * (2 * np.pi / len(_AROUND))
    ends = np.exp(1j * angle).reshape(-1, 4)
    along = ends[:, :2] - ends[:, 2:]
    along /= np.abs(along)
    return where[four], np.stack([along.real, along.imag], axis=-1)


def lattices(grey: Image) -> Iterator[Array]:
    """Yield the boards in a picture, those with the strongest corners first.

    Yields
    ------
    ndarray, shape (rows, columns, 2)
        Pixels, NaN for corners that are hidden between the others; at least 3×3. The same board
        may come more than once.

    Examples
    --------
    >>> next(lattices(np.zeros((40, 40))), None) is None
    True
    """
    found = saddle_points(grey)
    z = found.m[:, 0] + 1j * found.m[:, 1]
    used = np.zeros(len(z), dtype=bool)
    for seed in range(min(len(z), _SEEDS)):
        if np.count_nonzero(~used) < _FEWEST:
            return
        if used[seed]:
            continue
        places = _grown(found, z, seed)
        if len(places) < _FEWEST:
            continue
        used[list(places.values())] = True
        where = np.array(list(places))
        where -= where.min(0)
        lattice = np.full((*(where.max(0) + 1), 2), np.nan)
        lattice[tuple(where.T)] = found.m[list(places.values())]
        lattice = trimmed(lattice)
        if min(lattice.shape[:2]) >= 3:
            yield lattice


def _first_steps(found: Saddles, z: npt.NDArray[np.complex128], seed: int) -> list[complex]:
    """Return the steps from a saddle to the next ones along its two edges, those that there are."""
    ways = z - z[seed]
    far = np.abs(ways)
    far[seed] = np.inf
    steps = []
    for t in found.edges[seed] @ [1, 1j]:
        along = np.where(np.abs((ways * t.conjugate()).imag) < _ASIDE * far, far, np.inf)
        nearest = along.argmin()
        if np.isfinite(along[nearest]):
            steps.append(complex(ways[nearest]))
    return steps


def _grown(found: Saddles, z: npt.NDArray[np.complex128], seed: int) -> dict[tuple[int, int], int]:
    """Go from a saddle to its neighbours and theirs; gives which stands at each (row, column)."""
    at = {(0, 0): seed}
    steps = _first_steps(found, z, seed)
    if len(steps) < 2:
        return at
    a, b = ([step.real, step.imag] for step in steps)
    light = float(np.sign(a @ found.H[seed] @ b))  # of the quadrant between both
    first = steps[0], steps[1]
    if not _is_crossing(found.L, z[seed], first, light):
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
                way = z[p] - z[at[back]]
            away = np.abs(z - (z[p] + way))
            q = int(away.argmin())
            if q in taken or away[q] > _FAR * abs(way):
                continue
            way = complex(z[q] - z[p])
            onward = (way * dj, b) if dj else (a, way * di)
            if not _is_crossing(found.L, z[q], onward, light * (-1) ** sum(there)):
                continue
            at[there], ways[there] = q, onward
            taken.add(q)
            todo.append(there)
    return at


def _is_crossing(
    L: npt.NDArray[np.float32], p: complex, ways: tuple[complex, complex], light: float
) -> bool:
    """Return whether both quadrants between two ways are light (or dark), and the others are not.

    Where only one of four quadrants is dark, as at the end of a board, is a saddle too.
    """
    (height, width), (a, b) = L.shape, ways
    levels: list[float] = []
    for way in (a + b, -a - b, a - b, b - a):
        q = p + _QUADRANT * way
        u, v = round(q.real), round(q.imag)
        levels.append(light * L[min(max(v, 0), height - 1), min(max(u, 0), width - 1)].item())
    clear = min(levels[:2]) - max(levels[2:])
    return bool(clear > _ALIKE * (max(levels) - min(levels)))
