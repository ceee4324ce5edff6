"""All steps from photographs of a board to a camera: find, count, put together, choose, judge."""

from collections.abc import Iterable
from dataclasses import dataclass

from cvnotes.base.writing import PathLike
from cvnotes.calibration import Calibration, NextView
from cvnotes.camera import Camera
from cvnotes.files.video import Progress, unseen
from cvnotes.photographs.choosing import Model, choose
from cvnotes.photographs.detection import (
    Board,
    Given,
    Photographs,
    count,
    detect_all,
    listed,
    probed,
    sorted_out,
)
from cvnotes.photographs.judging import judge, propose
from cvnotes.targets import CharucoBoard, Chessboard


@dataclass(frozen=True, eq=False)
class CalibratedPhotographs:
    """What photographs of a board say about the camera that took them.

    Attributes
    ----------
    calibration : Calibration
        The camera with its error bars; its views are ``photographs.used``.
    photographs : Photographs
        All photographs: where the board was found, and which are not used for what reason.
    doubts : list of str
        What whoever uses the camera should know, in sentences that name the photographs.
    next_view : NextView or None
        The photograph that would say most; None if the board cannot be seen whole, or no single
        camera took the photographs.
    """

    calibration: Calibration
    photographs: Photographs
    doubts: list[str]
    next_view: NextView | None

    @property
    def camera(self) -> Camera:
        """The camera, with its own frame as the WRF."""
        return self.calibration.camera

    @property
    def reliable(self) -> bool:
        """Whether the camera is to be believed."""
        return self.calibration.reliable

    def __repr__(self) -> str:
        lines = [repr(self.calibration), *(f"  ! {doubt}" for doubt in self.doubts)]
        rejected = self.photographs.named()[1]
        return "\n".join([*lines, *(f"  not used: {r.file}: {r.reason.brief}" for r in rejected)])


def calibrate_photographs(
    photographs: Iterable[Given] | PathLike,
    board: Board | float,
    *,
    lens: str = "auto",
    board_shape: str = "auto",
    skew: bool = False,
    leave_out: Iterable[PathLike] = (),
    keep_all: bool = False,
    progress: Progress = unseen,
) -> CalibratedPhotographs:
    """Calibrate a camera from its photographs of a board, as ``cvnotes calibrate`` does.

    Parameters
    ----------
    photographs : path, or iterable of paths, arrays or Photo
        Files, folders of files, pictures (height, width) or (height, width, 3), what `read_photos`
        gave, or videos, of which frames are taken (`cvnotes.files.video`).
    board : Chessboard, CharucoBoard or float
        What was photographed; or the side of a square in mm, for a chessboard whose corners are
        counted in the photographs.
    lens, board_shape : str
        As for `calibrate`, where the latter is `board`. With "auto", which is the default,
        cross-validation decides on the lens; of fewer than four views "k1 k2 p1 p2" and "flat" are
        estimated.
    skew : bool
        Estimate the skew too.
    leave_out : iterable of paths
        Photographs not to use, by path or by name alone; arrays are "photograph 0" and so on.
    keep_all : bool
        Use photographs that do not fit the others too; they are left out otherwise.
    progress : callable
        (items, how many) → the same items, for whoever wants to show how far it is.

    Returns
    -------
    CalibratedPhotographs
        The camera, all photographs with reasons for those that are not used, what is doubtful, and
        the next view.

    Raises
    ------
    FileError
        There are no photographs.
    NoCamera
        They do not determine a camera; the error knows what was seen in each.
    DegenerateError
        No corners could be counted.

    Notes
    -----
    1. Files are listed; pictures of another size, and what the commands made, are out.
    2. The corners are counted, if need be: as most photographs show.
    3. The board is detected in each photograph; corners that cannot be seen are NaN.
    4. Copies of a picture are out.
    5. The lens is chosen by cross-validation, the board's shape estimated with it. Single corners
       are out that miss their places by half a pixel, five times the median and twice the next of
       their view; then views with an RMS of more than 0.5 px and four times the median, and those
       that a mirror explains far better. Each time all begins anew, three times at most, as long
       as two thirds of the photographs are left. Photographs of two cameras are kept, and named,
       and so are mirrored ones where nobody can tell them from the others: the camera then is not
       reliable.
    6. The result is judged: do the views determine the camera, do the corners fit it?

    Examples
    --------
    >>> from cvnotes.pictures import course
    >>> found = calibrate_photographs(course.photos()[:5], course.board(), lens="k1 k2")
    >>> len(found.photographs.used), found.reliable
    (5, True)
    >>> bool(abs(found.camera.A[0, 0] - course.camera().A[0, 0]) < 2)
    True
    """
    together = detect_photographs(photographs, board, leave_out=leave_out, progress=progress)
    return calibrate_detected(together, Model(lens, board_shape, skew), keep_all=keep_all)


def detect_photographs(
    photographs: Iterable[Given] | PathLike,
    board: Board | float,
    *,
    leave_out: Iterable[PathLike] = (),
    progress: Progress = unseen,
) -> Photographs:
    """Look for the board in photographs: the first steps of `calibrate_photographs`."""
    files, rejected = listed(photographs, leave_out, progress)
    counted = not isinstance(board, Board)
    if not isinstance(board, Board):
        board = chessboard(count(files, rejected), board)
    if isinstance(board, CharucoBoard) and board.legacy is None:
        board = probed(files, board)
    seen = progress(detect_all(files, board), len(files))
    return sorted_out(board, seen, rejected, counted=counted)


def calibrate_detected(
    photographs: Photographs, model: Model | None = None, *, keep_all: bool = False
) -> CalibratedPhotographs:
    """Calibrate from photographs in which the board was looked for: the last steps of all.

    Raises
    ------
    NoCamera
        They do not determine a camera.
    """
    result, photographs = choose(photographs, model or Model(), keep_all=keep_all)
    doubts = judge(result, photographs)
    return CalibratedPhotographs(result, photographs, doubts, propose(result, photographs))


def chessboard(corners: tuple[int, int], square: float) -> Chessboard:
    """Return a chessboard; one that half a turn does not change may be numbered from either end."""
    columns, rows = corners
    return Chessboard(corners, square, half_turn_symmetric=(columns - rows) % 2 == 0)
