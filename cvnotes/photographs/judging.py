"""What whoever uses a camera should know of its photographs, and which to take next."""

from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.calibration import Calibration, NextView, next_view
from cvnotes.calibration.doubts import Corner, Doubt, Place, View
from cvnotes.calibration.thresholds import MANY_WITHOUT_BOARD, SAME_PLACE
from cvnotes.files.reasons import Copy
from cvnotes.photographs.detection import Photographs
from cvnotes.photographs.reasons import Exchanged, Mixed
from cvnotes.targets import Chessboard


def judge(result: Calibration, photographs: Photographs) -> list[str]:
    """Return sentences about the camera and about its photographs, which name these."""
    names, rejected = photographs.named()
    sentences = [naming(sentence, result, names) for sentence in result.warnings]
    without, n = len(photographs.looked_at) - len(photographs.used), len(photographs.looked_at)
    if without > MANY_WITHOUT_BOARD * n:
        sentences.append(
            f"{without} of {n} photographs were left out, because the board was not found in them: "
            "the camera is only known where the others saw it"
        )
    sentences += _repeated(photographs, names)
    exchanged = [r.file for r in rejected if isinstance(r.reason, Exchanged)]
    if exchanged:
        sentences.append(
            f"{', '.join(exchanged)}: {Exchanged.words}, so the camera was calibrated without; "
            "was it a front camera, or an editing program?"
        )
    if any(photo.turned for photo in photographs.used):
        sentences.append(
            "some photographs ask to be turned by their EXIF data; the camera is that of the "
            "pixels as stored (read them with cv2.IMREAD_IGNORE_ORIENTATION)"
        )
    board = photographs.board
    if isinstance(board, Chessboard) and board.half_turn_symmetric:
        sentences.append(
            "this board looks the same after half a turn: poses may be turned by 180°, which "
            "does not change the camera"
        )
    if "skew" in result.names:
        sentences.append("OpenCV keeps the skew in calibration.yml but does not use it")
    return sentences


def naming(sentence: str, result: Calibration, names: list[str]) -> str:
    """Name photographs, and places in them, in a sentence that counts views and corners."""

    def name(place: Place) -> str:
        if isinstance(place, View):
            return names[place.number]
        if isinstance(place, Corner):
            m = result.image_points[place.view][place.corner]
            return f"{part_of_picture(m, result.size)} of {names[place.view]}"
        return place.listed(names.__getitem__)

    return sentence.naming(name) if isinstance(sentence, Doubt) else sentence


def part_of_picture(m: Array, size: tuple[int, int]) -> str:
    """Describe in which part of a picture a pixel lies.

    Examples
    --------
    >>> part_of_picture(np.array([20.0, 460.0]), (640, 480))
    'in the lower left corner'
    """
    across, down = (np.floor(3 * (m + 0.5) / size)).clip(0, 2).astype(int)
    side, height = ("left", "", "right")[across], ("upper", "", "lower")[down]
    if side and height:
        return f"in the {height} {side} corner"
    if side:
        return f"at the {side} edge"
    return {"upper": "at the upper edge", "lower": "at the lower edge"}.get(height, "in the middle")


def _repeated(photographs: Photographs, names: list[str]) -> Iterator[str]:
    """Describe where the same view was counted, or given, several times."""
    used, rejected = photographs.used, photographs.rejected
    copies = sum(isinstance(r.reason, Copy) for r in rejected)
    if copies:
        yield (
            f"{copies} of {len(used) + len(rejected)} photographs are copies of others: a copy "
            "adds nothing, and was left out"
        )
    m = np.array([photo.corners for photo in used])
    alike: list[tuple[int, int]] = []
    for i in range(len(m) - 1):
        apart = np.linalg.norm(m[i + 1 :] - m[i], axis=-1)
        alike += [(i, i + 1 + int(k)) for k in np.flatnonzero(np.nanmedian(apart, 1) < SAME_PLACE)]
    if alike:
        pairs = ", ".join(f"{names[i]} and {names[j]}" for i, j in alike[:3])
        yield (
            f"the board and the camera did not move between {pairs}"
            f"{' …' if len(alike) > 3 else ''}: together they say hardly more than one of them"
        )


def propose(result: Calibration, photographs: Photographs) -> NextView | None:
    """Propose where the next photograph should be, unless the board cannot be seen whole.

    Photographs that no single camera took are not to be added to.
    """
    if any(isinstance(sentence, Mixed) for sentence in result.warnings):
        return None
    board = photographs.board
    columns, rows = board.squares
    x, y = (board.square * (np.linspace(0, n, 5) - 1) for n in (columns, rows))
    border = [*((a, y[0]) for a in x), *((x[-1], b) for b in y[1:]),
              *((a, y[-1]) for a in x[-2::-1]), *((x[0], b) for b in y[-2:0:-1])]  # fmt: skip
    with suppress(CvnotesError, np.linalg.LinAlgError):
        return next_view(result, outline=[(*xy, 0.0) for xy in border])
    return None
