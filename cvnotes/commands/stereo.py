"""``cvnotes stereo``: from pairs of photographs of a chessboard to two cameras on one rig."""

import argparse
import re
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CalibrationWarning, CvnotesError, DegenerateError, FileError
from cvnotes.base.writing import check_folder, printable
from cvnotes.calibration.thresholds import TIMES_NOISE
from cvnotes.commands.calibrate import add_options, asked_board, say_count
from cvnotes.commands.console import EXIT_CODES, complain, progress, say, shortfall
from cvnotes.files import Photo, list_photos, read_photo, write_whole
from cvnotes.files.decoding import VIDEOS
from cvnotes.files.ownership import earlier, made_by, marked
from cvnotes.files.reasons import unread
from cvnotes.files.video import frame_again, frames_in, frames_of_both
from cvnotes.stereo.calibration import SIDES

if TYPE_CHECKING:
    from cvnotes.commands.report import Block
    from cvnotes.photographs import Photographs
    from cvnotes.photographs.pairs import CalibratedPairs, Pair
    from cvnotes.stereo import RectifiedPair, StereoCalibration

_RESULTS = re.compile(
    r"rig\.json|calibration\.yml|(left|right)\.yaml|report\.html|rectified-(left|right)\.png"
)


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describe the command's arguments."""
    parser = subparsers.add_parser(
        "stereo",
        help="calibrate two cameras on one rig from pairs of photographs",
        description="Calibrate two cameras that stand firmly side by side, from pairs of "
        "photographs of a chessboard that were taken at the same moment. Left and right belong "
        "together when the last numbers in their names agree, or else in the order of names.",
        epilog="example: cvnotes stereo left/ right/ --corners 9x6 --square 25 --out rig/. "
        f"{EXIT_CODES}",
    )
    add = parser.add_argument
    add("left", metavar="LEFT", help='folder of the left photographs, or a pattern: '
        '"a/left*.jpg"; or a video, of which frames are taken')  # fmt: skip
    add("right", metavar="RIGHT", help="the same for the right ones; of a video the same frames")
    add_options(parser)


def run(args: argparse.Namespace) -> int:
    """Calibrate; gives the exit code: 0 done, 1 cannot, 2 no board, 3 doubtful, not all read."""
    from cvnotes.commands.report import photo_table
    from cvnotes.photographs import Model, calibrate_pairs, detect_photographs

    try:
        board = asked_board(args)
    except CvnotesError as error:
        complain("stereo", str(error))
        return 2
    check_folder(args.out)
    before = earlier(args.out, _RESULTS.fullmatch, "stereo")
    sides: list[Photographs] = []
    videos = _videos(args)
    for files, unwanted in _sides(args, videos):
        seen = detect_photographs(files, board, leave_out=unwanted, progress=progress)
        sides.append(seen)
        board = seen.board
    say_count(sides[0])
    (left, right), model = sides, Model(args.lens, args.board_shape, args.skew)
    try:
        rig = calibrate_pairs(left, right, model, keep_all=args.keep_all)
    except CvnotesError:
        for seen in sides:
            say(photo_table(seen))
        raise
    contents = _reported(rig, videos)
    write_whole({args.out / name: data for name, data in contents.items()})
    for stale in (path for path in before if path.name not in contents):
        stale.unlink(missing_ok=True)  # pictures of an earlier rig
    say(f"Written to {printable(args.out)}: {', '.join(contents)}")
    if not rig.reliable:
        complain("stereo", f"written, but not reliable: {rig.doubts[0]}")
        return 3
    missing = unread(rig.found.rejected, [args.left, args.right])
    return shortfall("stereo", missing, missing + 2 * len(rig.found.pairs), "could not be read")


def _videos(args: argparse.Namespace) -> list[Path]:
    """Return the video of either side, if both are videos."""
    paths = [Path(args.left), Path(args.right)]
    return paths if all(path.suffix.lower() in VIDEOS for path in paths) else []


def _sides(
    args: argparse.Namespace, videos: list[Path]
) -> list[tuple[list[str] | list[Photo], list[str]]]:
    """Return the files of either side, or the frames, and which of these not to use."""
    sides: list[list[str] | list[Photo]]
    if videos:
        both = frames_of_both(videos[0], videos[1], progress)
        sides, there = [*both], [[photo.path for photo in photos] for photos in both]
        n, m = map(frames_in, videos)
        left, right = (printable(path.name) for path in videos)
        say(f"Of {n} frames of {left} {len(both[0])} that are sharp, still and different; "
            f"and the same of {right}\n")  # fmt: skip
        if abs(n - m) > 1:
            say(f"! {right} has {m} frames: do both begin at the same moment?\n")
    else:
        files = [_paths(side) for side in (args.left, args.right)]
        sides, there = [*files], [list_photos(paths)[0] for paths in files]
    unwanted = [
        [name for name in args.leave_out if any(_is_called(path, name) for path in files)]
        for files in there
    ]
    for name in args.leave_out:
        if not any(name in names for names in unwanted):
            raise FileError(f"leave out {printable(name)}: none of the photographs has this name")
    return list(zip(sides, unwanted, strict=True))


def _is_called(path: Path, name: str) -> bool:
    return path.name == name or path.resolve() == Path(name).resolve()


def _paths(text: str) -> list[str]:
    """Return the files of a pattern, or what was said as it stands."""
    pattern = Path(text)
    if pattern.exists() or not any(letter in pattern.name for letter in "*?["):
        return [text]
    return [str(path) for path in sorted(pattern.parent.glob(pattern.name))] or [text]


# --- words and files ------------------------------------------------------------------------------


def differences(
    rig: "StereoCalibration", pair: "RectifiedPair", left: Array, right: Array
) -> Array:
    """Rows (n,) of left corners (n, 2) minus those of the right ones, in the rectified pictures.

    Of cameras that stand one above the other it is the columns.
    """
    m = []
    for camera, ideal, seen in ((rig.left, pair.left, left), (rig.right, pair.right, right)):
        xyz = camera.ray(seen) @ (ideal.A @ ideal.R).T
        m.append(np.where(xyz[:, 2:] > 0, xyz[:, :2] / xyz[:, 2:], np.nan))
    return np.asarray((m[0] - m[1])[:, 1 - pair.axis])


def _reported(rig: "CalibratedPairs", videos: list[Path]) -> dict[str, bytes]:
    """Describe what came out; gives the files to write, by name."""
    from cvnotes.commands.page import block_of, figures, page, photographs, verdict
    from cvnotes.commands.report import as_text
    from cvnotes.files.exchange import ros_yaml
    from cvnotes.stereo import rectify
    from cvnotes.stereo.saving import camera_infos, opencv_rig_yaml, rig_json

    result, found = rig.result, rig.found
    how = "by the number in" if found.by_number else "in the order of"
    table = _table(rig)
    lost = [f"! {printable(r.file)}: {r.reason}" for r in found.rejected]
    paired = f"{len(found.pairs)} pairs, {how} their names"
    say(as_text([paired, table, *lost]) + "\n")
    drawn: dict[str, bytes] = {}
    shown: list[str] = []
    rows: float | None = None
    pair: RectifiedPair | None = None
    doubts = rig.doubts
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", CalibrationWarning)
        try:
            pair = rectify(result.left, result.right)
            off = [differences(result, pair, a, b) for a, b in zip(*rig.corners, strict=True)]
            rows = float(np.sqrt(np.nanmean(np.concatenate(off) ** 2)))
            best = int(np.argmin([np.abs(x).max() for x in off]))
            drawn, shown = _pictures(pair, _greys(found.pairs[best], videos))
        except DegenerateError as error:
            doubts.append(f"not rectified: {error}")
    doubts += [str(w.message) for w in caught if issubclass(w.category, CalibrationWarning)]
    blocks = _report(rig, rows)
    say(as_text(blocks) + "\n")
    for sentence in doubts:
        say(f"! {sentence}")
    parts = [verdict("rig", rig.reliable, doubts), *map(block_of, blocks), *shown]
    parts += ["<h2>The pairs</h2>", block_of(paired), block_of(table), *map(block_of, lost)]
    for side, alone in zip(SIDES, rig.alone, strict=True):
        parts += [f"<h1>The {side} camera by itself</h1>", *figures(alone), *photographs(alone)]
    note, infos = made_by("stereo"), camera_infos(result, pair)
    text = rig_json(
        replace(result, warnings=tuple(rig.doubts), reliable=rig.reliable),
        files=[(printable(a.path.name), printable(b.path.name)) for a, b in found.pairs],
        rows=rows,
        rejected=found.rejected,
        note=note,
    )
    return {
        "rig.json": text.encode(),
        "calibration.yml": opencv_rig_yaml(result, pair, note=note).encode(),
        **{f"{info.name}.yaml": ros_yaml(info, note=note).encode() for info in infos},
        "report.html": page("Two cameras on one rig", parts, note).encode(),
        **drawn,
    }


def _table(rig: "CalibratedPairs") -> list[list[str]]:
    """Return the table of pairs with their RMS."""
    rows = [
        [printable(a.path.name), printable(b.path.name), *(f"{x:.3f}" for x in rms)]
        for (a, b), rms in zip(rig.found.pairs, rig.result.view_rms, strict=True)
    ]
    return [["left", "right", "RMS left (px)", "RMS right (px)"], *rows]


def _report(rig: "CalibratedPairs", rows: float | None) -> "list[Block]":
    """Return both cameras and the relative pose, with the error bars that pairs agree on."""
    from cvnotes.base.digits import with_deviation
    from cvnotes.camera import vector_from_rotation

    result, std = rig.result, rig.result.honest_std
    table = [["", "left", "± 1 σ", "right", "± 1 σ"]]
    for name, a, _, b, _ in result.table():
        cells = [
            ("", "") if np.isnan(x) else with_deviation(x, std.get(f"{side}.{name}", 0.0))
            for side, x in zip(SIDES, (a, b), strict=True)
        ]
        table.append([name, *(text for cell in cells for text in cell)])

    def three(values: Array, names: str, of: Callable[[float], float] = float) -> str:
        bars = [of(std[f"{names}_{axis}"]) for axis in "xyz"]
        return ", ".join(" ± ".join(with_deviation(*x)) for x in zip(values, bars, strict=True))

    base = " ± ".join(with_deviation(float(np.linalg.norm(result.T)), std["baseline"]))
    noise = max(std[f"T_{axis}"] / max(result.std[f"T_{axis}"], 1e-300) for axis in "xyz")
    turn = three(np.degrees(vector_from_rotation(result.R)), "omega", np.degrees)
    alone = (camera.calibration.rms for camera in rig.alone)
    facts = {
        "Rotation right ← left": f"{turn} degrees",
        "T right ← left": f"{three(result.T, 'T')} mm",
        "Base line": f"{base} mm",
        "RMS": f"{result.rms:.3f} px per point; each camera by itself "
        + ", ".join(f"{rms:.3f}" for rms in alone),
    }
    if rows is not None:
        facts["Rows"] = f"{rows:.3f} px RMS between partners, rectified"
    more = f"±: from leaving out pairs, of T {noise:.1f} times what noise alone would give"
    return [table, facts, *[more] * (noise > TIMES_NOISE)]


def _greys(photos: "Pair", videos: list[Path]) -> list[npt.NDArray[Any]]:
    """Read a pair again."""
    if videos:
        return [frame_again(video, photo.path) for video, photo in zip(videos, photos, strict=True)]
    return [read_photo(photo.path).grey for photo in photos]


def _pictures(pair: "RectifiedPair", before: list[Array]) -> tuple[dict[str, bytes], list[str]]:
    """Rectify a pair of photographs, and draw it before and after."""
    from cvnotes.commands.drawing import encoded
    from cvnotes.commands.page import figure
    from cvnotes.commands.pictures import partners
    from cvnotes.warping import backward_warp

    maps = (pair.left_map, pair.right_map)
    after = [backward_warp(image, m) for image, m in zip(before, maps, strict=True)]
    drawn = {
        f"rectified-{side}.png": marked(encoded(image), "stereo")
        for side, image in zip(SIDES, after, strict=True)
    }
    shown = [
        figure(partners(each, words, pair.axis), words)
        for each, words in (
            (before, "As they were taken: left and right."),
            (after, "Rectified: partners lie on the same line."),
        )
    ]
    return drawn, ["<h2>A pair, before and after</h2>", *shown]
