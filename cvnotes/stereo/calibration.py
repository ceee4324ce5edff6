"""Stereo calibration: two cameras and how they stand to each other, from pairs of pictures."""

from warnings import catch_warnings, simplefilter

from cvnotes.calibration import LENSES, calibrate
from cvnotes.camera import Camera
from cvnotes.correspondences import Correspondences, PointSets
from cvnotes.errors import (
    CalibrationWarning,
    CvnotesError,
    DegenerateError,
    ShapeError,
    image_size,
)
from cvnotes.projection import is_camera
from cvnotes.refine import Problem
from cvnotes.stereo.joint import refined
from cvnotes.stereo.refinement import StereoProblem
from cvnotes.stereo.result import StereoCalibration


def calibrate_stereo(
    board_points: PointSets,
    left_points: PointSets,
    right_points: PointSets,
    size: tuple[int, int],
    *,
    lens: str = "k1 k2",
    skew: bool = False,
) -> StereoCalibration:
    """Calibrate two cameras and their relative pose from pairs of pictures of a planar board.

    Parameters
    ----------
    board_points : array_like, shape (n, 2) or (n, 3), or a list of such
        The corners on the board, Z = 0; one set for all pairs, or one for each.
    left_points, right_points : array_like, shape (n_views, n, 2), or lists of (n_i, 2)
        The same corners in the left and right pictures, in pixels; pair i was taken at once.
    size : (width, height)
        Size of the pictures.
    lens : {"none", "k1", "k1 k2", "k1 k2 k3", "k1 k2 p1 p2", "k1 k2 p1 p2 k3"}
        Which lens coefficients of either camera are estimated.
    skew : bool
        Estimate the skew of both cameras too.

    Returns
    -------
    StereoCalibration
        With error bars, and with sentences about what is doubtful.

    Raises
    ------
    DegenerateError
        Too few views or points, or pairs that do not fit two cameras on one rig.

    Warns
    -----
    CalibrationWarning
        The answer is doubtful; the sentences are also in ``warnings`` of the result.

    Notes
    -----
    1. Each camera is calibrated by itself; 2. every pair then gives a relative pose, of which the
    median is taken; 3. both cameras, the relative pose and one board pose for each pair are
    refined together (see `cvnotes.stereo.refinement`). One board pose for two pictures is what
    sharpens both cameras.

    References
    ----------
    .. [1] Notes 2b.4 for one camera; stereo is named in 2b.5.

    Examples
    --------
    >>> import numpy as np
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.rigid import chain, pose, rotation_from_vector
    >>> from cvnotes.targets import Chessboard
    >>> board = Chessboard((9, 6), 25.0)
    >>> left = Camera(intrinsics(800, 804, 325, 238))
    >>> right = Camera(intrinsics(790, 794, 315, 243), pose(np.eye(3), [-100, 0, 0]))
    >>> tilts = [(0.5, 0, 0), (0, 0.5, 0), (-0.4, 0.3, 0.1)]
    >>> boards = [pose(rotation_from_vector(w), [-40, -60, 600]) for w in tilts]
    >>> seen = [[c.moved(chain(c.G, G)).project(board.points) for G in boards]
    ...         for c in (left, right)]
    >>> rig = calibrate_stereo(board.points, *seen, left.size, lens="none")
    >>> rig.T.round(6) + 0.0
    array([-100.,    0.,    0.])
    """
    if not isinstance(lens, str) or lens not in LENSES:
        raise CvnotesError(f"lens: expected one of {', '.join(map(repr, LENSES))}, got {lens!r}")
    size = image_size(size)
    pairs = _pairs(board_points, left_points, right_points)
    n_radial, tangential = LENSES[lens]
    problems = [Problem(d.W, d.m, d.seen, skew, n_radial, tangential) for d in pairs]
    cameras = []
    for side, points in (("left", left_points), ("right", right_points)):
        with catch_warnings():  # what is doubtful is judged once, at the joint optimum
            simplefilter("ignore", CalibrationWarning)
            try:
                cameras.append(calibrate(board_points, points, size, lens=lens, skew=skew).camera)
            except DegenerateError as error:
                raise DegenerateError(f"{side} camera: {error}") from error
    return refined(StereoProblem(problems[0], problems[1]), pairs, cameras)


def calibrate_relative_pose(
    left: Camera,
    right: Camera,
    board_points: PointSets,
    left_points: PointSets,
    right_points: PointSets,
) -> StereoCalibration:
    """Find how two calibrated cameras stand to each other, from one or more pairs of pictures.

    Parameters
    ----------
    left, right : Camera
        Their A and lens are held; their own poses are not used.
    board_points, left_points, right_points
        As in `calibrate_stereo`.

    Returns
    -------
    StereoCalibration
        The given cameras with their relative pose, and its error bars.

    Raises
    ------
    DegenerateError
        The pairs do not fit two cameras on one rig.

    Examples
    --------
    >>> import numpy as np
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.rigid import chain, nearest_rotation, pose
    >>> from cvnotes.targets import Chessboard
    >>> board = Chessboard((9, 6), 25.0)
    >>> left = Camera(intrinsics(800, 804, 325, 238))
    >>> right = Camera(intrinsics(790, 794, 315, 243), pose(np.eye(3), [-100, 0, 0]))
    >>> G = pose(nearest_rotation([[1, 0, 0.1], [0, 1, 0.2], [-0.1, -0.2, 1]]), [-40, -60, 600])
    >>> seen = [c.moved(chain(c.G, G)).project(board.points) for c in (left, right)]
    >>> calibrate_relative_pose(left, right, board.points, *seen).T.round(6) + 0.0
    array([-100.,    0.,    0.])
    """
    for name, camera in (("left", left), ("right", right)):
        if any(is_camera(camera, name).lens.centre):
            raise CvnotesError(
                f"{name}: the refinement knows lenses centred on the piercing point only, got "
                f"{camera.lens}"
            )
    pairs = _pairs(board_points, left_points, right_points)
    problems = [
        Problem(d.W, d.m, d.seen, bool(c.A[0, 1]), len(c.lens.k), any(c.lens.p))
        for d, c in zip(pairs, (left, right), strict=True)
    ]
    problem = StereoProblem(problems[0], problems[1], cameras_known=True)
    return refined(problem, pairs, [left, right])


def _pairs(
    board_points: PointSets, left_points: PointSets, right_points: PointSets
) -> tuple[Correspondences, Correspondences]:
    """Pair corners with the board in both pictures, or say what does not fit together."""
    left = Correspondences.of(board_points, left_points, name="left_points")
    right = Correspondences.of(board_points, right_points, name="right_points")
    if len(left) != len(right):
        raise ShapeError(
            f"left_points has {len(left)} views but right_points has {len(right)}; each left "
            "picture needs its partner, taken at the same moment"
        )
    return left, right
