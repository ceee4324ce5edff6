"""Calibration: from corners seen in several views to a camera with error bars (notes 2b.4)."""

from collections.abc import Callable
from typing import Any

from cvnotes.base import DegenerateError, image_size
from cvnotes.calibration.board_shape import is_board, shape_found, shaped
from cvnotes.calibration.choice import CANDIDATES, choose_model
from cvnotes.calibration.correspondences import Correspondences, PointSets
from cvnotes.calibration.refinement import Problem, refuse_too_few
from cvnotes.calibration.reliability import Diagnostics, judge
from cvnotes.calibration.result import Calibration
from cvnotes.calibration.starts import Search
from cvnotes.calibration.zhang import extrinsics, radial_distortion
from cvnotes.homography import dlt


def calibrate(
    board_points: PointSets,
    image_points: PointSets,
    size: tuple[int, int],
    *,
    lens: str = "k1 k2",
    board: str = "flat",
    skew: bool = False,
    homography: Callable[..., Any] = dlt,
    intrinsics: Callable[..., Any] | None = None,
    extrinsics: Callable[..., Any] = extrinsics,
    distortion: Callable[..., Any] = radial_distortion,
) -> Calibration:
    """Calibrate a camera from the corners of a planar board seen in several views.

    Parameters
    ----------
    board_points : array_like, shape (n, 2) or (n, 3), or a list of such
        The corners on the board, Z = 0; one set for all views, or one for each.
    image_points : array_like, shape (n_views, n, 2), or a list of (n_i, 2)
        The same corners in the pictures, in pixels.
    size : (width, height)
        Size of the pictures.
    lens : {"none", "k1", "k1 k2", "k1 k2 k3", "k1 k2 p1 p2", "k1 k2 p1 p2 k3", ...}
        Which lens coefficients are estimated; the others are zero. Wide lenses are "rational" or
        "fisheye" (see `RationalLens` and `FisheyeLens`). With "auto" views that are left out
        decide (see `choose_model`).
    board : {"flat", "bent", "free", "auto"}
        Whether the board is as it was given, or bends smoothly (heights of degree 4), or has every
        corner where the views say, as far from a smooth bend as they say. "auto" is "free" where
        they determine that, else "flat". A board that is not flat takes 4 views; its points are in
        ``shape`` of the result.
    skew : bool
        Estimate the skew too; three views are then needed, else two.
    homography : callable
        Step 1, (src (n, 2), dst (n, 2)) → H (3, 3).
    intrinsics : callable
        Step 2, H (n_views, 3, 3) → A (3, 3). By default the closed form competes with the same
        constraints solved for the focal lengths alone.
    extrinsics : callable
        Step 3, (A, H (n_views, 3, 3)) → G (n_views, 4, 4).
    distortion : callable
        Step 4, (A, G, W, m, terms=…) → k (terms,).

    Returns
    -------
    Calibration
        With error bars, and with sentences about what is doubtful.

    Raises
    ------
    DegenerateError
        Too few views or points, or views that say nothing about the camera.
    ConvergenceError
        The refinement left the space of cameras; the corners are probably wrong.

    Warns
    -----
    CalibrationWarning
        The answer is doubtful; the sentences are also in ``warnings`` of the result.

    Notes
    -----
    Steps 1 to 4 see the board centred and scaled to unit size and the picture centred and scaled
    to [−1, 1], which keeps their systems well conditioned. Each H stays the one of step 1: the
    notes refine it by itself, but step 5 refines everything at once. The homographies were fitted
    to distorted corners, so steps 2 to 4 are biased (erratum E35); they are only a start. What is
    tried when it leads nowhere stands in `cvnotes.calibration.reserve`.

    References
    ----------
    .. [1] Notes 2b.4, "Zhang's Method".
    .. [2] Z. Zhang, A flexible new technique for camera calibration, PAMI 22 (2000) 1330-1334.

    Examples
    --------
    >>> from cvnotes.camera import Camera, intrinsics
    >>> from cvnotes.camera import Lens
    >>> from cvnotes.camera import pose, rotation_from_vector
    >>> from cvnotes.targets import Chessboard
    >>> board = Chessboard((9, 6), 25.0)
    >>> camera = Camera(intrinsics(800, 804, 325, 238), lens=Lens(k=(-0.25, 0.1)))
    >>> tilts = [(0.5, 0, 0), (0, 0.5, 0), (-0.4, 0.3, 0.1)]
    >>> views = [camera.moved(pose(rotation_from_vector(w), [-90, -60, 450])) for w in tilts]
    >>> seen = [view.project(board.points) for view in views]
    >>> calibrate(board.points, seen, camera.size).A.round(6) + 0.0
    array([[800.,   0., 325.],
           [  0., 804., 238.],
           [  0.,   0.,   1.]])
    """
    size = image_size(size)
    data = Correspondences.of(board_points, image_points)
    choice = None
    if "auto" in (lens, is_board(board, "auto")):
        lenses = CANDIDATES if lens == "auto" else [lens]
        boards = ("flat", "free") if board == "auto" else [board]
        choice = choose_model(
            board_points, image_points, size, lenses=lenses, boards=boards, skew=skew
        )
        lens, board = choice.lens, choice.board
    problem = Problem.of(data, size, lens, skew)
    _refuse_too_few(problem)

    search = Search(problem)
    for start in search.starts():  # the first is nearly always good
        with start.attempt():
            # 1. homographies, board → picture
            H = start.homographies(homography)

            # 2. intrinsics, from what the homographies say about A
            A = start.intrinsics(intrinsics, H)

            # 3. extrinsics, the pose of each view
            G = start.extrinsics(extrinsics, A, H)

            # 4. lens, from what A and the poses leave unexplained
            k = start.distortion(distortion, A, G)

            # 5. refinement of them all: the smallest reprojection error
            start.refine(A, G, k)
    best = search.best()

    #    and of the board's shape with them, unless it is flat
    shape = None
    if board != "flat":
        known = None if choice is None else choice.chosen.hold
        problem, best = shaped(problem, data, board, best, known)
        shape, data = shape_found(problem, data, board, best)

    # Is the answer to be believed? Reprojection errors alone do not tell.
    found = Calibration.of(problem, data, best, shape=shape, choice=choice)
    residuals = Problem.of(data, size, lens, skew).residuals(found.camera, best.x)
    return found.judged(*judge(Diagnostics.of(found, residuals, data.m, data.W, problem.freedom)))


def _refuse_too_few(problem: Problem) -> None:
    """Refuse fewer views, or fewer measured coordinates, than the unknowns need."""
    needed, n_views = 3 if problem.skew else 2, len(problem.m)
    if n_views < needed:
        raise DegenerateError(
            f"need at least {needed} views of the board, got {n_views}: each gives two "
            f"constraints on A, which has {2 * needed - 1 + (needed == 2)} unknowns"
        )
    unknowns = len(problem.names) + 6 * n_views
    remedy = "add views or points, or estimate a simpler lens"
    refuse_too_few(2 * problem.n_seen, unknowns, remedy)
