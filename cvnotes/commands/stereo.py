"""``cvnotes stereo``: from pairs of photographs of a chessboard to two cameras on one rig."""

import argparse
import io
import re
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CalibrationWarning, CvnotesError, DegenerateError, text_table
from cvnotes.commands.calibrate import lens
from cvnotes.commands.console import EXIT_CODES, complain, say
from cvnotes.commands.ownership import earlier, made_by, marked
from cvnotes.commands.target import corners, length
from cvnotes.files import Rejected, read_photo, write_whole
from cvnotes.files.writing import check_folder, printable
from cvnotes.targets import Chessboard

if TYPE_CHECKING:
    from cvnotes.commands.examined import Examined
    from cvnotes.stereo import RectifiedPair, StereoCalibration

_RESULTS = re.compile(r"rig\.json|rectified(-left|-right)?\.png")
Pair = tuple["Examined", "Examined"]
Mask = npt.NDArray[np.bool_]


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
    """Calibrate; gives the exit code: 0 done, 1 cannot, 2 no such board, 3 not reliable."""
    from cvnotes.commands.examined import examine

    columns, rows = args.corners
    symmetric = (columns - rows) % 2 == 0
    try:
        board = Chessboard(args.corners, args.square, half_turn_symmetric=symmetric)
    except CvnotesError as error:
        complain("stereo", str(error))
        return 2
    check_folder(args.out)
    before = earlier(args.out, _RESULTS.fullmatch, "stereo")
    left, lost_left = examine(_paths(args.left), board)
    right, lost_right = examine(_paths(args.right), board)
    lost = [*lost_left, *lost_right]
    pairs: list[Pair] = []
    rejected = lost
    try:
        pairs, how, alone = paired(
            (left, right), (_unread(left, lost_left), _unread(right, lost_right))
        )
        rejected = [*lost, *alone]
        rig = _calibrated(pairs, board, args.lens)
    except CvnotesError as error:
        say(_table(pairs, rejected))
        complain("stereo", f"{len(pairs)} usable pairs; {error}")
        return 1
    contents = _reported(rig, pairs, how, rejected)
    if symmetric:
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
    return 0


def _paths(text: str) -> list[str]:
    """Give the files of a pattern, or what was said as it stands."""
    pattern = Path(text)
    if pattern.exists() or not any(letter in pattern.name for letter in "*?["):
        return [text]
    return [str(path) for path in sorted(pattern.parent.glob(pattern.name))] or [text]


# --- which photographs belong together -----------------------------------------------------------


def paired(
    sides: "tuple[Sequence[Examined], Sequence[Examined]]", unread: tuple[int, int] = (0, 0)
) -> tuple[list[Pair], str, list[Rejected]]:
    """Pair photographs; gives the pairs that show the board twice, how, and what stays alone.

    The last number in a name tells when it was taken, unless one stands in two names of a side;
    without such numbers the order of the names does, where no file of either side is missing:
    `unread` are how many could not be used.
    """
    numbers: list[list[int | None]] = [[_number(photo.path) for photo in side] for side in sides]
    numbered = all(None not in own and len(set(own)) == len(own) for own in numbers)
    if numbered and set(numbers[0]) & set(numbers[1]):
        how = "by the number in their names"
    elif len(sides[0]) == len(sides[1]) and not any(unread):
        numbers = [list(range(len(side))) for side in sides]
        how = "in the order of their names"
    else:
        raise DegenerateError(
            f"{len(sides[0])} left photographs but {len(sides[1])} right ones, and no numbers in "
            "their names that would pair them: give partners the same number"
        )
    left, right = (
        dict(zip(own, side, strict=True)) for own, side in zip(numbers, sides, strict=True)
    )
    pairs, alone = [], []
    for own, others, side in ((left, right, "right"), (right, left, "left")):
        for key, photo in own.items():
            partner = others.get(key)
            if photo.corners is None:
                continue  # has its reason
            if partner is None:
                reason = f"no {side} photograph belongs to it"
            elif partner.corners is None:
                reason = f"the board was not found in its partner {printable(partner.path.name)}"
            else:
                if side == "right":
                    pairs.append((photo, partner))
                continue
            alone.append(Rejected(printable(photo.path), reason))
    return pairs, how, alone


def _unread(examined: "Sequence[Examined]", lost: Sequence[Rejected]) -> int:
    """Count the files that are not even pictures of this camera."""
    return len(lost) - sum(photo.corners is None for photo in examined)


def _number(path: Path) -> int | None:
    digits = re.findall(r"[0-9]+", path.stem)
    return int(digits[-1]) if digits else None


# --- the rig --------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Rig:
    """What came out: the rig, its error bars over pairs, and the corners that it rests on."""

    result: "StereoCalibration"
    std: dict[str, float]
    left: list[Array]
    right: list[Array]


def _calibrated(pairs: Sequence[Pair], board: Chessboard, lens: str) -> _Rig:
    from cvnotes.stereo import calibrate_stereo
    from cvnotes.stereo.jackknife import std_of_pairs

    if not pairs:
        raise DegenerateError(
            "a board of {}×{} inner corners was found in both pictures of none".format(
                *board.corners
            )
        )
    sizes = {photo.size for pair in pairs for photo in pair}
    if len(sizes) > 1:
        listed = " and ".join(f"{w}×{h}" for w, h in sorted(sizes))
        raise DegenerateError(
            f"left and right pictures must have one size, got {listed} pixels: take both at the "
            "same resolution"
        )
    left, right = (np.array([pair[i].corners for pair in pairs]) for i in (0, 1))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CalibrationWarning)  # the report has them
        if lens == "auto":
            lens = _chosen(board, left, pairs[0][0].size)
        if board.half_turn_symmetric:
            right = _same_end(board, left, right, pairs[0][0].size, lens)
        seen: Mask = np.asarray(np.isfinite(left + right).all(-1))
        points = [board.points[s] for s in seen]
        m_left, m_right = (
            [m[s] for m, s in zip(side, seen, strict=True)] for side in (left, right)
        )
        result = calibrate_stereo(points, m_left, m_right, pairs[0][0].size, lens=lens)
        try:
            std = std_of_pairs(result, points, m_left, m_right, lens=lens)
        except CvnotesError as error:
            raise DegenerateError(
                f"without some of the pairs the rig is not determined ({error}): take more pairs, "
                "or a lens with fewer coefficients"
            ) from error
    return _Rig(result, std, m_left, m_right)


def _chosen(board: Chessboard, left: Array, size: tuple[int, int]) -> str:
    """Choose the lens of both cameras, which are nearly always alike, by the left photographs."""
    from cvnotes.calibration import choose_lens, left_out_rms

    if len(left) < 4:
        raise DegenerateError(
            'to choose a lens takes at least 4 pairs: name one, such as --lens "k1 k2"'
        )
    seen: Mask = np.asarray(np.isfinite(left).all(-1))
    m = [view[s] for view, s in zip(left, seen, strict=True)]
    return choose_lens(left_out_rms([board.points[s] for s in seen], m, size))


def _same_end(
    board: Chessboard, left: Array, right: Array, size: tuple[int, int], lens: str
) -> Array:
    """Count the right corners of a symmetric board from the same end as the left ones."""
    from cvnotes.calibration import calibrate
    from cvnotes.stereo.half_turn import half_turns

    poses = []
    for side in (left, right):
        seen: Mask = np.asarray(np.isfinite(side).all(-1))
        m = [view[s] for view, s in zip(side, seen, strict=True)]
        poses.append(calibrate([board.points[s] for s in seen], m, size, lens=lens).poses)
    turned = half_turns(board.points, *poses)
    return np.where(turned[:, None, None], right[:, ::-1], right)


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


# --- words and files ------------------------------------------------------------------------------


def _reported(
    rig: _Rig, pairs: Sequence[Pair], how: str, rejected: Sequence[Rejected]
) -> dict[str, bytes]:
    """Say what came out; gives the files to write, by name."""
    from cvnotes.stereo import rectify
    from cvnotes.stereo.saving import rig_json

    result = rig.result
    say(f"{len(pairs)} pairs, {how}")
    say(_table(pairs, rejected, result) + "\n")
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
            drawn = _pictures(pair, pairs[int(np.argmin([abs(x).max() for x in off]))])
        except DegenerateError as error:
            doubts.append(f"not rectified: {error}")
    doubts += [str(w.message) for w in caught if issubclass(w.category, CalibrationWarning)]
    say(_report(rig, rows) + "\n")
    for sentence in doubts:
        say(f"! {sentence}")
    files = [(printable(a.path.name), printable(b.path.name)) for a, b in pairs]
    text = rig_json(
        result,
        files=files,
        std_of_pairs=rig.std,
        rows=rows,
        rejected=rejected,
        note=made_by("stereo"),
    )
    return {"rig.json": text.encode(), **drawn}


def _table(
    pairs: Sequence[Pair], rejected: Sequence[Rejected], rig: "StereoCalibration | None" = None
) -> str:
    """Return the table of pairs with their RMS, then what was not used with reasons."""
    rms = (
        [["", ""]] * len(pairs) if rig is None else [[f"{x:.3f}" for x in r] for r in rig.view_rms]
    )
    rows = [
        [printable(a.path.name), printable(b.path.name), *r]
        for (a, b), r in zip(pairs, rms, strict=True)
    ]
    table = text_table([["left", "right", "RMS left (px)", "RMS right (px)"], *rows])
    return "\n".join([table, *(f"! {printable(r.file)}: {r.reason}" for r in rejected)])


def _report(rig: _Rig, rows: float | None) -> str:
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


def _pictures(pair: "RectifiedPair", photos: Pair) -> dict[str, bytes]:
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
