"""``cvnotes calibrate``: from photographs of a chessboard to a camera with error bars."""

import argparse
import os
import re
import warnings
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from cvnotes.base import CalibrationWarning, CvnotesError, DegenerateError
from cvnotes.commands.console import EXIT_CODES, complain, say
from cvnotes.commands.ownership import earlier, made_by, marked
from cvnotes.commands.target import corners, length
from cvnotes.files import Rejected, write_whole
from cvnotes.files.writing import check_folder, printable
from cvnotes.targets import CharucoBoard, Chessboard

if TYPE_CHECKING:
    from cvnotes.calibration import Calibration, NextView
    from cvnotes.commands.examined import Examined

_RESULTS = re.compile(
    r"calibration\.(json|yml)|photographs\.csv|(coverage|next_view|residuals|view_rms|corners(-\d+)?)\.png"
)

_ROUNDS = 3  # in which photographs that do not fit are left out
_KEPT, _MOST = 4, 2 / 3  # how many must stay, and which part of all

_OF_FEW = "k1 k2 p1 p2"  # the lens of fewer views than can be left out


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describe the command's arguments."""
    parser = subparsers.add_parser(
        "calibrate",
        help="calibrate a camera from photographs of a chessboard",
        description="Calibrate a camera from photographs of a chessboard. Take ten or more, with "
        "the board tilted by 30 to 45 degrees in different directions and reaching into the "
        "corners of the picture, without touching focus or zoom.",
        epilog="example: cvnotes calibrate photos/ --corners 9x6 --square 25 --out result/. "
        f"{EXIT_CODES}",
    )
    add = parser.add_argument
    add("photos", nargs="+", metavar="PHOTO", help="photographs, or folders of photographs")
    add("--corners", type=corners_or_auto, required=True, metavar="9x6",
        help="inner corners of the board along x and y: where four squares meet; or auto to "
        "have them counted in the photographs")  # fmt: skip
    add("--square", type=length, required=True, metavar="25", help="side of a square, in mm")
    add(
        "--charuco",
        nargs="?",
        const="4x4_50",
        metavar="4x4_50",
        help="the board is a ChArUco board, its markers of this dictionary (default 4x4_50)",
    )
    add("--marker", type=length, metavar="18.75",
        help="side of its markers, in mm (default: three quarters of a square)")  # fmt: skip
    add("--out", type=Path, required=True, metavar="FOLDER", help="folder for the results")
    add("--lens", type=lens, default="auto", metavar='"k1 k2"',
        help='lens to estimate: auto (default: views left out decide), none, k1, "k1 k2", '
        '"k1 k2 p1 p2", "k1 k2 p1 p2 k3", rational, fisheye')  # fmt: skip
    add("--board-shape", choices=("flat", "bent", "free", "auto"), default="auto",
        help="the board as it was drawn, bent smoothly, or every corner where the photographs say; "
        "auto (default): views left out decide")  # fmt: skip
    add("--leave-out", nargs="+", default=[], metavar="PHOTO", action="extend",
        help="photographs not to use, by their names")  # fmt: skip
    add(
        "--keep-all",
        action="store_true",
        help="use photographs that do not fit the others too; they are left out otherwise",
    )
    add("--skew", action="store_true", help="estimate the skew of the pixels' axes too")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Calibrate; gives the exit code: 0 done, 1 cannot, 2 no such board, 3 not reliable."""
    from cvnotes.commands.examined import counted, examine
    from cvnotes.commands.mirrored import doubted, mirrored
    from cvnotes.commands.report import camera_report, doubts, named, photo_table

    if args.corners is None:
        if args.charuco:
            complain("calibrate", "--corners auto counts chessboards; say how many corners it has")
            return 2
        try:
            args.corners = counted(args.photos)
        except DegenerateError as error:
            complain("calibrate", str(error))
            return 1
        say("A board of {}×{} inner corners, as counted in the photographs\n".format(*args.corners))
    try:
        board = asked_board(args)
    except CvnotesError as error:
        complain("calibrate", str(error))
        return 2
    check_folder(args.out)
    before = earlier(args.out, _RESULTS.fullmatch, "calibrate")
    examined, rejected = examine(args.photos, board, leave_out=args.leave_out)
    used = [photo for photo in examined if photo.corners is not None]
    try:
        result = calibrated(used, board, args)
    except CvnotesError as error:
        files, rejected = _brief([printable(photo.path) for photo in used], rejected)
        say(photo_table(files, [photo.note for photo in used], rejected))
        complain("calibrate", f"{len(used)} usable photographs; {error}")
        return 1
    if not args.keep_all:
        result, used, misfits = without_misfits(result, used, board, args)
        examined = [misfits.get(photo.path, photo) for photo in examined]
        rejected += [Rejected(printable(path), photo.note) for path, photo in misfits.items()]
    result = doubted(result, mirrored(used, result, board))
    files, rejected = _brief([printable(photo.path) for photo in used], rejected)
    notes = [photo.note for photo in used]
    say(photo_table(files, notes, rejected, result) + "\n")
    say(camera_report(result) + "\n")
    for sentence in doubts(result, examined, files, rejected, board):
        say(f"! {sentence}")
    proposal = proposal_of(result, board)
    if proposal:
        say(f"Next photograph: {proposal}")
    contents = contents_of(result, examined, board, files, rejected, proposal)
    write_whole({args.out / name: data for name, data in contents.items()})
    for stale in (path for path in before if path.name not in contents):
        stale.unlink(missing_ok=True)  # a sheet that an earlier run had more than this one
    say(f"Written to {printable(args.out)}: {', '.join(contents)}")
    if not result.reliable:
        complain(
            "calibrate", f"written, but not reliable: {named(result.warnings[0], result, files)}"
        )
        return 3
    return 0


def asked_board(args: argparse.Namespace) -> "Chessboard | CharucoBoard":
    """Make the board that the options describe."""
    if args.charuco:
        return CharucoBoard(args.corners, args.square, args.marker, args.charuco.lower())
    if args.marker:
        raise CvnotesError("--marker is of ChArUco boards: say --charuco as well")
    columns, rows = args.corners
    symmetric = (columns - rows) % 2 == 0
    return Chessboard(args.corners, args.square, half_turn_symmetric=symmetric)


def calibrated(
    examined: "Sequence[Examined]", board: "Chessboard | CharucoBoard", args: argparse.Namespace
) -> "Calibration":
    """Calibrate with the photographs that show the board, with the options' lens and board shape.

    Raises
    ------
    DegenerateError
        They do not determine a camera.
    """
    from cvnotes.calibration import calibrate

    if not examined:
        raise DegenerateError(
            "a board of {}×{} inner corners was found in none (count where four squares meet, "
            "not squares)".format(*args.corners)
        )
    seen = [np.isfinite(photo.corners).all(-1) for photo in examined if photo.corners is not None]
    m = [photo.corners for photo in examined if photo.corners is not None]
    whole = all(s.all() for s in seen)
    W = board.points if whole else [board.points[s] for s in seen]
    m = m if whole else [x[s] for x, s in zip(m, seen, strict=True)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CalibrationWarning)  # the report has them
        # (to leave views out takes four of them)
        lens = _OF_FEW if args.lens == "auto" and len(m) < 4 else args.lens
        shape = "flat" if args.board_shape == "auto" and len(m) < 4 else args.board_shape
        return calibrate(W, m, examined[0].size, lens=lens, board=shape, skew=args.skew)


def without_misfits(
    result: "Calibration",
    used: "list[Examined]",
    board: "Chessboard | CharucoBoard",
    args: argparse.Namespace,
) -> "tuple[Calibration, list[Examined], dict[Path, Examined]]":
    """Calibrate again without photographs that do not fit the others, if these are many enough.

    Gives the result, what it is made of, and those left out with the reason as their note.
    """
    from cvnotes.calibration.reliability import misfits
    from cvnotes.commands.mirrored import EXCHANGED, mirrored

    first, left_out = len(used), dict[Path, "Examined"]()
    for _ in range(_ROUNDS):
        exchanged = mirrored(used, result, board)
        bad = sorted({*exchanged, *misfits(result.view_rms).tolist()})
        kept = [photo for i, photo in enumerate(used) if i not in bad]
        if not bad or len(kept) < max(_KEPT, _MOST * first):
            break
        try:
            again = calibrated(kept, board, args)
        except CvnotesError:  # these alone do not determine the camera
            break
        typical = np.median(result.view_rms)
        for i in bad:
            reason = (
                f"{EXCHANGED} (left out; --keep-all uses it all the same)"
                if i in exchanged
                else f"does not fit the others: {result.view_rms[i]:.2f} px, a typical photograph "
                f"{typical:.2f} px (moved, zoomed, rotated or badly found; left out; --keep-all "
                "uses it all the same)"
            )
            photo = replace(used[i], corners=None, found=used[i].corners, note=reason)
            left_out[photo.path] = photo
        result, used = again, kept
    return result, used, left_out


def proposal_of(result: "Calibration", board: "Chessboard | CharucoBoard") -> "NextView | None":
    """Say where the next photograph should be, unless the board cannot be seen whole."""
    from cvnotes.calibration import next_view

    columns, rows = board.squares
    x, y = (board.square * (np.linspace(0, n, 5) - 1) for n in (columns, rows))
    border = [*((a, y[0]) for a in x), *((x[-1], b) for b in y[1:]),
              *((a, y[-1]) for a in x[-2::-1]), *((x[0], b) for b in y[-2:0:-1])]  # fmt: skip
    with suppress(CvnotesError, np.linalg.LinAlgError):
        return next_view(result, outline=[(*xy, 0.0) for xy in border])
    return None


def contents_of(
    result: "Calibration",
    examined: "Sequence[Examined]",
    board: "Chessboard | CharucoBoard",
    files: Sequence[str],
    rejected: Sequence[Rejected],
    proposal: "NextView | None",
) -> dict[str, bytes]:
    """Give all files to write, by name."""
    from cvnotes.calibration.saving import calibration_json
    from cvnotes.commands.pictures import pictures
    from cvnotes.commands.report import photo_csv
    from cvnotes.files.exchange import opencv_yaml

    note = made_by("calibrate")
    drawn = pictures(result, examined, board, files, proposal)
    notes = [photo.note for photo in examined if photo.corners is not None]
    made = calibration_json(result.as_mapping(), files=files, rejected=rejected, note=note)
    return {
        "calibration.json": made.encode(),
        "calibration.yml": opencv_yaml(result.camera, note=note).encode(),
        "photographs.csv": photo_csv(files, notes, rejected, result).encode(),
        **{name: marked(png, "calibrate") for name, png in drawn.items()},
    }


def _brief(files: Sequence[str], rejected: Sequence[Rejected]) -> tuple[list[str], list[Rejected]]:
    """Name photographs without the folder that they have in common."""
    every = [*files, *(r.file for r in rejected)]
    try:
        common = os.path.commonpath([Path(file).parent for file in every])
    except ValueError:  # some are absolute and some are not
        return list(files), list(rejected)
    short = [str(Path(file).relative_to(common)) for file in every]
    kept = [Rejected(name, r.reason) for name, r in zip(short[len(files) :], rejected, strict=True)]
    return short[: len(files)], kept


def corners_or_auto(text: str) -> tuple[int, int] | None:
    """Read ``9x6``, or ``auto``, which is None.

    Examples
    --------
    >>> corners_or_auto("9x6"), corners_or_auto("auto")
    ((9, 6), None)
    """
    return None if text.strip().lower() == "auto" else corners(text)


def lens(text: str) -> str:
    """Read the names of lens coefficients, such as ``k1 k2`` or ``k1,k2``.

    Examples
    --------
    >>> lens("k1,k2")
    'k1 k2'
    """
    from cvnotes.calibration import LENSES

    name = " ".join(text.replace(",", " ").split())
    if name not in (*LENSES, "auto"):
        known = ", ".join(f'"{known}"' for known in (*LENSES, "auto"))
        raise argparse.ArgumentTypeError(f"expected one of {known}, got {text!r}")
    return name
