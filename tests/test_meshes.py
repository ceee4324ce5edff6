from dataclasses import replace

import numpy as np
import pytest

from cvnotes.base import CvnotesError, ShapeError
from cvnotes.camera import pose, rotation_from_vector
from cvnotes.pictures import Scene
from cvnotes.pictures.meshes import Surroundings, box, join, quads

CRATE = box((0, 1), (0, 2), (0, 3))


def test_a_box_is_closed_and_its_faces_are_in_the_order_promised():
    centres = CRATE.corners.reshape(6, 6, 3).mean(axis=1)
    middle = [0.5, 1, 1.5]
    directions = np.sign(np.round(centres - middle, 9))
    assert directions[:, 2].tolist()[:2] == [-1, 1]
    assert directions[2:4, 0].tolist() == [-1, 1]
    assert directions[4:, 1].tolist() == [-1, 1]
    a, b, c = np.moveaxis(CRATE.corners, 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    assert area == pytest.approx(2 * (1 * 2 + 2 * 3 + 3 * 1))


def test_the_edges_of_a_box_are_its_twelve_without_the_diagonals():
    lengths = np.linalg.norm(np.diff(CRATE.vertices[CRATE.edges], axis=1)[:, 0], axis=-1)
    assert sorted(lengths) == [1] * 4 + [2] * 4 + [3] * 4


def test_a_texture_is_measured_in_tiles_from_the_first_corner():
    floor = quads([[5, 0, 5], [9, 0, 5], [9, 0, 7], [5, 0, 7]], [[0, 1, 2, 3]], np.eye(2, 3), 0.5)
    assert floor.uv[0].tolist() == [[0, 0], [8, 0], [8, 4]]
    assert floor.uv[1].tolist() == [[0, 0], [8, 4], [0, 4]]


def test_each_face_may_have_its_own_colours_and_tile():
    colours = np.arange(36.0).reshape(6, 2, 3) / 36
    crate = box((0, 1), (0, 2), (0, 3), colours, [np.inf] * 5 + [0.5])
    assert np.array_equal(crate.colours[::2], colours)
    assert np.array_equal(crate.colours[1::2], colours)
    assert not crate.uv[:10].any()
    assert crate.uv[10:].max() == 6


def test_joined_scenes_keep_their_triangles_and_the_first_surroundings():
    dusk = Surroundings((0.9, 0.5, 0.3))
    other = CRATE.moved(pose(np.eye(3), [9, 0, 0]))
    both = join(replace(CRATE, around=dusk), other)
    assert np.array_equal(both.corners, np.concatenate([CRATE.corners, other.corners]))
    assert both.around == dusk


def test_a_moved_scene_is_carried_by_the_rigid_motion():
    G = pose(rotation_from_vector([0, 0, np.pi / 2]), [10, 0, 0])
    assert np.allclose(CRATE.moved(G).vertices[7], [8, 1, 3], atol=1e-12)
    assert CRATE.vertices[7].tolist() == [1, 2, 3]


def test_arrays_of_a_scene_are_read_only_copies():
    vertices = np.array([[0.0, 0, 5], [2, 0, 5], [2, 1, 5], [0, 1, 5]])
    scene = quads(vertices, [[0, 1, 2, 3]], (1, 1, 1))
    vertices[:] = 7
    assert scene.vertices[1].tolist() == [2, 0, 5]
    with pytest.raises(ValueError, match="read-only"):
        scene.vertices[:] = 0


def nothing():
    none = np.zeros((0, 3))
    return Scene(none, none, np.zeros((0, 2, 3)), np.zeros((0, 3, 2)), np.zeros((0, 2)))


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: box((0, 1), (2, 2), (0, 1)), CvnotesError, r"\(low, high\), got"),
        (lambda: box((0, 1), (0, 1), (0, np.nan)), CvnotesError, "NaN"),
        (lambda: join(), CvnotesError, "at least one"),
        (lambda: quads(np.eye(3), [[0, 1, 2]], (1, 1, 1)), ShapeError, "four corners a face"),
        (lambda: replace(CRATE, uv=np.zeros((12, 2))), ShapeError, r"uv: expected shape"),
        (lambda: replace(CRATE, vertices=np.eye(3)), CvnotesError, "from 0 to 2 point to a vertex"),
        (lambda: replace(CRATE, extent=np.full((12, 2), np.nan)), CvnotesError, "extent.*NaN"),
        (lambda: nothing(), CvnotesError, "at least one triangle"),
        (lambda: Surroundings(light=(0, 0, 0)), CvnotesError, "no direction"),
        (lambda: Surroundings(haze=0), CvnotesError, "positive distance"),
        (lambda: Surroundings(horizon=0.5), ShapeError, "three numbers"),
    ],
)
def test_what_makes_no_scene_is_refused_in_words(make, error, words):
    with pytest.raises(error, match=words):
        make()
