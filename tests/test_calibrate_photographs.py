"""Photographs in, a camera out: one function of the library, with reasons that are objects."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cvnotes.base import CornersNotFound, CvnotesError, DegenerateError, FileError, InputTypeError
from cvnotes.camera import pose, rotation_from_vector
from cvnotes.commands.report import note_of
from cvnotes.files import Photo
from cvnotes.files.reasons import Copy, OtherSize
from cvnotes.photographs import (
    Detection,
    Exchanged,
    LeftOut,
    Misfit,
    Model,
    NoBoard,
    NoCamera,
    Photographs,
    calibrate_detected,
    calibrate_photographs,
    detect_photographs,
)
from cvnotes.pictures import course

BOARD = course.board()


@pytest.fixture(scope="module")
def photos():
    return course.photos()


def reasons(found):
    """Return the reasons by name."""
    return {r.file: r.reason for r in found.photographs.rejected}


@pytest.mark.slow
def test_each_reason_is_an_object_with_its_numbers(photos):
    zoomed = np.kron(photos[6][120:360, 160:480], np.ones((2, 2), np.uint8))
    given = [
        *photos[:6],
        photos[2],
        photos[7][:, :600],
        np.full_like(photos[0], 128),
        np.ascontiguousarray(photos[8][:, ::-1]),
        zoomed,
        photos[9],
    ]
    options = {"lens": "k1 k2", "board_shape": "flat", "leave_out": ["photograph 11"]}
    found = calibrate_photographs(given, BOARD, **options)
    why = reasons(found)
    assert why["photograph 6"] == Copy("photograph 2")
    assert why["photograph 7"] == OtherSize((600, 480), (640, 480))
    assert isinstance(why["photograph 8"], NoBoard)
    assert why["photograph 9"] == Exchanged()
    assert why["photograph 11"] == LeftOut()
    if "photograph 10" in why:  # a board that fills the picture may not be found at all
        assert isinstance(why["photograph 10"], Misfit | NoBoard)
    assert len(found.photographs.used) == 6
    alone = calibrate_photographs(photos[:6], BOARD, lens="k1 k2", board_shape="flat")
    np.testing.assert_array_equal(found.calibration.A, alone.calibration.A)
    assert "photograph 9: left and right seem exchanged, so" in " ".join(found.doubts)
    assert found.reliable
    assert found.next_view.after < found.next_view.before


def test_a_view_that_does_not_fit_is_left_out_with_its_numbers(photos):
    seen = detect_photographs(photos[:7], BOARD)
    last, rng = seen.looked_at[6], np.random.default_rng(0)
    badly_found = replace(last, corners=last.corners + rng.normal(0, 2, last.corners.shape))
    seen = replace(seen, looked_at=[*seen.looked_at[:6], badly_found])
    model = Model(lens="k1 k2", board_shape="flat")
    kept = calibrate_detected(seen, model, keep_all=True).calibration.view_rms
    found = calibrate_detected(seen, model)
    assert reasons(found) == {"photograph 6": Misfit(kept[6], np.median(kept))}
    assert found.photographs.looked_at[6].found is badly_found.corners
    assert found.calibration.view_rms.max() < 0.1 < 0.5 < kept[6]
    assert "does not fit the others: 2." in str(reasons(found)["photograph 6"])


def test_arrays_photographs_and_a_side_alone_do_as_well(photos):
    given = [Photo(f"{i}.png", photo) for i, photo in enumerate(photos[:3])]
    found = calibrate_photographs([*given, photos[3]], 25.0, lens="k1")
    assert found.photographs.counted
    assert found.photographs.board.corners == (9, 6)
    assert found.photographs.named()[0] == ["0.png", "1.png", "2.png", "photograph 3"]
    assert "not used" not in repr(found)


@pytest.mark.parametrize(
    "bad", [[], 5, None, [1.0, 2.0], np.zeros((0, 0)), np.full((40, 40), np.nan)]
)
def test_what_is_no_picture_is_refused_by_its_number(photos, bad):
    with pytest.raises((CvnotesError, InputTypeError), match="photograph 1"):
        calibrate_photographs([photos[0], bad], BOARD)


def test_what_cannot_be_says_what_was_seen(photos, tmp_path):
    wall = np.full_like(photos[0], 128)
    with pytest.raises(NoCamera, match="1 usable photograph; need at least 2 views") as error:
        calibrate_photographs([photos[0], wall], BOARD)
    assert len(error.value.photographs.used) == 1
    assert isinstance(error.value.photographs.rejected[0].reason, NoBoard)
    with pytest.raises(DegenerateError, match="no chessboard"):
        calibrate_photographs([wall], 25.0)
    with pytest.raises(FileError, match="no photographs in"):
        calibrate_photographs(tmp_path, BOARD)
    (tmp_path / "cut.jpg").write_bytes(b"\xff\xd8\xff\xe0")
    for board, said in (BOARD, "^0 usable .*; none of them could be read"), (25.0, r"cut\.jpg: "):
        with pytest.raises(CvnotesError, match=said):
            calibrate_photographs(tmp_path / "cut.jpg", board)
    with pytest.raises(DegenerateError, match=r"none\.jpg: there is no such file"):
        calibrate_photographs(tmp_path / "none.jpg", 25.0)
    with pytest.raises(FileError, match=r"leave out b\.png: none"):
        calibrate_photographs(photos[:2], BOARD, leave_out=["b.png"])


def detections(camera, poses, *, mirrored=(), astray=None, seed=0):
    """Photographs in which a known camera shows the board, with noise of 0.05 px."""
    rng, found = np.random.default_rng(seed), []
    for i, G in enumerate(poses):
        m = camera.moved(G).project(BOARD.points) + rng.normal(0, 0.05, (len(BOARD.points), 2))
        if i in mirrored:  # with its rows numbered from the other end, they stay right-handed
            m = m.reshape(6, 9, 2)[::-1].reshape(-1, 2) * [-1, 1] + [camera.size[0] - 1, 0]
        if astray and i == astray[0]:
            m[astray[1]] += astray[2]
        blank = np.zeros((48, 64), np.uint8)
        found.append(Detection(Path(f"{i:02}.png"), camera.size, blank, m))
    return Photographs(BOARD, found)


def fitted(seen):
    return calibrate_detected(seen, Model("k1 k2", "flat"))


@pytest.mark.parametrize("which", [(3,), (1, 2, 5, 8)])
def test_mirrored_photographs_are_named_and_no_others(which):
    camera, poses = course.camera().with_parameters({"u0": 350.0}), course.poses()
    found = fitted(detections(camera, poses, mirrored=which))
    assert reasons(found) == {f"{i:02}.png": Exchanged() for i in which}


@pytest.mark.parametrize("which", [(1, 2, 5, 8, 9), (0, 3, 4, 6, 7)])
def test_where_half_is_mirrored_both_parts_are_told_and_no_camera_is_good(which):
    camera, poses = course.camera().with_parameters({"u0": 350.0}), course.poses()[:10]
    found = fitted(detections(camera, poses, mirrored=which))
    assert reasons(found) == {}
    assert not found.reliable
    named = re.match(r"([\d.png, ]+): left and right seem exchanged there, or in all the others; ",
                     found.doubts[0])  # fmt: skip
    others = set(range(10)) - set(which)
    assert {int(n[:2]) for n in named[1].split(", ")} in (set(which), others)
    assert found.next_view is None


@pytest.mark.parametrize("which", [(1, 2, 5, 8), (1, 2, 5, 8, 9)])
def test_mirrored_photographs_of_a_camera_nearly_its_own_mirror_are_noticed_and_not_named(which):
    camera, poses = course.camera().with_parameters({"u0": 326.0}), course.poses()[:10]
    assert fitted(detections(camera, poses)).doubts == []
    found = fitted(detections(camera, poses, mirrored=which))
    assert reasons(found) == {}
    assert not found.reliable
    assert found.doubts[0].startswith("in some photographs left and right seem exchanged, but")


@pytest.mark.parametrize(("n_left", "n_right"), [(3, 10), (4, 9), (5, 8), (7, 6), (10, 3)])
def test_the_few_photographs_of_a_second_camera_are_named(n_left, n_right):
    real, blank = course.real_corners(), np.zeros((48, 64), np.uint8)
    m = [*real.left[:n_left], *real.right[len(real.right) - n_right :]]
    seen = [Detection(Path(f"{i:02}.png"), real.size, blank, m) for i, m in enumerate(m)]
    found = calibrate_detected(Photographs(real.board, seen))
    assert not found.reliable
    names = [", ".join(f"{i:02}.png" for i in part)
             for part in (range(n_left), range(n_left, n_left + n_right))]  # fmt: skip
    more, fewer = sorted(names, key=len, reverse=True)
    assert found.doubts[0].startswith(f"{more} fit one camera, and {fewer} another (0.0")
    assert "do they come from two cameras" in found.doubts[0]


def test_four_photographs_of_each_of_two_cameras_are_noticed():
    real, blank = course.real_corners(), np.zeros((48, 64), np.uint8)
    m = [*real.left[:4], *real.right[-4:]]
    seen = [Detection(Path(f"{i:02}.png"), real.size, blank, m) for i, m in enumerate(m)]
    found = calibrate_detected(Photographs(real.board, seen))
    assert not found.reliable
    assert "do they come from several cameras" in found.doubts[0]


@pytest.mark.parametrize("spread", [{"u0": 30.0, "v0": 30.0}, {"alpha_u": 12.0, "alpha_v": 12.0}])
def test_a_camera_that_is_another_each_time_is_not_called_two(spread):
    # as with an image stabiliser, or with a lens that focuses before each photograph
    rng, camera, seen = np.random.default_rng(3), course.camera(), []
    for i, G in enumerate(course.poses()):
        off = {name: camera.parameters[name] + rng.normal(0, s) for name, s in spread.items()}
        (photo,) = detections(camera.with_parameters(off), [G], seed=i).looked_at
        seen.append(replace(photo, path=Path(f"{i:02}.png")))
    found = calibrate_detected(Photographs(BOARD, seen))
    assert not found.reliable
    assert found.doubts[0].startswith("the camera was not the same in all photographs (")
    assert "stabiliser" in found.doubts[0]


def test_the_second_of_two_cameras_may_be_nearly_the_first_and_have_three_photographs():
    real, blank = course.real_corners(), np.zeros((48, 64), np.uint8)
    seen = [Detection(Path(f"{i:02}.png"), real.size, blank, m) for i, m in enumerate(real.left)]
    assert calibrate_detected(Photographs(real.board, seen)).reliable
    middle = (np.array(real.size) - 1) / 2
    zoomed = [replace(x, corners=middle + (x.corners - middle) / 1.1) for x in seen[3:6]]
    found = calibrate_detected(Photographs(real.board, [*seen[:3], *zoomed, *seen[6:]]))
    assert not found.reliable
    assert "and 03.png, 04.png, 05.png another (" in found.doubts[0]


@pytest.mark.parametrize("lens", ["k1", "none"])
def test_a_lens_that_is_too_simple_makes_no_second_camera(lens):
    bent = course.camera().with_parameters({"k1": -0.4, "k2": 0.5})
    found = calibrate_detected(detections(bent, course.poses()), Model(lens, "flat"))
    assert not any("two cameras" in doubt for doubt in found.doubts)


def test_a_steep_photograph_is_not_called_mirrored():
    camera, poses = course.camera(), course.poses()[:8]
    steep = pose(rotation_from_vector([0.1, 1.25, 0.05]), [-40.0, -62.0, 420.0])
    for seed in range(2):
        found = fitted(detections(camera, [*poses, steep], seed=seed))
        assert reasons(found) == {}
        assert found.reliable


@pytest.mark.parametrize(
    ("u0", "noise", "named"), [(331.0, 0.02, False), (332.0, 0.02, True), (334.0, 0.04, False)]
)
def test_a_photograph_that_misses_no_more_than_others_is_not_called_mirrored(u0, noise, named):
    # its RMS is 1.08, 1.13, .96 of the median; in a mirror each would fit better by a third
    rng = np.random.default_rng(0)
    camera, poses = course.camera().with_parameters({"u0": u0}), course.poses()
    seen = detections(camera, poses, mirrored=(3,))
    noises = [noise * (i != 3) * rng.normal(size=(54, 2)) for i in range(len(poses))]
    looked_at = [replace(x, corners=x.corners + n)
                 for x, n in zip(seen.looked_at, noises, strict=True)]  # fmt: skip
    found = fitted(replace(seen, looked_at=looked_at))
    assert reasons(found) == ({"03.png": Exchanged()} if named else {})


def test_a_lens_that_is_too_simple_accuses_no_honest_photograph():
    real, blank = course.real_corners(), np.zeros((48, 64), np.uint8)
    found = [Detection(Path(f"{i:02}.png"), real.size, blank, m) for i, m in enumerate(real.left)]
    without = calibrate_detected(Photographs(real.board, found), Model("none"))
    # in a mirror number 6 would fit better by a third: that lens bends nothing
    assert Exchanged() not in reasons(without).values()
    assert not any(Exchanged.words in doubt for doubt in without.doubts)


def test_photographs_of_two_cameras_are_told_apart_and_named():
    camera, poses = course.camera(), course.poses()
    other = camera.with_parameters({"alpha_u": 880.0, "alpha_v": 884.0, "k1": -0.2})
    first, second = (detections(c, poses, seed=i) for i, c in enumerate([camera, other]))
    both = [x for pair in zip(first.looked_at[:5], second.looked_at[5:10], strict=True)
            for x in pair]  # fmt: skip
    found = fitted(Photographs(BOARD, both))
    assert not found.reliable
    assert found.doubts[0].startswith(
        "00.png, 01.png, 02.png, 03.png, 04.png fit one camera, and 05.png, 06.png, 07.png, "
        "08.png, 09.png another (0.0"
    )
    assert fitted(first).reliable


def test_a_single_wrong_corner_is_left_out_and_said():
    camera, poses = course.camera(), course.poses()
    found = fitted(detections(camera, poses, astray=(4, 20, [3.0, 2.5])))
    (photo,) = [x for x in found.photographs.used if x.astray]
    assert photo.path.name == "04.png"
    assert np.flatnonzero(~photo.seen).tolist() == [20]
    assert photo.astray[0] == pytest.approx(3.9, abs=0.4)
    assert note_of(photo).startswith("1 of 54 corners left out: 3.")
    assert found.doubts == []


def test_what_one_photograph_of_many_shows_is_not_advised():
    blank, part = np.zeros((48, 64), np.uint8), NoBoard(CornersNotFound("not", count=(6, 6)))
    none = NoBoard(CornersNotFound("not"))
    seen = [Detection(Path(f"{i}.png"), (640, 480), blank, None, reason=part if i < 2 else none)
            for i in range(12)]  # fmt: skip
    with pytest.raises(NoCamera, match="2 photographs show one of 6×6"):
        fitted(Photographs(BOARD, seen))
    with pytest.raises(NoCamera, match="was found in none"):
        fitted(Photographs(BOARD, seen[1:]))
    with pytest.raises(NoCamera, match="1 photograph shows one of 6×6"):
        fitted(Photographs(BOARD, seen[:1]))


def test_what_most_photographs_show_decides_whether_a_part_of_a_board_was_asked_for():
    seen = detections(course.camera(), course.poses()[:5])
    larger = NoBoard(CornersNotFound("not", count=(9, 8)))
    others = [
        Detection(Path(f"larger {i}.png"), seen.size, x.thumbnail, None, reason=larger)
        for i, x in enumerate([*seen.looked_at, seen.looked_at[0]])
    ]
    assert fitted(replace(seen, looked_at=[*seen.looked_at, *others[:2]])).reliable
    with pytest.raises(NoCamera, match="but 6 photographs show one of 9×8") as error:
        fitted(replace(seen, looked_at=[*seen.looked_at, *others]))
    assert error.value.photographs.instead == (9, 8)
