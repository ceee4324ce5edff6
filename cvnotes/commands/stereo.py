"""``cvnotes stereo``: from pairs of photographs of a chessboard to two cameras on one rig."""

import argparse
import io
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from cvnotes.base import Array, CalibrationWarning, CvnotesError, DegenerateError, text_table
from cvnotes.base.writing import check_folder, printable
from cvnotes.commands.calibrate import lens
from cvnotes.commands.console import EXIT_CODES, complain, progress, say, shortfall
from cvnotes.commands.target import corners, length
from cvnotes.files import read_photo, write_whole
from cvnotes.files.ownership import earlier, made_by, marked
from cvnotes.files.reasons import unread

if TYPE_CHECKING:
    from cvnotes.photographs.pairs import CalibratedPairs, Pair, Pairs
    from cvnotes.stereo import RectifiedPair, StereoCalibration

_RESULTS = re.compile(r"rig\.json|rectified(-left|-right)?\.png")


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
    add("left", metavar="LEFT", help='folder of the left photographs, or a pattern: "a/left*.jpg"')
    add("right", metavar="RIGHT", help="the same for the right ones")
    add("--corners", type=corners, required=True, metavar="9x6",
        help="inner corners of the board along x and y: where four squares meet")  # fmt: skip
    add("--square", type=length, required=True, metavar="25", help="side of a square, in mm")
    add("--out", type=Path, required=True, metavar="FOLDER", help="folder for the results")
    add("--lens", type=lens, default="k1 k2 p1 p2", metavar='"k1 k2"',
        help='lens of both cameras: none, k1, "k1 k2", "k1 k2 p1 p2" (default), '
        '"k1 k2 p1 p2 k3", rational, fisheye, or auto: left photographs that are left out '
        "decide")  # fmt: skip
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Calibrate; gives the exit code: 0 done, 1 cannot, 2 no board, 3 doubtful, not all read."""
    from cvnotes.photographs.driver import chessboard, detect_photographs
    from cvnotes.photographs.pairs import Pairs, calibrate_pairs, paired

    try:
        board = chessboard(args.corners, args.square)
    except CvnotesError as error:
        complain("stereo", str(error))
        return 2
    check_folder(args.out)
    before = earlier(args.out, _RESULTS.fullmatch, "stereo")
    left, right = (
        detect_photographs(_paths(side), board, progress=progress)
        for side in (args.left, args.right)
    )
    found = Pairs([], False, [*left.rejected, *right.rejected])
    try:
        found = paired(left, right)
        rig = calibrate_pairs(found.pairs, board, args.lens)
    except CvnotesError as error:
        say(_table(found))
        complain("stereo", f"{len(found.pairs)} usable pairs; {error}")
        return 1
    contents = _reported(rig, found)
    if board.half_turn_symmetric:
        say(
            "! this board looks the same after half a turn: in each pair the right corners are "
            "counted from the end that makes one rig of all pairs"
        )
    write_whole({args.out / name: data for name, data in contents.items()})
    for stale in (path for path in before if path.name not in contents):
        stale.unlink(missing_ok=True)  # pictures of an earlier rig
    say(f"Written to {printable(args.out)}: {', '.join(contents)}")
    if not rig.result.reliable:
        complain("stereo", f"written, but not reliable: {rig.result.warnings[0]}")
        return 3
    missing = unread(found.rejected, [args.left, args.right])
    return shortfall("stereo", missing, missing + 2 * len(found.pairs), "could not be read")


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
        rays = np.insert(camera.ideal(seen), 2, 1.0, axis=-1)
        m_h = rays @ (ideal.A @ ideal.R @ camera.R.T).T
        m.append(m_h[:, :2] / m_h[:, 2:])
    return np.asarray((m[0] - m[1])[:, 1 - pair.axis])


def _reported(rig: "CalibratedPairs", found: "Pairs") -> dict[str, bytes]:
    """Describe what came out; gives the files to write, by name."""
    from cvnotes.stereo import rectify
    from cvnotes.stereo.saving import rig_json

    result = rig.result
    how = "by the number in" if found.by_number else "in the order of"
    say(f"{len(found.pairs)} pairs, {how} their names")
    say(_table(found, result) + "\n")
    drawn: dict[str, bytes] = {}
    rows: float | None = None
    doubts = list(result.warnings)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", CalibrationWarning)
        try:
            pair = rectify(result.left, result.right)
            off = [
                differences(result, pair, a, b) for a, b in zip(rig.left, rig.right, strict=True)
            ]
            rows = float(np.sqrt(np.mean(np.concatenate(off) ** 2)))
            drawn = _pictures(pair, found.pairs[int(np.argmin([abs(x).max() for x in off]))])
        except DegenerateError as error:
            doubts.append(f"not rectified: {error}")
    doubts += [str(w.message) for w in caught if issubclass(w.category, CalibrationWarning)]
    say(_report(rig, rows) + "\n")
    for sentence in doubts:
        say(f"! {sentence}")
    files = [(printable(a.path.name), printable(b.path.name)) for a, b in found.pairs]
    text = rig_json(
        result,
        files=files,
        std_of_pairs=rig.std,
        rows=rows,
        rejected=found.rejected,
        note=made_by("stereo"),
    )
    return {"rig.json": text.encode(), **drawn}


def _table(found: "Pairs", rig: "StereoCalibration | None" = None) -> str:
    """Return the table of pairs with their RMS, then what was not used with reasons."""
    rms = [["", ""]] * len(found.pairs)
    if rig is not None:
        rms = [[f"{x:.3f}" for x in r] for r in rig.view_rms]
    rows = [
        [printable(a.path.name), printable(b.path.name), *r]
        for (a, b), r in zip(found.pairs, rms, strict=True)
    ]
    table = text_table([["left", "right", "RMS left (px)", "RMS right (px)"], *rows])
    return "\n".join([table, *(f"! {printable(r.file)}: {r.reason}" for r in found.rejected)])


def _report(rig: "CalibratedPairs", rows: float | None) -> str:
    """Return both cameras and the relative pose, with the error bars that pairs agree on."""
    from cvnotes.base.digits import with_deviation
    from cvnotes.camera import vector_from_rotation

    result, std = rig.result, rig.std
    table = [["", "left", "± 1 σ", "right", "± 1 σ"]]
    for name, a, _, b, _ in result.table():
        bars = (std.get(f"{side}.{name}", 0.0) for side in ("left", "right"))
        both = zip((a, b), bars, strict=True)
        table.append([name, *(cell for pair in both for cell in with_deviation(*pair))])

    def three(values: Array, names: str, of: Callable[[float], float] = float) -> str:
        bars = [of(std[f"{names}_{axis}"]) for axis in "xyz"]
        return ", ".join(" ± ".join(with_deviation(*x)) for x in zip(values, bars, strict=True))

    base = " ± ".join(with_deviation(float(np.linalg.norm(result.T)), std["baseline"]))
    noise = max(std[f"T_{axis}"] / max(result.std[f"T_{axis}"], 1e-300) for axis in "xyz")
    turn = three(np.degrees(vector_from_rotation(result.R)), "omega", np.degrees)
    lines = [
        text_table(table),
        f"Rotation right ← left   {turn} degrees",
        f"T right ← left          {three(result.T, 'T')} mm",
        f"Base line               {base} mm",
        f"RMS                     {result.rms:.3f} px per point",
    ]
    if rows is not None:
        lines.append(f"Rows                    {rows:.3f} px RMS between partners, rectified")
    if noise > 1.5:
        lines.append(
            f"The error bars are by leaving pairs out; noise alone would make T {noise:.1f} times "
            "as sure: the pairs disagree by more (is the board flat, does the lens model fit?)"
        )
    return "\n".join(lines)


def _pictures(pair: "RectifiedPair", photos: "Pair") -> dict[str, bytes]:
    """Rectify a pair of photographs, and draw it before and after."""
    from PIL import Image

    from cvnotes.show import draw_rows
    from cvnotes.show.picture import encode, figure_of
    from cvnotes.warping import backward_warp

    before = [read_photo(photo.path).grey for photo in photos]
    maps = (pair.left_map, pair.right_map)
    after = [backward_warp(image, m) for image, m in zip(before, maps, strict=True)]
    drawn = {"rectified.png": encode(figure_of(draw_rows(before, after)), jpeg=False)[0]}
    for side, image in zip(("left", "right"), after, strict=True):
        encoded = io.BytesIO()
        Image.fromarray(image).save(encoded, "PNG")
        drawn[f"rectified-{side}.png"] = encoded.getvalue()
    return {name: marked(png, "stereo") for name, png in drawn.items()}
