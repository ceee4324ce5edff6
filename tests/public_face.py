"""Every public function that takes arrays, with arguments that are good.

`tests/test_catalogue.py` spoils them one at a time, row by row of its catalogue of bad input.
"""

from dataclasses import dataclass
from functools import wraps

import numpy as np

from cvnotes import calibration, camera, homography, projective, stereo, targets, warping
from cvnotes.calibration import (
    calibrate,
    next_view,
    ppm,
    prediction_std,
    zhang,
)
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.next_view import left_with
from cvnotes.camera import (
    Camera,
    FisheyeLens,
    Lens,
    RationalLens,
    intrinsics,
    look_at,
    pose,
    rigid,
    rotation_from_vector,
    vanishing,
)
from cvnotes.files import lens_from_opencv
from cvnotes.pictures import expose, gaussian_blur, render
from cvnotes.pictures.meshes import quads
from cvnotes.pictures.pixel_means import polygon_means
from cvnotes.pictures.raycast import first_hits
from cvnotes.targets import Chessboard, TwoPlanes, find_corners, subpixel
from cvnotes.targets.finding import count_corners
from cvnotes.warping import interpolation


@dataclass(frozen=True)
class Argument:
    """What is known of an array argument.

    `columns` are the lengths that its last axis may have (None: any). `empty` tells whether no
    rows at all are a fair question, which is answered by no rows. `homogeneous` numbers mean the
    same in any scale. In a `picture` NaN is allowed, and means nothing known or nowhere.
    """

    columns: tuple = None
    empty: bool = False
    homogeneous: bool = False
    picture: bool = False


@dataclass(frozen=True)
class Function:
    """A public function, good arguments by name, which of them are arrays, and which are sizes.

    The rows of `paired` arrays belong together.
    """

    name: str
    call: object
    good: dict
    arrays: dict
    sizes: tuple
    paired: tuple

    def __str__(self):
        return self.name


def rows(d):
    """Points, each by itself."""
    return Argument((d,), empty=True)


def several(*columns):
    """Points that count together."""
    return Argument(columns)


ANY = Argument(None, empty=True)
ONE = MATRIX = SINGLE = Argument()
PICTURE = Argument(picture=True)

A = intrinsics(800, 804, 325, 238)
LENS = Lens(k=(-0.2, 0.05), p=(0.001, -0.0005))
WIDE = RationalLens((0.3, 0.05, 0.0, 0.6, 0.1, 0.01), (0.001, -0.002))
FISHEYE = FisheyeLens((0.05, -0.01))
CAMERA = Camera(A, look_at([100, -150, -600], [100, 60, 0]), LENS)
BOARD = Chessboard((9, 6), 25.0)
W = BOARD.points
R = rotation_from_vector([0.1, -0.2, 0.3])
G = pose(R, [1.0, 2.0, 500.0])
TILTS = ([0.5, 0, 0], [0, 0.5, 0], [-0.4, 0.3, 0.1], [0.3, 0.3, 0.2])
POSES = np.array([pose(rotation_from_vector(w), [-90, -60, 450.0]) for w in TILTS])
SEEN = np.array([Camera(A, pose, LENS).project(W) for pose in POSES])
PLANE = np.array([Camera(A, pose).project(W) for pose in POSES])  # through no lens
HS = np.array([A @ pose[:3, [0, 1, 3]] for pose in POSES])
HS /= np.linalg.norm(HS, axis=(1, 2), keepdims=True)
H = HS[0]
M = np.array([[100.0, 50.0], [320.0, 240.0], [500.0, 300.0]])
XY = np.array([[0.1, 0.2], [-0.3, 0.1], [0.0, 0.0]])
SOLID = TwoPlanes(BOARD)
BESIDE = Camera(A, look_at([500, 0, -700], [100, 60, -80]), LENS)
SOLID_SEEN = BESIDE.project(SOLID.points)
PPM = BESIDE.P / np.linalg.norm(BESIDE.P)
LEFT = Camera(A, lens=LENS)
RIGHT = LEFT.moved(pose(rotation_from_vector([0, 0.05, 0]), [-80.0, 2, 3]))
SIDE = LEFT.moved(pose(np.eye(3), [-80.0, 0, 0]))
PAIR = np.array(
    [view.project(np.array([[10.0, 20, 900], [-30, 40, 700]])) for view in (LEFT, RIGHT)]
)
GREY = render(BOARD, Camera(A, POSES[0]))
FEW = render(Chessboard((5, 4), 50.0), Camera(A, POSES[0]).resized((240, 180)))
NOISE = np.random.default_rng(0).integers(0, 255, (12, 16)).astype(float)
SQUARE = np.array([[10.0, 10], [40, 12], [42, 40], [9, 38]])
RESULT = calibrate(
    W, SEEN + np.random.default_rng(1).normal(0, 0.2, SEEN.shape), (640, 480), lens="k1 k2 p1 p2"
)
MOVED = POSES.copy()
LINES = np.array([[[0.0, 0], [100, 50]], [[0, 100], [100, 110]], [[0, 210], [100, 170]]])
V_H = np.array([[1120.0, 240, 1], [-480, 240, 1]])
TRIANGLE = np.array([[1120.0, 240], [-480, 300], [300, -900]])
TRUE_B = np.linalg.inv(A).T @ np.linalg.inv(A)
B = TRUE_B[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]
V = zhang.constraints(HS)


def _generator():
    return np.random.default_rng(7)


def function(call, arrays, name=None, *, sizes=(), paired=(), **fixed):
    """Give a Function; `arrays` maps parameters to (good value, Argument)."""
    good = {key: value for key, (value, _) in arrays.items()} | fixed
    known = {key: argument for key, (_, argument) in arrays.items()}
    full = name or f"{call.__module__.removeprefix('cvnotes.')}.{call.__name__}"
    return Function(full, call, good, known, tuple(sizes), tuple(paired))


@wraps(next_view)
def proposed_pose(*args, **kwargs):
    return next_view(*args, **kwargs).G


W2 = W[:, :2].copy()
PAIRS = {"src": (W2, several(2)), "dst": (PLANE[0], several(2))}
FOUR = W2[[0, 8, 45, 53]]
FOURS = {"src": (FOUR, several(2)), "dst": (PLANE[0][[0, 8, 45, 53]], several(2))}
HOMOGENEOUS = Argument((3,), empty=True, homogeneous=True)
POINT4 = Argument((4,), empty=True, homogeneous=True)
EITHER_SPACE = Argument((3, 4), empty=True, homogeneous=True)
SETS = Argument((2,))
EITHER = Argument((2, 3))

FUNCTIONS = [
    # projective
    function(projective.to_homogeneous, {"x": (M, ANY)}),
    function(projective.direction_to_homogeneous, {"d": (M, ANY)}),
    function(projective.from_homogeneous, {"x_h": (M, ANY)}),
    function(projective.apply, {"H": (H, MATRIX), "x": (M, rows(2))}),
    function(
        projective.same_up_to_scale,
        {"a": (H, SINGLE), "b": (2 * H, SINGLE), "atol": (1e-9, ONE)},
    ),
    # rigid
    function(rigid.pose, {"R": (R, MATRIX), "T": (np.array([1.0, 2, 3]), rows(3))}),
    function(rigid.inverse, {"G": (G, MATRIX)}),
    function(rigid.move, {"G": (G, MATRIX), "W": (W, rows(3))}),
    function(rigid.rotation_from_vector, {"w": (W / 100, rows(3))}),
    function(rigid.vector_from_rotation, {"R": (R, MATRIX)}),
    function(rigid.rotation_from_angles, {"x": (0.1, ONE), "y": (0.2, ONE), "z": (0.3, ONE)}),
    function(rigid.nearest_rotation, {"M": (R + 0.01, MATRIX)}),
    function(
        rigid.look_at,
        {
            "eye": (np.array([0.0, 0, -5]), several(3)),
            "target": (np.array([1.0, 1, 1]), several(3)),
            "up": (np.array([0.0, -1, 0]), several(3)),
        },
    ),
    function(lambda motions: rigid.chain(motions, G), {"motions": (G, MATRIX)}, "rigid.chain"),
    function(rigid.board_from_board, {"cam_from_to": (G, MATRIX), "cam_from_from": (G, MATRIX)}),
    function(rigid.cam_from_cam, {"to_from_world": (G, MATRIX), "from_from_world": (G, MATRIX)}),
    function(rigid.skew_matrix, {"v": (W, rows(3))}),
    # lens
    function(
        Lens,
        {
            "k": (np.array([-0.2, 0.05]), SINGLE),
            "p": (np.array([0.001, 0.002]), several(2)),
            "centre": (np.array([0.01, 0.0]), several(2)),
        },
        "lens.Lens",
    ),
    function(LENS.L, {"r": (np.array([0.1, 0.2]), ONE)}, "lens.Lens.L"),
    function(LENS.distort, {"xy": (XY, rows(2))}, "lens.Lens.distort"),
    function(LENS.undistort, {"xy_lens": (XY, rows(2))}, "lens.Lens.undistort"),
    function(LENS.jacobian, {"xy": (XY, rows(2))}, "any_lens.AnyLens.jacobian"),
    function(
        RationalLens,
        {
            "k": (np.array([0.3, 0.05, 0.0, 0.6, 0.1, 0.01]), SINGLE),
            "p": (np.array([0.001, 0.002]), several(2)),
            "s": (np.array([0.001, 0.0, 0.002, 0.0]), several(4)),
            "tilt": (np.array([0.01, -0.02]), several(2)),
        },
        "rational.RationalLens",
    ),
    function(WIDE.L, {"r": (np.array([0.1, 0.2]), ONE)}, "rational.RationalLens.L"),
    function(WIDE.distort, {"xy": (XY, rows(2))}, "rational.RationalLens.distort"),
    function(WIDE.undistort, {"xy_lens": (XY, rows(2))}, "rational.RationalLens.undistort"),
    function(WIDE.of_rays, {"M": (W, rows(3))}, "any_lens.PlaneLens.of_rays"),
    function(WIDE.rays, {"xy_lens": (XY, rows(2))}, "any_lens.PlaneLens.rays"),
    function(FisheyeLens, {"k": (np.array([0.05, -0.01]), SINGLE)}, "fisheye.FisheyeLens"),
    function(FISHEYE.distort, {"xy": (XY, rows(2))}, "any_lens.AnyLens.distort"),
    function(FISHEYE.undistort, {"xy_lens": (XY, rows(2))}, "any_lens.AnyLens.undistort"),
    function(FISHEYE.of_rays, {"M": (W, rows(3))}, "fisheye.FisheyeLens.of_rays"),
    function(FISHEYE.rays, {"xy_lens": (XY, rows(2))}, "fisheye.FisheyeLens.rays"),
    # camera
    function(
        camera.intrinsics,
        {
            n: (x, ONE)
            for n, x in zip(
                ("alpha_u", "alpha_v", "u0", "v0", "skew"), (8e2, 8e2, 3e2, 2e2, 1.0), strict=True
            )
        },
        "camera.intrinsics",
    ),
    function(
        camera.intrinsics_from_pixel_size,
        {
            "f": (8.0, ONE),
            "du": (0.01, ONE),
            "dv": (0.01, ONE),
            "u0": (320.0, ONE),
            "v0": (240.0, ONE),
            "angle": (1.5, ONE),
        },
        "camera.intrinsics_from_pixel_size",
    ),
    function(
        Camera,
        {"A": (A, SINGLE), "G": (G, SINGLE)},
        "camera.Camera",
        sizes=("size",),
        size=(640, 480),
    ),
    function(CAMERA.moved, {"G": (G, SINGLE)}, "camera.Camera.moved"),
    function(
        CAMERA.cropped,
        {"corner": ((100, 60), SINGLE)},
        "camera.Camera.cropped",
        sizes=("size",),
        size=(320, 240),
    ),
    function(CAMERA.resized, {}, "camera.Camera.resized", sizes=("size",), size=(320, 240)),
    function(CAMERA.depth, {"W": (W, rows(3))}, "camera.Camera.depth"),
    function(CAMERA.project, {"W": (W, rows(3))}, "camera.Camera.project"),
    function(CAMERA.ideal, {"m": (M, rows(2))}, "camera.Camera.ideal"),
    function(CAMERA.ray, {"m": (M, rows(2))}, "camera.Camera.ray"),
    function(CAMERA.vanishing_point, {"d": (W, rows(3))}, "camera.Camera.vanishing_point"),
    function(camera.px_from_xy, {"A": (A, SINGLE), "xy": (XY, rows(2))}, "camera.px_from_xy"),
    function(camera.xy_from_px, {"A": (A, SINGLE), "m": (M, rows(2))}, "camera.xy_from_px"),
    function(camera.decompose, {"P": (PPM, SINGLE)}, "camera.decompose"),
    function(camera.centre_of, {"P": (PPM, SINGLE)}, "camera.centre_of"),
    # incidence
    function(
        projective.join,
        {"a": (np.array([1.0, 2, 1]), HOMOGENEOUS), "b": (np.array([3.0, 1, 1]), HOMOGENEOUS)},
        "projective.join",
    ),
    function(
        projective.meet,
        {"k": (np.array([1.0, 2, 1]), HOMOGENEOUS), "m": (np.array([3.0, 1, 1]), HOMOGENEOUS)},
        "projective.meet",
    ),
    function(
        projective.cross_ratio,
        {
            n: (np.array([t, 1.0, 1]), EITHER_SPACE)
            for n, t in zip("abcd", (0.0, 1, 2, 5), strict=True)
        },
        "projective.cross_ratio",
    ),
    function(
        projective.line_through,
        {
            n: (np.array(x), POINT4)
            for n, x in zip("ab", ([1.0, 0, 0, 1], [0, 1.0, 0, 1]), strict=True)
        },
        "projective.line_through",
    ),
    function(
        projective.meet_plane,
        {
            "L": (projective.line_through([1.0, 0, 0, 1], [0, 1.0, 0, 1]), MATRIX),
            "p": (np.array([0, 0, 1.0, 3]), POINT4),
        },
        "projective.meet_plane",
    ),
    # homography and zhang
    function(homography.normaliser, {"x": (W2, several(2, 3))}),
    function(homography.design_matrix, PAIRS, paired=("src", "dst")),
    function(homography.dlt, PAIRS, paired=("src", "dst")),
    function(homography.refine_homography, {"H": (H, MATRIX), **PAIRS}, paired=("src", "dst")),
    function(homography.four_points_h9_one, FOURS),
    function(homography.four_points_unit_norm, FOURS),
    function(homography.geometric_error, {"H": (H, MATRIX), **PAIRS}, paired=("src", "dst")),
    function(zhang.v_ij, {"H": (H, MATRIX)}, i=1, j=2),
    function(zhang.constraints, {"H": (HS, MATRIX)}),
    function(zhang.solve_b, {"V": (V, several(6))}),
    function(zhang.intrinsics_from_b, {"b": (B, several(6))}),
    function(zhang.intrinsics_from_b_by_formulas, {"b": (B, several(6))}),
    function(
        zhang.focal_lengths_from_v,
        {
            "V": (
                zhang.constraints(np.array([[1, 0, -325], [0, 1, -238], [0, 0, 1]]) @ HS),
                several(6),
            )
        },
    ),
    function(zhang.extrinsics, {"A": (A, SINGLE), "H": (HS, MATRIX)}),
    function(
        zhang.radial_distortion,
        {"A": (A, SINGLE), "G": (POSES, MATRIX), "W": (W, several(3)), "m": (SEEN, several(2))},
    ),
    function(
        homography.ransac_homography,
        {**PAIRS, "threshold": (2.0, ONE), "confidence": (0.99, ONE)},
        paired=("src", "dst"),
        rng=_generator,
    ),
    function(homography.trials_needed, {"inlier_fraction": (0.5, ONE), "confidence": (0.99, ONE)}),
    # calibration
    function(
        calibrate,
        {"board_points": (W, EITHER), "image_points": (SEEN, SETS)},
        sizes=("size",),
        paired=("board_points", "image_points"),
        size=(640, 480),
        lens="k1 k2 p1 p2",
    ),
    function(
        Correspondences.of,
        {"board_points": (W, EITHER), "image_points": (SEEN, SETS)},
        "correspondences.Correspondences.of",
        paired=("board_points", "image_points"),
    ),
    function(
        calibration.choose_model,
        {"board_points": (W, EITHER), "image_points": (SEEN, SETS)},
        "choice.choose_model",
        sizes=("size",),
        paired=("board_points", "image_points"),
        size=(640, 480),
        lenses=("k1 k2",),
        boards=("flat", "bent"),
    ),
    function(prediction_std, {"m": (M, rows(2))}, calibration=RESULT),
    function(proposed_pose, {"outline": (W[[0, 8, 45, 53]], several(3))}, calibration=RESULT),
    function(left_with, {"G": (POSES[1], SINGLE)}, calibration=RESULT),
    # resection
    function(
        calibration.resect,
        {"W": (SOLID.points, several(3)), "m": (SOLID_SEEN, several(2))},
        "calibration.resect",
        paired=("W", "m"),
    ),
    function(
        ppm.ppm_dlt,
        {"W": (SOLID.points, several(3)), "m": (SOLID_SEEN, several(2))},
        paired=("W", "m"),
    ),
    function(
        calibration.pose_from_view,
        {"target_points": (W, EITHER), "image_points": (SEEN[0], several(2))},
        "calibration.pose_from_view",
        paired=("target_points", "image_points"),
        camera=Camera(A, lens=LENS),
    ),
    function(
        calibration.calibrate_one_view,
        {"target_points": (SOLID.points, several(3)), "image_points": (SOLID_SEEN, several(2))},
        "calibration.calibrate_one_view",
        paired=("target_points", "image_points"),
        sizes=("size",),
        size=(640, 480),
        lens="k1 k2 p1 p2",
    ),
    # stereo
    function(
        stereo.calibrate_stereo,
        {
            "board_points": (W, EITHER),
            "left_points": (SEEN, SETS),
            "right_points": (SEEN + [5.0, 0], SETS),
        },
        "stereo.calibrate_stereo",
        sizes=("size",),
        size=(640, 480),
    ),
    function(
        stereo.triangulate,
        {"image_points": (PAIR, Argument((2,)))},
        "stereo.triangulate",
        cameras=(LEFT, RIGHT),
    ),
    function(
        stereo.disparity_to_depth,
        {"disparity": (np.array([10.0, 20]), ONE)},
        "stereo.disparity_to_depth",
        left=Camera(A),
        right=Camera(A, SIDE.G),
    ),
    function(
        stereo.rectify,
        {},
        "stereo.rectify",
        sizes=("size",),
        left=LEFT,
        right=RIGHT,
        size=(640, 480),
    ),
    # vanishing
    function(
        vanishing.vanishing_point,
        {"segments": (LINES, several(2))},
        "vanishing.vanishing_point",
    ),
    function(
        vanishing.horizon,
        {"normal": (np.array([0, 1.0, 0.1]), several(3))},
        "vanishing.horizon",
        camera=CAMERA,
    ),
    function(
        vanishing.focal_length,
        {
            "v1": (V_H[0, :2], several(2)),
            "v2": (V_H[1, :2], several(2)),
            "centre": (np.array([320.0, 240]), several(2)),
        },
        "vanishing.focal_length",
    ),
    function(
        vanishing.intrinsics_from_vanishing_points,
        {"v": (TRIANGLE, several(2))},
        "vanishing.intrinsics_from_vanishing_points",
    ),
    # pictures
    function(
        interpolation.interpolate,
        {"image": (NOISE, PICTURE), "m": (M / 100, Argument((2,), empty=True, picture=True))},
        "interpolation.interpolate",
    ),
    function(warping.homography_map, {"H": (H, SINGLE)}, "warping.homography_map"),
    function(
        warping.rotation_map,
        {"angle": (0.1, ONE), "centre": (np.array([3.0, 4]), several(2))},
        "warping.rotation_map",
    ),
    function(
        warping.zoom_map,
        {"factor": (2.0, ONE), "centre": (np.array([3.0, 4]), several(2))},
        "warping.zoom_map",
    ),
    function(
        warping.plane_map,
        {"H": (H, SINGLE), "corner": (np.array([3.0, 4]), several(2)), "pixel": (0.5, ONE)},
        "warping.plane_map",
    ),
    function(warping.zoom_map(2), {"m": (M, rows(2))}, "warping.PixelMap.__call__"),
    function(
        warping.undistortion_map,
        {"new_A": (A, SINGLE), "R": (R, SINGLE)},
        "warping.undistortion_map",
        camera=CAMERA,
    ),
    function(
        warping.map_array,
        {},
        "warping.map_array",
        sizes=("size",),
        mapping=warping.zoom_map(2),
        size=(16, 12),
    ),
    function(
        warping.forward_warp,
        {"image": (NOISE, PICTURE)},
        "warping.forward_warp",
        sizes=("size",),
        mapping=warping.zoom_map(2),
        size=(16, 12),
    ),
    function(
        warping.backward_warp,
        {"image": (NOISE, PICTURE)},
        "warping.backward_warp",
        sizes=("size",),
        mapping=warping.zoom_map(2),
        size=(16, 12),
    ),
    function(
        warping.undistort_image,
        {"image": (NOISE, PICTURE), "new_A": (A, SINGLE)},
        "warping.undistort_image",
        sizes=("size",),
        camera=Camera(A, lens=LENS, size=(16, 12)),
        size=(16, 12),
    ),
    function(
        warping.rectify_plane,
        {
            "image": (NOISE, PICTURE),
            "H": (np.eye(3), SINGLE),
            "region": (np.array([[0.0, 0], [5, 6]]), several(2)),
            "pixel": (0.5, ONE),
        },
        "warping.rectify_plane",
    ),
    function(find_corners, {"image": (GREY, PICTURE)}, board=BOARD),
    function(count_corners, {"image": (FEW, PICTURE)}),
    function(targets.harris, {"image": (NOISE, PICTURE)}, "targets.harris"),
    function(targets.local_maxima, {"response": (NOISE, PICTURE)}, "targets.local_maxima"),
    function(
        targets.refine_subpixel,
        {"image": (GREY, PICTURE), "m": (PLANE[0].round(), rows(2))},
        "targets.refine_subpixel",
    ),
    function(
        targets.refine_edges,
        {"image": (GREY, PICTURE), "m": (PLANE[0].round(), rows(2))},
        "targets.refine_edges",
    ),
    function(
        subpixel.fit_edges,
        {"image": (GREY, PICTURE), "m": (PLANE[0].round(), rows(2))},
        "subpixel.fit_edges",
    ),
    # making pictures
    function(gaussian_blur, {"light": (NOISE, PICTURE)}, sigma=1.5),
    function(expose, {"radiance": (NOISE, PICTURE), "motion": (np.array([1.0, 2]), several(2))}),
    function(polygon_means, {"outline": (SQUARE, several(2))}, sizes=("size",), size=(64, 48)),
    function(
        first_hits,
        {
            "corners": (np.array([[[0.0, 0, 5], [1, 0, 5], [0, 1, 5]]]), several(3)),
            "xy": (np.array([[[0.02, 0.02]]]), Argument((2,), empty=True, picture=True)),
        },
    ),
    function(
        quads,
        {
            "vertices": (np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), several(3)),
            "colours": (np.array([0.1, 0.2, 0.3]), several(3)),
        },
        loops=[[0, 1, 2, 3]],
    ),
    function(
        lens_from_opencv,
        {"coefficients": (np.array([-0.2, 0.05, 0.001, 0.002, 0.0]), SINGLE)},
        "files.lens_from_opencv",
    ),
]
