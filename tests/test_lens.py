import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cvnotes.base import CvnotesError, InputTypeError, ShapeError
from cvnotes.camera import Lens

BARREL = Lens(k=(-0.28, 0.09, -0.012), p=(0.0011, -0.0007))
OPENCV = np.array([-0.28, 0.09, 0.0011, -0.0007, -0.012])  # k1 k2 p1 p2 k3
A = np.array([[800.0, 0, 640], [0, 805, 480], [0, 0, 1]])


def grid(radius, n=41):
    x, y = np.meshgrid(np.linspace(-radius, radius, n), np.linspace(-radius, radius, n))
    xy = np.stack([x, y], axis=-1).reshape(-1, 2)
    return xy[np.hypot(x, y).ravel() <= radius]


# --- distort -------------------------------------------------------------------------------------


def test_the_radial_factor_by_hand():
    # 1 − 0.2·4 + 0.1·16
    assert Lens(k=(-0.2, 0.1)).L(2.0) == pytest.approx(1.8, abs=1e-15)
    assert Lens(k=(-0.2, 0.1)).L([0.0, 1.0]) == pytest.approx([1.0, 0.9], abs=1e-15)


def test_the_tangential_terms_by_hand():
    # x = 0.3, y = 0.4, r² = 0.25:
    # 2·0.01·0.12 + 0.02·(0.25 + 0.18) and 0.01·(0.25 + 0.32) + 2·0.02·0.12
    moved = Lens(p=(0.01, 0.02)).distort([0.3, 0.4])
    np.testing.assert_allclose(moved, [0.3 + 0.011, 0.4 + 0.0105], atol=1e-16)


def test_five_coefficients_mean_what_they_mean_to_opencv():
    xy = grid(0.7)
    W = np.concatenate([xy, np.ones((len(xy), 1))], axis=1)
    theirs = cv2.projectPoints(W, np.zeros(3), np.zeros(3), A, OPENCV)[0].reshape(-1, 2)
    ours = BARREL.distort(xy) * [800, 805] + [640, 480]
    np.testing.assert_allclose(ours, theirs, atol=1e-9)


def test_a_lens_off_centre_is_a_centred_lens_with_the_origin_moved():
    off = Lens(k=(-0.2, 0.05), p=(0.001, 0.002), centre=(0.1, -0.05))
    centred = Lens(k=(-0.2, 0.05), p=(0.001, 0.002))
    xy = grid(0.4)
    np.testing.assert_allclose(
        off.distort(xy), centred.distort(xy - [0.1, -0.05]) + [0.1, -0.05], atol=1e-15
    )
    np.testing.assert_allclose(off.distort([0.1, -0.05]), [0.1, -0.05], atol=0)
    np.testing.assert_allclose(off.undistort(off.distort(xy)), xy, atol=1e-14)


def test_beyond_the_fold_a_point_has_no_image():
    lens = Lens(k=(-4 / 3,))
    moved = lens.distort([[0.4999, 0], [0, -0.5], [0.5001, 0], [3, 4]])
    assert np.isnan(moved).all(axis=1).tolist() == [False, False, True, True]
    np.testing.assert_allclose(moved[1], [0, -1 / 3], atol=1e-16)


def test_the_jacobian_is_the_derivative():
    xy, h = grid(0.6, 9), 1e-6
    for lens in (BARREL, Lens(k=(0.2,), p=(0.01, -0.02), centre=(0.1, 0.2)), Lens()):
        columns = [(lens.distort(xy + e) - lens.distort(xy - e)) / (2 * h) for e in h * np.eye(2)]
        np.testing.assert_allclose(lens.jacobian(xy), np.stack(columns, -1), atol=1e-9)


def test_a_perfect_lens_moves_nothing_not_even_by_rounding():
    xy = np.random.default_rng(0).normal(size=(50, 2))
    for lens in (Lens(), Lens(k=(0.0, 0.0)), Lens(centre=(0.3, 0.1))):
        assert lens.is_ideal
        assert (lens.distort(xy) == xy).all()
        assert (lens.undistort(xy) == xy).all()
        assert lens.max_radius == np.inf


# --- undistort -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "lens",
    [
        BARREL,
        Lens(k=(-0.4,)),
        Lens(k=(-0.4,), p=(0.002, -0.001)),
        Lens(k=(-0.25, 0.1), p=(0.001, -0.0005)),
        Lens(k=(0.3,)),
        Lens(k=(0.1, 0.2, 0.3, 0.4)),
        Lens(p=(0.01, 0.01)),
        Lens(k=(-0.3,), centre=(0.05, -0.02)),
    ],
    ids=repr,
)
def test_undistorting_gives_back_what_was_distorted_to_1e_12_up_to_99_percent_of_the_fold(lens):
    xy = grid(0.99 * min(lens.max_radius, 1.0)) + lens.centre
    np.testing.assert_allclose(lens.undistort(lens.distort(xy)), xy, atol=1e-12)


@given(
    k=st.lists(st.floats(-0.5, 0.5), max_size=4),
    p=st.tuples(st.floats(-0.01, 0.01), st.floats(-0.01, 0.01)),
    angle=st.floats(0, 6.3),
    part=st.floats(0, 0.98),
)
def test_undistort_after_distort_is_the_identity(k, p, angle, part):
    lens = Lens(k=tuple(k), p=p)
    r = part * min(lens.max_radius, 2.0)
    xy = np.array([r * np.cos(angle), r * np.sin(angle)])
    np.testing.assert_allclose(lens.undistort(lens.distort(xy)), xy, atol=1e-10)


def test_the_centre_stays_where_it_is_without_dividing_by_zero():
    for lens in (BARREL, Lens(k=(-0.3,), centre=(0.2, 0.1)), Lens(p=(0.01, 0.0))):
        np.testing.assert_allclose(lens.undistort(lens.centre), lens.centre, atol=1e-16)


def test_a_point_that_the_lens_shows_nowhere_is_nan_and_its_neighbours_are_not():
    lens = Lens(k=(-4 / 3,))  # shows nothing beyond 0.5·(1 − 1/3) = 1/3
    back = lens.undistort([[0.33, 0], [0.34, 0], [0, 1 / 3 - 1e-9], [100, 100]])
    assert np.isnan(back).all(axis=1).tolist() == [False, True, False, True]
    assert back[2, 1] == pytest.approx(0.5, abs=1e-4)


def test_coefficients_that_no_lens_has_end_in_numbers_or_nan_not_in_a_hang():
    xy = grid(1.0)
    for k in ((1e5,), (-1e5,), (1e3, -1e5, 1e4), (-1e3, 1e3), (0, 0, 1e5)):
        for p in ((0, 0), (100.0, -1e3)):
            lens = Lens(k=k, p=p)
            back = lens.undistort(xy)
            seen = ~np.isnan(back[:, 0])
            np.testing.assert_allclose(lens.distort(back[seen]), xy[seen], atol=1e-9)


def test_opencv_agrees_once_it_is_allowed_to_converge():
    m = BARREL.distort(grid(0.6)) * [800, 805] + [640, 480]
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 500, 1e-15)
    try:
        theirs = cv2.undistortPoints(m.reshape(-1, 1, 2), A, OPENCV, criteria=criteria)
    except (cv2.error, TypeError):  # OpenCV 4 has another name for it
        theirs = cv2.undistortPointsIter(m.reshape(-1, 1, 2), A, OPENCV, None, None, criteria)
    ours = BARREL.undistort((m - [640, 480]) / [800, 805])
    np.testing.assert_allclose(ours, theirs.reshape(-1, 2), atol=1e-11)


def test_points_come_back_in_the_shape_and_in_the_order_they_came():
    xy = np.random.default_rng(0).uniform(-0.4, 0.4, (3, 10_000, 2))  # more than one piece of work
    seen = BARREL.distort(xy)
    assert seen.shape == BARREL.undistort(seen).shape == (3, 10_000, 2)
    np.testing.assert_allclose(BARREL.undistort(seen), xy, atol=1e-14)
    np.testing.assert_allclose(BARREL.undistort(seen[1, 7]), xy[1, 7], atol=1e-14)
    assert BARREL.undistort(np.zeros((0, 2))).shape == (0, 2)


# --- guards --------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["distort", "undistort", "jacobian"])
@pytest.mark.parametrize(
    ("xy", "error", "words"),
    [
        ([[0.1, np.nan]], CvnotesError, "NaN or infinite"),
        ([[np.inf, 0.1]], CvnotesError, "NaN or infinite"),
        (
            np.zeros((2, 54)),
            ShapeError,
            r"expected shape \(\.\.\., 2\), got \(2, 54\); points",
        ),
        (np.zeros((5, 3)), ShapeError, r"expected shape \(\.\.\., 2\), got \(5, 3\)"),
        (0.5, ShapeError, "expected shape"),
        (None, InputTypeError, "got None"),
        ("here", InputTypeError, "numeric"),
        ([[1j, 0]], InputTypeError, "numeric"),
        (np.ma.masked_array([[0.1, 0.2]], mask=[[1, 0]]), InputTypeError, "masked"),
    ],
)
def test_unusable_points_are_refused_in_words(method, xy, error, words):
    with pytest.raises(error, match=words):
        getattr(BARREL, method)(xy)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"k": (np.nan,)}, "k contains NaN"),
        ({"k": 0.1}, "k: expected a sequence k1, k2"),
        ({"p": (0.1,)}, "p: expected two numbers"),
        ({"p": (0.1, np.inf)}, "p contains NaN"),
        ({"centre": (0, 0, 0)}, "centre: expected two numbers"),
        ({"k": (1e308,)}, "no lens has such coefficients"),
    ],
)
def test_unusable_coefficients_are_refused_in_words(arguments, words):
    with pytest.raises(CvnotesError, match=words):
        Lens(**arguments)


@pytest.mark.parametrize("method", ["distort", "undistort"])
def test_numbers_in_any_dress_give_the_same_points_and_are_not_written_to(method):
    xy = np.array([[0.25, -0.5], [0.125, 0.0], [-0.375, 0.25]])
    frozen = xy.copy()
    frozen.setflags(write=False)
    doubled = np.repeat(xy, 2, axis=0)
    dresses = [
        frozen,
        xy.tolist(),
        tuple(map(tuple, xy.tolist())),
        xy.astype(np.float32),
        xy.astype(">f8"),
        np.asfortranarray(xy),
        doubled[::2],
        xy[::-1][::-1],
    ]
    expected = getattr(BARREL, method)(xy)
    for dress in dresses:
        np.testing.assert_array_equal(getattr(BARREL, method)(dress), expected)
    assert (frozen == xy).all()


def test_lenses_with_equal_coefficients_are_equal_however_they_were_given():
    assert Lens(k=[-0.1, 0], p=np.array([0, 0.5])) == Lens(k=(-0.1, 0.0), p=(0.0, 0.5))
    assert len({Lens(k=(-0.1,)), Lens(k=[-0.1])}) == 1
