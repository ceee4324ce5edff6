"""Coverage of error bars after lens and board were chosen.

Run ``python -m benchmarks.coverage [SETS]``. Boards of 9×6 corners, flat or arched, are seen
through cameras with five lenses, with noise of 0.3 px, and calibrated with ``lens="auto"`` and
``board="auto"``. How often does the true value lie within the 95 % bar of `std_of_views`, which
with n views is Student's t of n − 1 degrees of freedom times the deviation? The worst of α_u, α_v,
u0 and v0 counts, and the worst of the predictions at the corners of the picture. Beside it, what
the bars would hold if the choice were certain, and how often a larger lens than the true one was
chosen. A row of 200 sets has a standard error of 0.015.
"""

import argparse
import os
import warnings
from collections.abc import Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from itertools import product

import numpy as np

from cvnotes.base import Array, CalibrationWarning, student
from cvnotes.base.study import study
from cvnotes.calibration import calibrate, prediction_std
from cvnotes.calibration.choice import CANDIDATES
from cvnotes.camera import Camera, FisheyeLens, Lens, intrinsics, pose, rotation_from_vector
from cvnotes.targets import Chessboard

BOARD = Chessboard((9, 6), 30.0)
SIZE = (1280, 960)
NARROW, WIDE = intrinsics(900, 904.5, 645, 475), intrinsics(560, 563, 645, 475)
TRUE = {
    "none": Camera(NARROW, lens=Lens(), size=SIZE),
    "k1 k2": Camera(NARROW, lens=Lens((-0.25, 0.1)), size=SIZE),
    "k1 k2 p1 p2": Camera(NARROW, lens=Lens((-0.25, 0.1), (8e-4, -5e-4)), size=SIZE),
    "k1 k2 p1 p2 k3": Camera(NARROW, lens=Lens((-0.25, 0.1, 0.03), (8e-4, -5e-4)), size=SIZE),
    "fisheye": Camera(WIDE, lens=FisheyeLens((0.03, 0.005)), size=SIZE),
}
ARCHED, VIEWS, NOISE = (0.0, 0.15, 0.5), (5, 15), 0.3  # mm, and px
SENSOR = ("alpha_u", "alpha_v", "u0", "v0")


def seen(camera: Camera, arch: float, views: int, rng: np.random.Generator) -> Array:
    """Return noisy corners (views, n, 2) of a board at random places and tilts."""
    W, middle = BOARD.points.copy(), BOARD.points.mean(0)
    x = (W - middle)[:, 0]
    W[:, 2] = arch * (1 - (x / x.max()) ** 2)
    found: list[Array] = []
    while len(found) < views:
        R = rotation_from_vector([0, 0, rng.uniform(-np.pi, np.pi)])
        R = rotation_from_vector([*rng.normal(0, 0.4, 2), 0]) @ R
        # (so far away that the board takes a fifth to two fifths of the picture's width)
        away = rng.uniform(0.45, 0.9) * camera.A[0, 0]
        place = away * camera.ray(rng.uniform(0.1, 0.9, 2) * camera.size)
        m = camera.moved(pose(R, place - R @ middle)).project(W)
        if (m > 0).all() and (m < camera.size).all():
            found.append(m)
    return np.array(found) + rng.normal(0, NOISE, (views, len(W), 2))


@dataclass(frozen=True)
class Case:
    """What is true of a row of the table."""

    lens: str
    arch: float
    views: int


def once(case: Case, seed: int) -> tuple[list[bool], list[bool], bool]:
    """Return which bars of A and predictions hold, then without the choice; and a larger lens."""
    warnings.simplefilter("ignore", CalibrationWarning)
    camera = TRUE[case.lens]
    m = seen(camera, case.arch, case.views, np.random.default_rng([seed, case.views]))
    found = calibrate(BOARD.points, m, camera.size, lens="auto", board="auto")
    assert found.choice is not None
    larger = CANDIDATES.index(found.choice.lens) > CANDIDATES.index(case.lens)
    return held(found, camera), held(replace(found, choice=None), camera), larger


def held(found, camera: Camera) -> list[bool]:  # type: ignore[no-untyped-def]
    """Return which bars hold the truth: α_u, α_v, u0, v0, and the four corners of the picture."""
    t = student(1.96, len(found.poses) - 1)
    std, value, true = found.std_of_views, found.parameters, camera.parameters
    of_A = [abs(value[name] - true[name]) <= t * std[name] for name in SENSOR]
    w, h = camera.size
    corners = np.array([[0, 0], [w - 1, 0], [0, h - 1], [w - 1, h - 1]], float)
    # (where the camera shows what the true one shows at the corners of its picture; both
    # coordinates together, of which each has half of the variance at least)
    off = found.camera.project(camera.ray(corners)) - corners
    bars = prediction_std(found, corners, of="views")
    limit = np.sqrt(-2 * np.log(0.05) / 3.841) * t
    promised = np.isfinite(bars)  # where the lens ends, it says so
    return [*of_A, *(~promised | (np.linalg.norm(off, axis=1) <= limit * bars)).tolist()]


def row(case: Case, sets: int, executor: Executor | None = None) -> tuple[float, ...]:
    """Return the least coverage of A and of predictions, then without the choice; larger lenses."""
    found = study(partial(once, case), range(sets), executor)
    both = [np.mean([f[i] for f in found], axis=0) for i in (0, 1)]
    rates = [float(part.min()) for each in both for part in (each[:4], each[4:])]
    return (*rates, float(np.mean([f[2] for f in found])))


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.coverage")
    parser.add_argument("sets", nargs="?", type=int, default=200)
    sets = parser.parse_args(arguments).sets
    os.environ["OMP_NUM_THREADS"] = "1"  # before the processes begin
    print(f"95 % bars of views that hold after a choice, {sets} sets a row")
    print(f"{'':>16}{'arch':>6}{'views':>6}{'A':>7}{'corners':>9}{'not widened':>14}{'larger':>15}")
    with ProcessPoolExecutor() as executor:
        for lens, arch, views in product(TRUE, ARCHED, VIEWS):
            of_A, of_corners, A_alone, corners_alone, larger = row(
                Case(lens, arch, views), sets, executor
            )
            print(
                f"{lens:>16}{arch:6.2f}{views:6d}{of_A:7.2f}{of_corners:9.2f}{A_alone:9.2f}"
                f"{corners_alone:9.2f}{larger:11.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
