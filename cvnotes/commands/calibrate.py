"""``cvnotes calibrate``: from photographs of a chessboard to a camera with error bars."""

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING

from cvnotes.base import CvnotesError
from cvnotes.base.writing import check_folder, printable
from cvnotes.commands.console import EXIT_CODES, complain, progress, say, shortfall
from cvnotes.commands.target import corners, length
from cvnotes.files import write_whole
from cvnotes.files.ownership import earlier, made_by
from cvnotes.files.reasons import unread
from cvnotes.targets import CharucoBoard, Chessboard

if TYPE_CHECKING:
    from cvnotes.photographs import CalibratedPhotographs, Photographs

_RESULTS = re.compile(r"calibration\.(json|yml)|ost\.yaml|photographs\.csv|report\.html")


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describe the command's arguments."""
    parser = subparsers.add_parser(
        "calibrate",
        help="calibrate a camera from photographs of a chessboard",
        description="Calibrate a camera from photographs of a chessboard. Take ten or more, with "
        "the board tilted by 30 to 45 degrees in different directions and reaching into the "
        "corners of the picture, without touching focus or zoom. (A camera that is connected "
        'photographs by itself on the site\'s page "Calibrate your camera".)',
        epilog="example: cvnotes calibrate photos/ --corners 9x6 --square 25 --out result/. "
        f"{EXIT_CODES}",
    )
    parser.add_argument(
        "photos",
        nargs="+",
        metavar="PHOTO",
        help="photographs, folders of photographs, or videos, of which frames are taken that are "
        "sharp, still and different",
    )
    add_options(parser)


def add_options(parser: argparse.ArgumentParser) -> None:
    """Describe what a board and a camera have, one camera or two."""
    add = parser.add_argument
    add("--corners", type=corners_or_auto, required=True, metavar="9x6",
        help="inner corners of the board along x and y: where four squares meet; or auto to "
        "have them counted in the photographs")  # fmt: skip
    add("--square", type=length, required=True, metavar="25", help="side of a square, in mm")
    add("--charuco", nargs="?", const="4x4_50", metavar="4x4_50", help="the board is a ChArUco "
        "board, its markers of this dictionary (default 4x4_50)")  # fmt: skip
    add("--marker", type=length, metavar="18.75",
        help="side of its markers, in mm (default: three quarters of a square)")  # fmt: skip
    add("--out", type=Path, required=True, metavar="FOLDER", help="folder for the results")
    add("--lens", type=lens, default="auto", metavar='"k1 k2"',
        help='lens to estimate: auto (default: views left out decide), none, k1, "k1 k2", '
        '"k1 k2 p1 p2", "k1 k2 p1 p2 k3", rational, fisheye')  # fmt: skip
    add("--board-shape", choices=("flat", "bent", "free", "auto"), default="auto",
        help="the board as it was drawn, bent smoothly, or every corner where the photographs say; "
        "auto (default): the last, of four or more")  # fmt: skip
    add("--leave-out", nargs="+", default=[], metavar="PHOTO", action="extend",
        help="photographs not to use, by their names")  # fmt: skip
    add("--keep-all", action="store_true", help="use photographs that do not fit the others too; "
        "they are left out otherwise")  # fmt: skip
    add("--skew", action="store_true", help="estimate the skew of the pixels' axes too")


def run(args: argparse.Namespace) -> int:
    """Calibrate; gives the exit code: 0 done, 1 cannot, 2 no board, 3 doubtful, not all read."""
    from cvnotes.commands.report import as_text, camera_report, photo_table
    from cvnotes.photographs import NoCamera, calibrate_photographs

    try:
        board = asked_board(args)
    except CvnotesError as error:
        complain("calibrate", str(error))
        return 2
    check_folder(args.out)
    earlier(args.out, _RESULTS.fullmatch, "calibrate")
    try:
        found = calibrate_photographs(
            args.photos,
            board,
            lens=args.lens,
            board_shape=args.board_shape,
            skew=args.skew,
            leave_out=args.leave_out,
            keep_all=args.keep_all,
            progress=progress,
        )
    except NoCamera as error:
        say_count(error.photographs)
        say(photo_table(error.photographs))
        other = error.photographs.instead
        hint = ": try --corners {}x{}".format(*other) if other else ""
        complain("calibrate", f"{error}{hint}")
        return 1
    say_count(found.photographs)
    say(photo_table(found.photographs, found.calibration) + "\n")
    say(as_text(camera_report(found.calibration)) + "\n")
    for sentence in found.doubts:
        say(f"! {sentence}")
    if found.next_view:
        say(f"Next photograph: {found.next_view}")
    contents = contents_of(found)
    write_whole({args.out / name: data for name, data in contents.items()})
    say(f"Written to {printable(args.out)}: {', '.join(contents)}")
    if not found.reliable:
        complain("calibrate", f"written, but not reliable: {found.doubts[0]}")
        return 3
    missing = unread(found.photographs.rejected, map(str, args.photos))
    asked = missing + len(found.photographs.used)
    return shortfall("calibrate", missing, asked, "could not be read")


def asked_board(args: argparse.Namespace) -> Chessboard | CharucoBoard | float:
    """Make the board that the options describe; the side of its squares if it is to be counted."""
    from cvnotes.photographs.driver import chessboard

    if args.charuco:
        if args.corners is None:
            raise CvnotesError("--corners auto counts chessboards; say how many corners it has")
        return CharucoBoard(args.corners, args.square, args.marker, args.charuco.lower())
    if args.marker:
        raise CvnotesError("--marker is of ChArUco boards: say --charuco as well")
    if args.corners is None:
        side: float = args.square
        return side
    return chessboard(args.corners, args.square)


def say_count(photographs: "Photographs") -> None:
    """Say which board was counted, if it was."""
    if photographs.counted:
        columns, rows = photographs.board.corners
        say(f"A board of {columns}×{rows} inner corners, as counted in the photographs\n")


def contents_of(found: "CalibratedPhotographs") -> dict[str, bytes]:
    """Return all files to write, by name."""
    from cvnotes.calibration.saving import calibration_json
    from cvnotes.commands.page import report_page
    from cvnotes.commands.report import photo_csv
    from cvnotes.files.exchange import CameraInfo, opencv_yaml, ros_yaml

    note, result = made_by("calibrate"), found.calibration
    names, rejected = found.photographs.named()
    made = calibration_json(result.as_mapping(), files=names, rejected=rejected, note=note)
    return {
        "calibration.json": made.encode(),
        "calibration.yml": opencv_yaml(result.camera, note=note).encode(),
        "ost.yaml": ros_yaml(CameraInfo(result.camera), note=note).encode(),
        "photographs.csv": photo_csv(found.photographs, result).encode(),
        "report.html": report_page(found, note=note).encode(),
    }


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
