import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from cvnotes.camera import Lens
from cvnotes.camera.lens import Inverse, fold_radius, horner, radial_factor


def wild_lenses(count, seed):
    """Lenses far beyond any that is built, so that every branch of the inverse is taken."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        terms = rng.integers(0, 4)
        k = rng.normal(size=terms) * 10 ** rng.uniform(-2, 1) * [1, 0.5, 0.2][:terms]
        p = rng.normal(size=2) * 10 ** rng.uniform(-4, -0.3) if rng.random() < 0.8 else np.zeros(2)
        yield Lens(tuple(k.tolist()), tuple(p.tolist())), rng


def disc(radius, count, rng):
    r, angle = radius * np.sqrt(rng.uniform(0, 1, count)), rng.uniform(0, 2 * np.pi, count)
    return np.stack([r * np.cos(angle), r * np.sin(angle)], axis=-1)


def circle(radius):
    angle = np.linspace(0, 2 * np.pi, 1441)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


@pytest.mark.parametrize("coefficients", [(), (3.0,), (1.0, -2.0), (1.0, 2.0, 3.0, 4.0)])
def test_horner_is_the_polynomial_written_out(coefficients):
    t = np.array([0.0, 0.5, -2.0])
    written_out = sum((c * t**i for i, c in enumerate(coefficients)), np.zeros(3))
    np.testing.assert_allclose(horner(coefficients, t), written_out, atol=1e-14)


def test_the_radial_factor_is_1_at_the_centre_whatever_the_lens():
    assert radial_factor((-0.3, 0.1, 7.0), np.zeros(1)) == 1
    assert radial_factor((), np.array([4.0])) == 1


@pytest.mark.parametrize(
    ("k", "p", "radius"),
    [
        ((), 0, np.inf),
        ((-4 / 3,), 0, 0.5),  # 1 − 4 r² = 0
        ((0.2,), 0, np.inf),  # pincushion never folds
        ((-0.4,), 0, 1 / np.sqrt(1.2)),
        ((0, -0.2), 0, 1.0),  # 1 − 5·0.2 r⁴ = 0
        ((-2 / 3, 0.2), 0, np.inf),  # (1 − r²)² touches zero at 1 but does not cross it
        ((-2.0, 1.0), 0, np.sqrt(0.2)),  # (1 − r²)(1 − 5 r²)
        ((), 0.01, 1 / 0.06),  # 1 = 6 ‖p‖ r
    ],
)
def test_the_fold_of_a_lens_worked_out_by_hand(k, p, radius):
    assert fold_radius(k, p) == pytest.approx(radius, rel=1e-14)


def test_the_jacobian_is_positive_definite_up_to_the_fold_and_not_beyond():
    for lens, rng in wild_lenses(300, seed=1):
        R = lens.max_radius
        inside = disc(0.999 * min(R, 3.0), 300, rng)
        assert np.linalg.eigvalsh(lens.jacobian(inside)).min() > 0, lens
        if np.isfinite(R):
            beyond = np.linalg.eigvalsh(lens.jacobian(circle(1.001 * R)))
            assert beyond.min() < 1e-6, lens


def test_an_extreme_tangential_lens_folds_first_beside_the_direction_minus_p():
    lens = Lens(k=(2.8, -0.8), p=(0.0, 0.93))
    smallest = np.linalg.eigvalsh(lens.jacobian(circle(lens.max_radius)))[:, 0]
    towards_minus_p = smallest[720]
    assert smallest.min() == pytest.approx(0, abs=1e-6)
    assert towards_minus_p > 0.002


def test_the_inverse_is_right_for_wild_lenses_up_to_99_percent_of_the_fold():
    for lens, rng in wild_lenses(300, seed=2):
        R = 0.99 * min(lens.max_radius, 3.0)
        xy = np.concatenate([disc(R, 200, rng), circle(R)[::12]])
        stretch = np.linalg.eigvalsh(lens.jacobian(xy))[:, :1].clip(max=1)
        error = (lens.undistort(lens.distort(xy)) - xy) * stretch / max(1.0, R)
        np.testing.assert_allclose(error, 0, atol=1e-12, err_msg=repr(lens))


def test_what_the_inverse_answers_is_seen_there_and_the_rest_is_nan():
    answered = 0
    for lens, rng in wild_lenses(300, seed=3):
        xy_lens = rng.normal(size=(200, 2)) * 5 * min(lens.max_radius, 1.0)
        xy = lens.undistort(xy_lens)
        found = ~np.isnan(xy).any(axis=1)
        assert (np.isnan(xy) == ~found[:, None]).all()
        assert (np.hypot(*xy[found].T) <= lens.max_radius).all()
        np.testing.assert_allclose(lens.distort(xy[found]), xy_lens[found], rtol=1e-11, atol=1e-11)
        answered += found.sum()
    assert 10_000 < answered < 50_000


def test_far_beyond_all_numbers_the_inverse_answers_nan_without_a_warning():
    d = np.array([1e-200, 1e-30, 0.0, 1e30, 1e200])
    for lens in (((-0.3,), (0, 0)), ((-0.3,), (1e-3, 1e-3)), ((0.1,), (1e-3, 0)), ((), (1e-3, 0))):
        x, y = Inverse(*lens)(np.stack([d, np.zeros(5)], axis=-1)).T
        np.testing.assert_allclose(np.hypot(x, y)[:3], [0, 1e-30, 0], rtol=1e-12, atol=1e-150)
        assert not np.isfinite(x[4]) or x[4] < 1e200


coefficient = st.floats(-1e3, 1e3) | st.floats(-1e-20, 1e-20) | st.sampled_from([0.0, 1.25, -1.0])
tangential = st.floats(-1, 1) | st.floats(-1e-25, 1e-25)


@given(k=st.lists(coefficient, max_size=4), p=st.tuples(tangential, tangential))
@example(k=[0.0, 1.25, -1.0], p=(0.0, 7e-29))  # its tiniest root was polished to below 0
@settings(max_examples=400, deadline=None, derandomize=True)
@pytest.mark.slow
def test_every_lens_has_a_fold_or_none_and_is_one_to_one_before_it(k, p):
    lens = Lens(tuple(k), p)
    end = lens.max_radius
    assert isinstance(end, float)
    assert end > 0
    radius = np.linspace(0, 0.999, 50)[:, None] * min(end, 100.0)
    angle = np.linspace(0, 2 * np.pi, 24)
    xy = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    J = lens.jacobian(xy)
    size = np.abs(J).max((-2, -1))
    assert (np.linalg.eigvalsh(J)[..., 0] > -1e-9 * size).all()


@given(
    st.lists(st.floats(-2, 2), max_size=4),
    st.floats(0, 0.2),
    st.floats(0, 2 * np.pi),
)
def test_the_radius_that_needs_no_roots_is_below_the_fold(k, p_norm, angle):
    lens = Lens(tuple(k), (p_norm * np.sin(angle), p_norm * np.cos(angle)))
    assert 0 < lens._certain <= lens.max_radius
    for r in lens._certain * np.array([0.5, 0.999999, 1.5]):
        fold = lens.max_radius
        shown_at = float(lens.L(r)) * r
        assert lens.reaches(shown_at) == (fold == np.inf or fold * abs(lens.L(fold)) >= shown_at)
