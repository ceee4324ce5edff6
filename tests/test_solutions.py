"""What `solution` shows: the formula that was asked for, and not a call that hides it."""

import ast
import inspect
import textwrap

import numpy as np
import pytest

from cvnotes.camera import Camera, Lens, intrinsics, px_from_xy
from cvnotes.camera.lens import fold_radius as fold_radius_of_the_library
from cvnotes.learn.ch03.field_of_view import field_of_view
from cvnotes.learn.ch04.fold_radius import fold_radius
from cvnotes.learn.ch04.undistort import undistort
from cvnotes.learn.ch08.backward_warp import backward_warp
from cvnotes.learn.ch08.count_holes import count_holes
from cvnotes.learn.ch08.undistortion_map import undistortion_map
from cvnotes.learn.exercises import EXERCISES, solution
from cvnotes.warping import backward_warp as library_backward_warp
from cvnotes.warping import forward_warp, homography_map, map_array
from cvnotes.warping import undistortion_map as library_undistortion_map

# A choice or a number is asked for in the others, or the steps of `calibrate` put together.
MATHEMATICS = [e.name for e in EXERCISES.values() if e.answer == "function"]
OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.MatMult, ast.Pow)
FORMULAS = ("cross", "concatenate", "svd", "cholesky", "lstsq", "roots", "rint")


def shown(name):
    """Give the functions whose source a solution shows, without their guards."""
    exercise = EXERCISES[name]
    sources = exercise.sources or (exercise.reference,)
    return [inspect.unwrap(getattr(s, "fget", getattr(s, "func", s))) for s in sources]


def calls(function):
    """Give the functions of ours that the body of one calls by name."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    for node in ast.walk(ast.Module(tree.body[0].body, [])):
        if isinstance(node, ast.Call):
            *path, last = ast.unparse(node.func).split(".")
            names = path if last == "inside" else [*path, last]
            found = function.__globals__.get(names[0])
            if names[0] == "self":
                found = function.__globals__[function.__qualname__.split(".")[0]]
            for part in names[1:]:
                found = getattr(found, part, None)
            if (getattr(found, "__module__", "") or "").startswith("cvnotes"):
                yield inspect.unwrap(found)


def is_arithmetic(node):
    if isinstance(node, ast.BinOp):
        return isinstance(node.op, OPERATORS)
    return isinstance(node, ast.Attribute) and node.attr in FORMULAS


@pytest.mark.parametrize("name", MATHEMATICS)
def test_a_solution_contains_its_arithmetic(name):
    bodies = [node.body for node in ast.parse(solution(name).code).body]
    assert any(is_arithmetic(node) for body in bodies for s in body for node in ast.walk(s))


# What stands in a solution without hiding its step: the errors and guards, `solved`, which shows
# the operation, and what says in its name what it does to every reader of the notes.
PLAIN = {
    "solved",
    "_unit",
    "_unit_line",
    "_column_lengths",
    "skew_matrix",
    "pose",
    "Camera",
    "Lens",
}
SIMILARITIES = {"apply_similarity", "inverse_similarity"}
# The subjects of exercises before.
BEFORE = {
    "line_through": {"to_homogeneous"},
    "project": {"of_rays"},  # of a fisheye, which is beyond the notes
    "form_image": {"of_rays", "radial_factor"},
    "design_matrix": {"to_homogeneous"},
    "dlt": {"to_homogeneous"} | SIMILARITIES,
    "four_points": {"to_homogeneous", "normaliser"} | SIMILARITIES,
    "geometric_error": {"to_homogeneous"},
    "ransac": {"dlt"},
    "levenberg_marquardt": {"rotation_from_vector"},
    "depth": {"rectified_baseline"},
    "residuals": {"of_rays", "radial_factor"},
}


@pytest.mark.parametrize("name", MATHEMATICS)
def test_no_call_of_ours_hides_the_step_that_was_asked_for(name):
    sources = shown(name)
    called = {f for source in sources for f in calls(source)} - set(sources)
    hidden = {
        f.__name__
        for f in called
        if not f.__module__.startswith(("cvnotes.base.errors", "cvnotes.base.guards"))
        and not f.__name__.lstrip("_").startswith("refuse")
    }
    assert hidden <= PLAIN | BEFORE.get(name, set())


def test_the_tests_know_a_hidden_step():
    assert inspect.unwrap(px_from_xy) in set(calls(inspect.unwrap(Camera.project)))
    assert fold_radius_of_the_library in set(calls(Lens.__dict__["max_radius"].func))


def random_lenses(n=60):
    rng = np.random.default_rng(3)
    for k in rng.uniform([-0.4, -0.1], [0.3, 0.2], (n, 2)):
        yield k, Lens(tuple(k)), rng


def test_the_undistortion_to_read_is_the_quick_one():
    for k, lens, rng in random_lenses():
        reach = min(0.9 * lens.max_radius, 0.7)
        xy = rng.uniform(-1, 1, (40, 2)) * reach / 2**0.5
        xy_lens = lens.distort(xy)
        np.testing.assert_allclose(undistort(xy_lens, k), xy, rtol=0, atol=1e-11)
        np.testing.assert_allclose(lens.undistort(xy_lens), xy, rtol=0, atol=1e-11)


def test_the_fold_to_read_is_the_librarys():
    folds = [(fold_radius(k), lens.max_radius) for k, lens, _ in random_lenses()]
    ours, librarys = np.array(folds).T
    assert np.isinf(ours).any()
    assert np.isfinite(ours).any()
    np.testing.assert_allclose(ours, librarys, rtol=1e-12)


def test_the_field_of_view_to_read_is_the_cameras():
    A = intrinsics(500, 600, 399.5, 240, skew=3)
    expected = Camera(A, size=(1000, 480)).field_of_view[0]
    np.testing.assert_allclose(field_of_view(A, 1000), expected, rtol=1e-12)


def test_the_warp_to_read_is_the_one_in_tiles():
    rng = np.random.default_rng(4)
    image = rng.integers(0, 255, (23, 31)).astype(float)
    H = np.array([[1.3, 0.2, -3.1], [-0.1, 0.9, 2.3], [4e-3, 2e-3, 1]])
    there = homography_map(np.linalg.inv(H))
    quick = library_backward_warp(image, there, size=(40, 30), method="nearest")
    assert (quick == 0).any()
    np.testing.assert_array_equal(backward_warp(image, H, (40, 30)), quick)


def test_the_map_to_read_is_the_librarys():
    A, k = np.array([[12.0, 0, 4.2], [0, 13.0, 2.7], [0, 0, 1]]), np.array([-0.2, 0.05])
    quick = map_array(library_undistortion_map(Camera(A, lens=Lens(tuple(k)))), (10, 7))
    np.testing.assert_allclose(undistortion_map(A, k, (10, 7)), quick, rtol=1e-12)


def test_the_holes_to_count_are_those_of_the_forward_warp():
    rng = np.random.default_rng(5)
    m = rng.uniform(-2, 12, (60, 2))
    expected = forward_warp(np.ones((1, 60)), m[None], (10, 7)).holes
    assert count_holes(m, (10, 7)) == expected
