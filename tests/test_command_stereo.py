"""`cvnotes stereo`: pairs of photographs in, two cameras on one rig out."""

import json
import warnings
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from cvnotes.base import CalibrationWarning, DegenerateError
from cvnotes.camera import Camera, Lens, chain, intrinsics, pose, rotation_from_vector
from cvnotes.commands.cli import main
from cvnotes.commands.stereo import differences
from cvnotes.files import read_rig
from cvnotes.files.ownership import made_by, maker
from cvnotes.files.reasons import Rejected, Unreadable
from cvnotes.photographs import Detection, Photographs, calibrate_pairs
from cvnotes.photographs.pairs import paired
from cvnotes.pictures import render
from cvnotes.stereo import calibrate_stereo, rectify
from cvnotes.stereo.half_turn import half_turns
from cvnotes.stereo.jackknife import std_of_pairs
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


def _examined(corners, name):
    return Detection(Path(name), SIZE, np.zeros((4, 4), np.uint8), corners)


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


@pytest.mark.slow
def test_rendered_pairs_become_the_rig_within_its_error_bars(photographs, tmp_path, capsys):
    own = ["rectified-left.png", "rectified-right.png", "rectified.png", "rig.json"]
    for name in own:  # of a run before, which may be replaced
        (tmp_path / name).write_bytes(made_by("stereo").encode())
    assert _stereo(photographs, tmp_path) == 0
    said = capsys.readouterr().out
    assert "7 pairs, by the number in their names" in said
    assert "left 8.png: no right photograph belongs to it" in said
    rig = json.loads((tmp_path / "rig.json").read_text())
    std = rig["standard_deviations"]
    T = np.array(rig["right_from_left"]["T"])
    bars = np.array([std[f"T_{axis}"] for axis in "xyz"])
    assert (np.abs(T - RIGHT.T) < 4 * bars).all()
    assert (bars < [0.5, 0.5, 3.0]).all()
    assert abs(rig["baseline"] - np.linalg.norm(RIGHT.T)) < 4 * std["baseline"]
    assert rig["rms_of_rows"] < 0.1
    assert [pair["left"] for pair in rig["pairs"]] == [f"left {i}.png" for i in range(1, 8)]
    left, right = read_rig(tmp_path / "rig.json")
    np.testing.assert_allclose(right.T, T, atol=0)
    np.testing.assert_array_equal(left.G, np.eye(4))
    for name in ("rectified.png", "rectified-left.png", "rectified-right.png"):
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
    assert str(found.rejected[-1].reason) == "the board was not found in its partner b1.png"


def test_corners_of_a_symmetric_board_are_counted_from_one_end():
    board = Chessboard((8, 6), 20.0, half_turn_symmetric=True)
    left, right = _seen(board)
    turned = np.array([False, True, True, False, True, False, True, True])
    right = [m[::-1] if flip else m for m, flip in zip(right, turned, strict=True)]
    right[2][4] = np.nan  # a corner under a coin
    pairs = [
        (_examined(a, f"a{i}.png"), _examined(b, f"b{i}.png"))
        for i, (a, b) in enumerate(zip(left, right, strict=True))
    ]
    rig = calibrate_pairs(pairs, board, "k1 k2")
    assert rig.result.rms < 0.17  # 0.1 px in u and in v; 100 px and more when counted wrongly
    assert (np.abs(rig.result.T - RIGHT.T) < 4 * np.array([rig.std[f"T_{a}"] for a in "xyz"])).all()


def test_the_lens_is_chosen_by_left_photographs_that_were_left_out():
    def pairs(n):
        sides = list(zip(*_seen(BOARD), strict=True))[:n]
        return [tuple(_examined(m, f"{i}.png") for m in both) for i, both in enumerate(sides)]

    rig = calibrate_pairs(pairs(8), BOARD, "auto").result
    assert rig.names == calibrate_pairs(pairs(8), BOARD, "k1 k2").result.names
    few = calibrate_pairs(pairs(3), BOARD, "auto").result  # of which none is left out
    assert few.names == rig.names


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
        std = std_of_pairs(rig, BOARD.points, *sides, lens="k1 k2")
        bars.append([std[f"T_{axis}"] for axis in "xyz"])
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
    small = tmp_path / "small"
    small.mkdir()
    for i in (1, 2, 3):
        with Image.open(photographs / "right" / f"right {i}.png") as picture:
            enlarged = picture.resize((640, 480), Image.Resampling.LANCZOS)
        enlarged.save(small / f"r{i}.png")
    assert main(["stereo", str(photographs / "left"), str(small), "--corners", "9x6",
                 "--square", "20", "--out", str(tmp_path / "rig")]) == 1  # fmt: skip
    assert "left and right pictures must have one size" in capsys.readouterr().err
    assert not (tmp_path / "rig").exists()
