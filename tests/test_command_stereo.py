"""`cvnotes stereo`: pairs of photographs in, two cameras on one rig out."""

import html
import json
import re
import warnings
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from cvnotes.base import CalibrationWarning, DegenerateError
from cvnotes.camera import Camera, Lens, chain, intrinsics, pose, rotation_from_vector
from cvnotes.commands.cli import main
from cvnotes.commands.stereo import differences
from cvnotes.files import lens_from_opencv, read_camera_info, read_rig
from cvnotes.files.ownership import made_by, maker
from cvnotes.files.reasons import Rejected, Unreadable
from cvnotes.photographs import Detection, Model, Photographs, calibrate_pairs
from cvnotes.photographs.pairs import paired
from cvnotes.pictures import render
from cvnotes.stereo import calibrate_stereo, rectify
from cvnotes.stereo.half_turn import half_turns
from cvnotes.targets import Chessboard

SIZE = (480, 360)
BOARD = Chessboard((9, 6), 20.0)
LEFT = Camera(intrinsics(560, 562, 242, 178), lens=Lens(k=(-0.2, 0.05)), size=SIZE)
RIGHT = Camera(
    intrinsics(566, 567, 236, 182),
    pose(rotation_from_vector([0.01, -0.08, 0.02]), [-60, 1.5, 2.0]),
    Lens(k=(-0.22, 0.06)),
    SIZE,
)
TILTS = [(0.5, 0.1, 0.05), (-0.5, 0.1, -0.1), (0.1, 0.55, 0.1), (0, -0.55, 0), (0.4, 0.4, 0.2)]
TILTS += [(-0.4, -0.3, -0.2), (0.45, -0.35, 0.1), (-0.2, 0.5, 0.0)]


def _poses(board, middle=(30.0, 0.0, 520.0)):
    centre = board.points.mean(axis=0)
    rotations = [rotation_from_vector(tilt) for tilt in TILTS]
    return [pose(R, np.array(middle) - R @ centre) for R in rotations]


def _seen(board, sigma=0.1, seed=0):
    rng = np.random.default_rng(seed)
    return [
        [
            c.moved(chain(c.G, G)).project(board.points)
            + rng.normal(0, sigma, (len(board.points), 2))
            for G in _poses(board)
        ]
        for c in (LEFT, RIGHT)
    ]


def _examined(corners, name, size=SIZE):
    return Detection(Path(name), size, np.zeros((4, 4), np.uint8), corners)


def _photographed(board, corners, side, size=SIZE):
    photos = [_examined(m, f"{side} {i + 1}.png", size) for i, m in enumerate(corners)]
    return Photographs(board, photos)


@pytest.fixture(scope="module")
def photographs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pairs")
    rng = np.random.default_rng(0)
    for side, camera in (("left", LEFT), ("right", RIGHT)):
        (folder / side).mkdir()
        for i, G in enumerate(_poses(BOARD)):
            image = render(BOARD, camera.moved(chain(camera.G, G)), blur=0.7, noise=2.0, rng=rng)
            Image.fromarray(image).save(folder / side / f"{side} {i + 1}.png")
    (folder / "right" / "right 8.png").unlink()  # one partner is missing
    return folder


def _stereo(folder, out, *more):
    sides = [str(folder / "left"), str(folder / "right")]
    return main(
        ["stereo", *sides, "--corners", "9x6", "--square", "20", "--lens", "k1 k2",
         "--out", str(out), *more]
    )  # fmt: skip


def test_of_two_clips_frames_are_taken_that_belong_together(photographs, tmp_path, capsys):
    rng = np.random.default_rng(1)
    for side in ("left", "right"):
        video = cv2.VideoWriter(
            str(tmp_path / f"{side}.avi"), cv2.VideoWriter.fourcc(*"MJPG"), 10.0, SIZE, False
        )
        video.set(cv2.VIDEOWRITER_PROP_QUALITY, 98)
        still = [np.asarray(Image.open(photographs / side / f"{side} {i}.png")).astype(float)
                 for i in range(1, 8)]  # fmt: skip
        for here, there in zip(still, [*still[1:], still[0]], strict=True):
            for part in (0, 0, 0, 0, 0, 0.3, 0.7):  # held, then on its way to the next place
                shown = (1 - part) * here + part * there + rng.normal(0, 1, here.shape)
                video.write(shown.clip(0, 255).astype(np.uint8))
        video.release()
    clips = [str(tmp_path / f"{side}.avi") for side in ("left", "right")]
    options = ["--corners", "9x6", "--square", "20", "--lens", "k1 k2", "--board-shape", "flat"]
    out = tmp_path / "rig"
    assert main(["stereo", *clips, *options, "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert "7 that are sharp, still and different; and the same of right.avi" in said
    assert "do both begin at the same moment" not in said
    assert "7 pairs, by the number in their names" in said
    assert np.linalg.norm(read_rig(out / "rig.json")[1].T - RIGHT.T) < 1
    assert np.asarray(Image.open(out / "rectified-left.png")).std() > 20
    taken = re.findall(r"^left frame \d+", said, re.M)
    leave = ["--leave-out", taken[2]]
    assert main(["stereo", *clips, *options, *leave, "--out", str(tmp_path / "fewer")]) == 0
    assert f"{taken[2]}: left out, as asked" in capsys.readouterr().out


@pytest.mark.slow
def test_rendered_pairs_become_the_rig_within_its_error_bars(photographs, tmp_path, capsys):
    own = ["calibration.yml", "left.yaml", "rectified-left.png", "rectified-right.png",
           "report.html", "rig.json", "right.yaml"]  # fmt: skip
    for name in own:  # of a run before, which may be replaced
        (tmp_path / name).write_bytes(made_by("stereo").encode())
    assert _stereo(photographs, tmp_path, "--leave-out", "left 7.png") == 0
    said = capsys.readouterr().out
    assert "6 pairs, by the number in their names" in said
    assert "left 7.png: left out, as asked" in said
    assert "left 8.png: no right photograph belongs to it" in said
    rig = json.loads((tmp_path / "rig.json").read_text())
    std = rig["standard_deviations"]
    T = np.array(rig["right_from_left"]["T"])
    bars = np.array([std[f"T_{axis}"] for axis in "xyz"])
    assert (np.abs(T - RIGHT.T) < 4 * bars).all()
    assert (bars < [0.5, 0.5, 3.0]).all()
    assert abs(rig["baseline"] - np.linalg.norm(RIGHT.T)) < 4 * std["baseline"]
    assert rig["rms_of_rows"] < 0.1
    assert [pair["left"] for pair in rig["pairs"]] == [f"left {i}.png" for i in range(1, 7)]
    left, right = read_rig(tmp_path / "rig.json")
    np.testing.assert_allclose(right.T, T, atol=0)
    np.testing.assert_array_equal(left.G, np.eye(4))
    stored = cv2.FileStorage(str(tmp_path / "calibration.yml"), cv2.FILE_STORAGE_READ)
    theirs = {name: stored.getNode(name).mat() for name in ("M2", "D2", "R2", "P1", "P2", "Q")}
    info = read_camera_info(tmp_path / "right.yaml")
    np.testing.assert_array_equal(theirs["M2"], info.camera.A)
    np.testing.assert_array_equal(theirs["R2"], info.rectification)
    assert lens_from_opencv(theirs["D2"]) == info.camera.lens == right.lens
    (u1, v1, w1), (u2, v2, w2) = (theirs[P] @ [40, -30, 600, 1] for P in ("P1", "P2"))
    assert v1 / w1 == pytest.approx(v2 / w2, abs=1e-9)
    X = theirs["Q"] @ [u1 / w1, v1 / w1, u1 / w1 - u2 / w2, 1]
    np.testing.assert_allclose(X[:3] / X[3], [40, -30, 600], rtol=1e-9)
    metres = theirs["P2"] / [1, 1, 1, 1000]
    np.testing.assert_allclose(info.projection, metres, rtol=1e-12, atol=0)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    for word in re.split(r"\n|  +", said.partition("Written to")[0]):
        assert html.escape(word.removeprefix("! ")) in page
    # a pair before and after, how well each picture is known, and every photograph
    assert page.count("<image") == 4 + 2 + 7 + 7
    for name in ("rectified-left.png", "rectified-right.png"):
        with Image.open(tmp_path / name) as picture:
            assert "cvnotes stereo" in picture.text["Comment"]
    assert sorted(path.name for path in tmp_path.iterdir()) == own
    assert {maker(path) for path in tmp_path.iterdir()} == {"stereo"}  # so they may be, in turn


def test_files_of_others_are_not_replaced(photographs, tmp_path, capsys):
    (tmp_path / "rig.json").write_text("{}")
    assert _stereo(photographs, tmp_path) == 1
    assert "was not made by cvnotes stereo" in capsys.readouterr().err
    assert (tmp_path / "rig.json").read_text() == "{}"


def test_partners_are_told_by_their_numbers_or_by_their_order_and_never_guessed():
    corners = BOARD.points[:, :2]

    def side(*names, missing=0):
        photos = [_examined(corners, name) for name in names]
        lost = [Rejected(f"lost {i}.png", Unreadable("cut off")) for i in range(missing)]
        return Photographs(BOARD, photos, lost)

    found = paired(side("a1.png", "a3.png", "a2.png"), side("b2.png", "b3.png"))
    assert [(a.path.name, b.path.name) for a, b in found.pairs] == [
        ("a3.png", "b3.png"),
        ("a2.png", "b2.png"),
    ]
    assert found.by_number
    assert [r.file for r in found.rejected] == ["a1.png"]
    found = paired(side("x.png", "y.png"), side("p.png", "q.png"))
    assert [(a.path.name, b.path.name) for a, b in found.pairs] == [
        ("x.png", "p.png"),
        ("y.png", "q.png"),
    ]
    assert not found.by_number
    with pytest.raises(DegenerateError, match="2 left photographs but 1 right"):
        paired(side("x.png", "y.png"), side("p.png"))
    with pytest.raises(DegenerateError, match="same number"):  # which of them is missing?
        paired(side("x.png", "y.png", missing=1), side("p.png", "q.png", missing=1))
    found = paired(side("a1.png"), Photographs(BOARD, [_examined(None, "b1.png")]))
    assert not found.pairs
    assert str(found.rejected[-1].reason) == "its partner b1.png is not used"
    right = corners.copy()
    right[:50] = np.nan
    found = paired(side("a1.png"), Photographs(BOARD, [_examined(right, "b1.png")]))
    assert str(found.rejected[0].reason) == "only 4 corners are also seen in its partner b1.png"


def test_corners_of_a_symmetric_board_are_counted_from_one_end():
    board = Chessboard((8, 6), 20.0, half_turn_symmetric=True)
    left, right = _seen(board)
    turned = np.array([False, True, True, False, True, False, True, True])
    right = [m[::-1] if flip else m for m, flip in zip(right, turned, strict=True)]
    right[2][4] = np.nan  # a corner under a coin
    sides = [_photographed(board, m, side) for m, side in ((left, "a"), (right, "b"))]
    rig = calibrate_pairs(*sides, Model("k1 k2", "flat")).result
    assert rig.rms < 0.17  # 0.1 px in u and in v; 100 px and more when counted wrongly
    assert (np.abs(rig.T - RIGHT.T) < 4 * np.array([rig.honest_std[f"T_{a}"] for a in "xyz"])).all()


def test_each_camera_is_calibrated_as_by_itself_and_what_fits_neither_is_left_out():
    left, right = _seen(BOARD)
    right = [2 * m + 0.5 for m in right]  # a camera of twice the resolution
    left[2][:, 0] += 10 * np.sin(left[2][:, 1] / 5)
    right[5] = right[5] + [8, 5]  # the board was moved between both photographs
    sides = _photographed(BOARD, left, "left"), _photographed(BOARD, right, "right", (960, 720))
    rig = calibrate_pairs(*sides, Model("auto", "flat"))
    assert [a.path.name for a, _ in rig.found.pairs] == [
        f"left {i}.png" for i in (1, 2, 4, 5, 7, 8)
    ]
    why = {r.file: str(r.reason) for r in rig.found.rejected}
    assert "does not fit the others" in why["left 3.png"]
    assert why["right 3.png"] == "its partner left 3.png is not used"
    assert "does not fit the others" in why["left 6.png"]
    assert rig.result.names == tuple(
        [f"{side}.{name}" for side in ("left", "right")
         for name in ("alpha_u", "alpha_v", "u0", "v0", "k1", "k2")]
        + [f"{way}_{axis}" for way in ("omega", "T") for axis in "xyz"]
    )  # fmt: skip
    assert rig.reliable
    kept = calibrate_pairs(*sides, Model("k1 k2", "flat"), keep_all=True)
    assert len(kept.found.pairs) == 8
    assert "left camera: left 3.png do not fit the others" in " ".join(kept.doubts)
    sides = _photographed(BOARD, _seen(BOARD)[0], "left"), sides[1]  # each is good by itself
    kept = calibrate_pairs(*sides, Model("k1 k2", "flat"), keep_all=True)
    assert "were partners taken at the same moment" in " ".join(kept.doubts)


def test_half_turns_are_told_from_poses_alone():
    board = Chessboard((8, 6), 20.0, half_turn_symmetric=True)
    left = np.array(_poses(board))
    right = RIGHT.G @ left
    turn = pose(np.diag([-1.0, -1, 1]), [140, 100, 0])
    np.testing.assert_allclose((turn @ np.append(board.points[0], 1))[:3], board.points[-1])
    flips = np.array([True, False, False, True, False, False, True, False])
    right[flips] = right[flips] @ turn
    np.testing.assert_array_equal(half_turns(board.points, left, right), flips)


def test_rows_of_true_partners_agree_in_the_rectified_pictures():
    board_poses = _poses(BOARD)
    m = [c.moved(chain(c.G, board_poses[0])).project(BOARD.points) for c in (LEFT, RIGHT)]
    rig = calibrate_stereo(BOARD.points, *_seen(BOARD, sigma=0.0), SIZE)
    off = differences(rig, rectify(rig.left, rig.right), *m)
    assert np.abs(off).max() < 1e-6
    shifted = differences(rig, rectify(rig.left, rig.right), m[0] + [0, 1], m[1])
    assert (np.abs(shifted) > 0.9).all()


@pytest.mark.slow
def test_the_jackknife_agrees_with_how_much_repetitions_scatter():
    # Each pair is disturbed as a whole, which the bars of noise alone do not know.
    rng = np.random.default_rng(0)
    found, bars, noise_alone = [], [], []
    for _ in range(12):
        sides = [
            [m + (m - m.mean(0)) @ rng.normal(0, 1e-3, (2, 2)) for m in side]
            for side in _seen(BOARD, seed=int(rng.integers(1000)))
        ]
        with warnings.catch_warnings():  # the disturbance looks like a lens that is too small
            warnings.simplefilter("ignore", CalibrationWarning)
            rig = calibrate_stereo(BOARD.points, *sides, SIZE, lens="k1 k2")
        found.append(rig.T)
        bars.append([rig.honest_std[f"T_{axis}"] for axis in "xyz"])
        noise_alone.append([rig.std[f"T_{axis}"] for axis in "xyz"])
    scatter = np.std(found, axis=0, ddof=1)
    ratio = scatter / np.sqrt(np.mean(np.square(bars), axis=0))
    assert (ratio < 1.6).all()
    assert (ratio > 0.4).all()
    assert np.median(scatter / np.sqrt(np.mean(np.square(noise_alone), axis=0))) > 1.6


def test_what_cannot_be_is_said_in_a_line(photographs, tmp_path, capsys):
    assert main(["stereo", "nowhere", "neither", "--corners", "9x6", "--square", "20",
                 "--out", str(tmp_path)]) == 1  # fmt: skip
    assert capsys.readouterr().err.count("\n") == 1
    sides = [str(photographs / side) for side in ("left", "right")]
    assert main(["stereo", *sides, "--corners", "9x6", "--square", "20", "--out", str(tmp_path),
                 "--leave-out", "left 3.png", "neither.png"]) == 1  # fmt: skip
    assert "neither.png: none of the photographs has this name" in capsys.readouterr().err
