import cv2
import numpy as np
import pytest

from cvnotes.base import CvnotesError, DegenerateError, InputTypeError, ShapeError
from cvnotes.homography import dlt, ransac_homography, refine_homography, trials_needed
from cvnotes.projective import apply

H_TRUE = np.array([[1.2, 0.1, 30], [-0.05, 0.9, 20], [2e-4, -1e-4, 1]])
PLACES = np.array([[x, y] for x in (0, 320, 640) for y in (0, 240, 480)], dtype=float)


def _pairs(n, fraction_wrong, rng, sigma=0.5):
    src = rng.uniform(0, 640, (n, 2))
    dst = apply(H_TRUE, src) + rng.normal(0, sigma, (n, 2))
    wrong = np.zeros(n, dtype=bool)
    wrong[: round(fraction_wrong * n)] = True
    dst[wrong] = rng.uniform(0, 800, (wrong.sum(), 2))
    return src, dst, wrong


def _off(H):
    """Largest distance, in pixels, from where the true map takes nine places."""
    return np.linalg.norm(apply(H, PLACES) - apply(H_TRUE, PLACES), axis=-1).max()


@pytest.mark.parametrize(
    ("sample", "row"),
    [
        (2, [2, 3, 5, 6, 7, 11, 17]),
        (4, [3, 5, 9, 13, 17, 34, 72]),
        (8, [5, 9, 26, 44, 78, 272, 1177]),
    ],
)
def test_the_number_of_trials_is_that_of_hartley_and_zisserman_table_4_3(sample, row):
    fractions = [0.95, 0.9, 0.8, 0.75, 0.7, 0.6, 0.5]
    assert [trials_needed(w, 0.99, sample) for w in fractions] == row


def test_one_trial_is_enough_without_outliers_and_none_without_inliers():
    assert trials_needed(1.0) == 1
    assert trials_needed(0.0) == np.inf
    with pytest.raises(CvnotesError, match="inlier_fraction"):
        trials_needed(1.5)
    with pytest.raises(CvnotesError, match="confidence: expected a fraction below 1"):
        trials_needed(0.5, 1.0)


@pytest.mark.parametrize(("n", "fraction"), [(54, 0.3), (200, 0.5), (200, 0.75), (1000, 0.6)])
def test_wrong_pairs_are_found_and_the_map_is_that_of_the_right_ones(n, fraction):
    rng = np.random.default_rng(n)
    src, dst, wrong = _pairs(n, fraction, rng)
    H, inliers = ransac_homography(src, dst, threshold=2.0, rng=rng)
    off_true = np.linalg.norm(dst - apply(H_TRUE, src), axis=-1)
    assert not inliers[off_true > 5].any()
    assert inliers[~wrong].mean() > 0.97
    assert _off(H) < 1.5
    assert inliers.dtype == bool
    np.testing.assert_allclose(np.linalg.norm(H), 1, atol=1e-12)


def test_least_squares_alone_is_ruined_by_the_same_pairs():
    src, dst, _ = _pairs(54, 0.1, np.random.default_rng(0))
    least_squares = refine_homography(dlt(src, dst), src, dst)
    robust, _ = ransac_homography(src, dst, threshold=2, rng=np.random.default_rng(0))
    assert _off(least_squares) > 50 * _off(robust)


def test_without_wrong_pairs_it_is_the_least_squares_map():
    src, dst, _ = _pairs(100, 0, np.random.default_rng(1))
    H, inliers = ransac_homography(src, dst, threshold=5.0, rng=np.random.default_rng(1))
    assert inliers.all()
    np.testing.assert_allclose(H, refine_homography(dlt(src, dst), src, dst), atol=1e-9)


def test_the_answer_minimises_the_error_of_its_own_inliers():
    src, dst, _ = _pairs(200, 0.4, np.random.default_rng(2))
    H, inliers = ransac_homography(src, dst, threshold=2.0, rng=np.random.default_rng(2))
    by_opencv, _ = cv2.findHomography(src[inliers], dst[inliers], 0)
    np.testing.assert_allclose(apply(H, PLACES), apply(by_opencv, PLACES), atol=1e-3)
    assert (np.linalg.norm(apply(H, src) - dst, axis=-1) <= 2.0).tolist() == inliers.tolist()


def test_it_is_closer_to_the_truth_than_opencv_on_most_sets():
    ours, theirs = [], []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        src, dst, _ = _pairs(300, 0.5, rng)
        ours.append(_off(ransac_homography(src, dst, threshold=1.5, rng=rng)[0]))
        theirs.append(_off(cv2.findHomography(src, dst, cv2.RANSAC, 1.5, confidence=0.999)[0]))
    assert np.median(ours) < np.median(theirs)
    assert max(ours) < 1.5


@pytest.mark.parametrize(
    ("n", "fraction", "sigma", "threshold"),
    [(40, 0.5, 0.5, 1.5), (80, 0.5, 1, 1.5), (150, 0.7, 1, 2)],
)
@pytest.mark.slow
def test_the_worst_of_twenty_seeds_is_no_worse_than_opencvs(n, fraction, sigma, threshold):
    # Without local optimisation 4.9 px against 3.2 in the first set, the median 1.31 against 1.19
    # in the last.
    ours, theirs = [], []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        src, dst, _ = _pairs(n, fraction, rng, sigma)
        ours.append(_off(ransac_homography(src, dst, threshold=threshold, rng=rng)[0]))
        theirs.append(
            _off(cv2.findHomography(src, dst, cv2.RANSAC, threshold, confidence=0.999)[0])
        )
    assert max(ours) < 0.8 * max(theirs)
    assert np.median(ours) < np.median(theirs)


def test_pairs_far_from_a_crowd_are_not_lost():
    """Most right pairs lie in one corner, whose map misses the few others by many thresholds."""
    ours, theirs = [], []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        crowd = rng.normal([200, 150], 40, (100, 2))
        src = np.concatenate([crowd, rng.uniform(0, 640, (20, 2))])
        dst = apply(H_TRUE, src) + rng.normal(0, 0.5, src.shape)
        wrong = rng.permutation(120)[:72]
        dst[wrong] = rng.uniform(0, 800, (72, 2))
        ours.append(_off(ransac_homography(src, dst, threshold=1.5, rng=rng)[0]))
        for method in (cv2.RANSAC, cv2.USAC_DEFAULT):
            theirs.append(_off(cv2.findHomography(src, dst, method, 1.5, confidence=0.999)[0]))
    # Without growing what was found, 12 px; OpenCV 21 px, and 9.5 px with local optimisation.
    assert max(ours) < 5
    assert max(ours) < 0.5 * max(theirs)
    assert np.median(ours) < np.median(theirs)


def test_the_seed_decides():
    src, dst, _ = _pairs(100, 0.5, np.random.default_rng(3))
    a = ransac_homography(src, dst, threshold=2, rng=np.random.default_rng(7))
    b = ransac_homography(src, dst, threshold=2, rng=np.random.default_rng(7))
    np.testing.assert_array_equal(a[0], b[0])
    np.testing.assert_array_equal(a[1], b[1])


def test_another_seed_finds_the_same_right_pairs():
    src, dst, _ = _pairs(100, 0.5, np.random.default_rng(3), sigma=0.2)
    sets = {
        tuple(ransac_homography(src, dst, threshold=3, rng=np.random.default_rng(seed))[1])
        for seed in range(5)
    }
    assert len(sets) == 1


def test_the_order_of_the_pairs_does_not_matter():
    src, dst, _ = _pairs(100, 0.5, np.random.default_rng(3), sigma=0.2)
    mixed = np.random.default_rng(1).permutation(100)
    H, inliers = ransac_homography(src, dst, threshold=3, rng=np.random.default_rng(0))
    H2, inliers2 = ransac_homography(
        src[mixed], dst[mixed], threshold=3, rng=np.random.default_rng(0)
    )
    np.testing.assert_array_equal(inliers2, inliers[mixed])
    np.testing.assert_allclose(H2, H, atol=1e-9)


def test_points_in_kilometres_far_from_the_origin_change_nothing():
    src, dst, _ = _pairs(100, 0.4, np.random.default_rng(5))
    H, inliers = ransac_homography(src, dst, threshold=2, rng=np.random.default_rng(0))
    far = 1e-6 * src + [1e3, -2e3]
    H_far, inliers_far = ransac_homography(far, dst, threshold=2, rng=np.random.default_rng(0))
    np.testing.assert_array_equal(inliers_far, inliers)
    np.testing.assert_allclose(apply(H_far, far), apply(H, src), atol=1e-3)


def test_an_origin_seen_at_infinity_is_no_obstacle():
    # h9 = 0: both printed normalisations of the 4-point case fail here (erratum E27)
    H = np.array([[1.0, 0.2, 0], [0.1, 1, 0.5], [0.3, 0.4, 0]])
    rng = np.random.default_rng(0)
    src = rng.uniform(1, 5, (60, 2))
    dst = apply(H, src)
    dst[:20] = rng.uniform(dst.min(0), dst.max(0), (20, 2))
    found, inliers = ransac_homography(src, dst, threshold=1e-6, rng=rng)
    assert inliers[20:].all()
    np.testing.assert_allclose(found / found[1, 1], H, atol=1e-9)


def test_a_mirrored_picture_is_mapped_too():
    src, dst, wrong = _pairs(60, 0.3, np.random.default_rng(0))
    H, inliers = ransac_homography(src, [640, 0] - dst * [1, -1], threshold=2,
                                   rng=np.random.default_rng(0))  # fmt: skip
    assert np.linalg.det(H) < 0
    assert inliers[~wrong].mean() > 0.95


def test_pairs_on_the_far_side_of_the_vanishing_line_do_not_agree():
    rng = np.random.default_rng(0)
    H = np.array([[1.0, 0, 0], [0, 1, 0], [0.01, 0, 1]])
    src = rng.uniform(0, 100, (50, 2))
    behind = rng.uniform([-300, 0], [-200, 100], (20, 2))  # w < 0: no camera shows these
    pairs = np.vstack([src, behind])
    _, inliers = ransac_homography(pairs, apply(H, pairs), threshold=1e-6, rng=rng)
    assert inliers[:50].all()
    assert not inliers[50:].any()


def test_a_grid_with_its_many_collinear_samples_is_handled():
    src = np.array([[x, y] for y in range(6) for x in range(9)], dtype=float)
    dst = apply(H_TRUE, 25 * src)
    dst[[3, 17, 40]] += [[30, 5], [-20, 20], [5, -44]]
    H, inliers = ransac_homography(25 * src, dst, threshold=0.5, rng=np.random.default_rng(0))
    assert np.flatnonzero(~inliers).tolist() == [3, 17, 40]
    assert _off(H) < 1e-6


@pytest.mark.parametrize("threshold", [0.5, 3.0, 20.0, 200.0])
@pytest.mark.parametrize("n", [6, 54, 200])
def test_hopeless_data_are_refused(n, threshold):
    for seed in range(5):
        rng = np.random.default_rng(seed)
        src, dst = rng.uniform(0, 640, (2, n, 2))
        with pytest.raises(DegenerateError, match="no more than chance"):
            ransac_homography(src, dst, threshold=threshold, rng=rng, max_trials=1500)


def test_a_threshold_far_below_the_noise_is_refused_rather_than_believed():
    src, dst, _ = _pairs(60, 0, np.random.default_rng(0), sigma=2.0)
    with pytest.raises(DegenerateError, match="threshold does not fit their noise"):
        ransac_homography(src, dst, threshold=1e-3, rng=np.random.default_rng(0), max_trials=500)


@pytest.mark.parametrize("flat", ["src", "dst", "both"])
def test_points_on_a_line_are_refused(flat):
    rng = np.random.default_rng(0)
    src, dst, _ = _pairs(30, 0, rng)
    line = np.outer(np.arange(30.0), [3, 4])
    src, dst = (line if flat != "dst" else src), (2 * line if flat != "src" else dst)
    with pytest.raises(DegenerateError):
        ransac_homography(src, dst, threshold=1, rng=rng, max_trials=500)


def test_bad_arguments_are_refused_in_words():
    src, dst, _ = _pairs(20, 0, np.random.default_rng(0))
    rng = np.random.default_rng(0)
    with pytest.raises(DegenerateError, match="at least 5 points, got 4"):
        ransac_homography(src[:4], dst[:4], threshold=1, rng=rng)
    with pytest.raises(ShapeError, match="20 points but dst has 19"):
        ransac_homography(src, dst[1:], threshold=1, rng=rng)
    with pytest.raises(ShapeError, match=r"expected point pairs \(n, 2\)"):
        ransac_homography(src[None], dst[None], threshold=1, rng=rng)
    with pytest.raises(CvnotesError, match="dst contains NaN"):
        ransac_homography(src, np.where(dst < 100, np.nan, dst), threshold=1, rng=rng)
    with pytest.raises(CvnotesError, match="threshold: expected a positive distance, got 0"):
        ransac_homography(src, dst, threshold=0, rng=rng)
    with pytest.raises(InputTypeError, match="threshold"):
        ransac_homography(src, dst, threshold="1", rng=rng)
    with pytest.raises(CvnotesError, match=r"numpy.random.Generator .*got 5"):
        ransac_homography(src, dst, threshold=1, rng=5)
    with pytest.raises(CvnotesError, match="confidence"):
        ransac_homography(src, dst, threshold=1, rng=rng, confidence=1.0)
    with pytest.raises(CvnotesError, match="max_trials: expected a whole number from 1"):
        ransac_homography(src, dst, threshold=1, rng=rng, max_trials=0)
    with pytest.raises(DegenerateError, match="coincide"):
        ransac_homography(np.ones((9, 2)), dst[:9], threshold=1, rng=rng)


def test_inputs_are_not_written_to_and_lists_do_as_well():
    src, dst, _ = _pairs(40, 0.3, np.random.default_rng(0))
    src.setflags(write=False)
    dst.setflags(write=False)
    H, _ = ransac_homography(src, dst, threshold=2, rng=np.random.default_rng(0))
    H_list, _ = ransac_homography(
        src.tolist(), dst.tolist(), threshold=2, rng=np.random.default_rng(0)
    )
    np.testing.assert_array_equal(H_list, H)
