"""``cvnotes target``: write a chessboard to print."""

import argparse
from pathlib import Path

from cvnotes.base import CvnotesError
from cvnotes.base.writing import printable
from cvnotes.commands.console import complain, say
from cvnotes.files import write_whole
from cvnotes.files.ownership import refuse_foreign
from cvnotes.targets import PAPERS, CharucoBoard, Chessboard


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describe the command's arguments."""
    parser = subparsers.add_parser(
        "target",
        help="write a chessboard to print, in true millimetres",
        description="Write a chessboard to print, as PDF or SVG in true millimetres, with two "
        "rulers that show whether the printer kept the scale.",
    )
    add = parser.add_argument
    add("--corners", type=corners, default=(9, 6), metavar="9x6",
        help="inner corners (default 9x6)")  # fmt: skip
    add("--square", type=length, default=25.0, metavar="25",
        help="side of a square in mm (default 25)")  # fmt: skip
    add("--paper", type=_paper, choices=list(PAPERS), default="A4", help="paper (default A4)")
    add("--out", required=True, metavar="board.pdf", help="file to write, .pdf or .svg")
    add("--half-turn-symmetric", action="store_true",
        help="allow a board whose origin no picture can tell")  # fmt: skip
    add("--charuco", nargs="?", const="4x4_50", metavar="4x4_50", help="with numbered markers "
        "of this dictionary (default 4x4_50) in the light squares")  # fmt: skip
    add("--marker", type=length, metavar="18.75",
        help="side of its markers in mm (default: three quarters of a square)")  # fmt: skip


def run(args: argparse.Namespace) -> int:
    """Write the sheet; give the exit code: 0 done, 1 cannot, 2 no such board."""
    try:
        board: Chessboard | CharucoBoard
        if args.charuco:
            board = CharucoBoard(args.corners, args.square, args.marker, args.charuco.lower())
        else:
            board = Chessboard(args.corners, args.square, args.half_turn_symmetric)
    except CvnotesError as error:
        option = str(error).replace("say half_turn_symmetric=True", "say --half-turn-symmetric")
        complain("target", option)
        return 2
    out = Path(args.out)
    if out.is_file():
        refuse_foreign(out, "target")
    write_whole({out: board.sheet(args.paper).encoded(args.out)})
    say(f"{printable(args.out)}: print it at 100 %, and check that both rulers are 100 mm")
    return 0


def corners(text: str) -> tuple[int, int]:
    """Read inner corners as ``9x6``.

    Examples
    --------
    >>> corners("9x6")
    (9, 6)
    """
    columns, _, rows = text.lower().replace("×", "x").partition("x")
    if not (_is_count(columns) and _is_count(rows)):
        raise argparse.ArgumentTypeError(f"expected inner corners such as 9x6, got {text!r}")
    return int(columns), int(rows)


def _paper(text: str) -> str:
    """Read the name of a paper in capitals or not: A4, a4, letter."""
    return next((name for name in PAPERS if name.lower() == text.lower()), text)


def length(text: str) -> float:
    """Read a positive length, with a decimal point.

    Examples
    --------
    >>> length("24.8")
    24.8
    """
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < float("inf"):
        comma = "; write a point for the comma" if "," in text else ""
        raise argparse.ArgumentTypeError(f"expected a length such as 25, got {text!r}{comma}")
    return value


def _is_count(text: str) -> bool:
    return text.isascii() and text.isdigit() and len(text) < 5
