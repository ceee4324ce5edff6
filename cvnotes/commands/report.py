"""What `cvnotes calibrate` prints: a line for each photograph, the camera, what is doubtful."""

import csv
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from cvnotes.base import Array, text_table
from cvnotes.base.digits import with_deviation
from cvnotes.calibration.coverage import covered_cells
from cvnotes.calibration.left_out import AtLeast
from cvnotes.calibration.reliability import widest_angle
from cvnotes.commands.examined import Examined
from cvnotes.commands.mirrored import EXCHANGED
from cvnotes.commands.ownership import TABLE_HEADER
from cvnotes.files import Rejected
from cvnotes.files.photos import COPY
from cvnotes.files.writing import harmless
from cvnotes.targets import CharucoBoard, Chessboard

if TYPE_CHECKING:
    from cvnotes.calibration import BoardShape, Calibration

_MANY_LEFT_OUT = 0.5  # of the photographs
_SAME_PLACE = 0.5  # px, between two pictures of a board that did not move
_WIDE = 80  # letters that a reason may have in the table


def photo_table(
    files: Sequence[str],
    notes: Sequence[str],
    rejected: Sequence[Rejected],
    result: "Calibration | None" = None,
) -> str:
    """Return the table of photographs: those used, with their RMS, then the rest with reasons.

    A long reason is cut in the table, and stands once in full below it.
    """
    rms = [""] * len(files) if result is None else [f"{x:.3f}" for x in result.view_rms]
    rows = [list(row) for row in zip(files, rms, notes, strict=True)]
    rows += [[r.file, "–", _in_brief(r.reason)] for r in rejected]
    long = dict.fromkeys(r.reason for r in rejected if _first_clause(r.reason) != r.reason)
    return "\n".join(
        [text_table([["photograph", "RMS (px)", "note"], *rows]), *(f"! {r}" for r in long)]
    )


def photo_csv(
    files: Sequence[str], notes: Sequence[str], rejected: Sequence[Rejected], result: "Calibration"
) -> str:
    """Return the same table for other programs: reasons in full, no RMS for what was not used."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(TABLE_HEADER)
    for file, rms, note in zip(files, result.view_rms, notes, strict=True):
        writer.writerow([harmless(file), f"{rms:.4f}", harmless(note)])
    writer.writerows([harmless(r.file), "", harmless(r.reason)] for r in rejected)
    return text.getvalue()


def camera_report(result: "Calibration") -> str:
    """Return the camera with its error bars, and what the result rests on."""
    from cvnotes.calibration import choose_board, choose_lens

    width, height = result.size
    rows = [
        [name, *with_deviation(value, error), unit] for name, value, error, unit in result.table()
    ]
    corners = sum(map(len, result.image_points))
    cells = covered_cells(result.image_points, result.size)
    lines = [
        f"Camera of {width}×{height} pixels",
        text_table([["", "value", "± 1 σ", ""], *rows]),
        *result.notes_on_deviations,
        f"Field of view   {field_of_view(result)}",
        f"RMS             {result.rms:.3f} px per point, of {corners} corners in "
        f"{len(result.poses)} photographs",
        f"Tilt            boards differ by up to {widest_angle(result.poses):.0f}°",
        f"Coverage        corners in {cells.sum()} of {cells.size} cells of the picture",
    ]
    if result.shape is not None:
        lines.append(f"Board           {_in_mm(result.shape)}")
    if result.left_out:
        lines += ["", _choice("Lens", result.left_out, choose_lens(dict(result.left_out)))]
    if result.left_out_boards:
        chosen = choose_board(dict(result.left_out_boards))
        lines += ["", _choice("Board", result.left_out_boards, chosen)]
    return "\n".join(lines)


def _choice(what: str, left_out: Mapping[str, float], chosen: str) -> str:
    """Return how well each lens, or board, predicts photographs that it has not seen."""
    rows = [
        [
            name,
            f"{rms:.3f}" if np.isfinite(rms) else "no camera",
            "chosen" if name == chosen else "at least" * isinstance(rms, AtLeast),
        ]
        for name, rms in left_out.items()
    ]
    return text_table([[what, "px off in photographs left out", ""], *rows])


def _in_mm(shape: "BoardShape") -> str:
    """Say how far a board is from flat."""
    z, aside = shape.heights, np.linalg.norm(shape.offsets[:, :2], axis=1)
    words = (
        f"not flat: {z.min():.2f} to {z.max():.2f} mm out of its plane "
        f"(± {np.median(shape.std[:, 2]):.2f})"
    )
    moved = f", corners up to {aside.max():.2f} mm beside their places"
    return words + moved * (shape.kind == "free")


def doubts(
    result: "Calibration",
    examined: Sequence[Examined],
    files: Sequence[str],
    rejected: Sequence[Rejected],
    board: Chessboard | CharucoBoard,
) -> list[str]:
    """List what whoever uses the result should know, in sentences that name the photographs."""
    used = [photo for photo in examined if photo.corners is not None]
    sentences = [named(sentence, result, files) for sentence in result.warnings]
    without = len(examined) - len(used)
    if without > _MANY_LEFT_OUT * len(examined):
        sentences.append(
            f"{without} of {len(examined)} photographs were left out, because the board was not "
            "found in them: the camera is only known where the others saw it"
        )
    sentences += _repeated(used, files, rejected)
    exchanged = [r.file for r in rejected if r.reason.startswith(EXCHANGED)]
    if exchanged:
        sentences.append(
            f"{', '.join(exchanged)}: {EXCHANGED}, so the camera was calibrated without; was it a "
            "front camera, or an editing program?"
        )
    if any(photo.turned for photo in used):
        sentences.append(
            "some photographs ask to be turned by their EXIF data; the camera is that of the "
            "pixels as stored (read them with cv2.IMREAD_IGNORE_ORIENTATION)"
        )
    if getattr(board, "half_turn_symmetric", False):
        sentences.append(
            "this board looks the same after half a turn: poses may be turned by 180°, which "
            "does not change the camera"
        )
    if "skew" in result.names:
        sentences.append("OpenCV keeps the skew in calibration.yml but does not use it")
    return sentences


def named(sentence: str, result: "Calibration", files: Sequence[str]) -> str:
    """Name photographs and places in a sentence that counts views and corners from 0."""

    def name(match: re.Match[str]) -> str:
        if not match["corner"]:
            return ", ".join(files[int(i)] for i in match["views"].split(", "))
        view = int(match["view"])
        m = result.image_points[view][int(match["corner"])]
        return f"{_place(m, result.size)} of {files[view]}"

    # (in one go, as files may well be called "view 7.png")
    pattern = r"\bview (?P<view>\d+), corner (?P<corner>\d+)|\bviews? (?P<views>\d+(?:, \d+)*)\b"
    return re.sub(pattern, name, sentence)


def _place(m: Array, size: tuple[int, int]) -> str:
    """Say in which part of a picture a pixel lies.

    Examples
    --------
    >>> _place(np.array([20.0, 460.0]), (640, 480))
    'in the lower left corner'
    """
    across, down = (np.floor(3 * (m + 0.5) / size)).clip(0, 2).astype(int)
    side, height = ("left", "", "right")[across], ("upper", "", "lower")[down]
    if side and height:
        return f"in the {height} {side} corner"
    if side:
        return f"at the {side} edge"
    return {"upper": "at the upper edge", "lower": "at the lower edge"}.get(height, "in the middle")


def _repeated(
    used: Sequence[Examined], files: Sequence[str], rejected: Sequence[Rejected]
) -> Iterator[str]:
    """Say where the same view was counted, or given, several times."""
    copies = sum(r.reason.startswith(COPY) for r in rejected)
    if copies:
        yield (
            f"{copies} of {len(used) + len(rejected)} photographs are copies of others: a copy "
            "adds nothing, and was left out"
        )
    m = np.array([photo.corners for photo in used])
    alike: list[tuple[int, int]] = []
    for i in range(len(m) - 1):
        apart = np.linalg.norm(m[i + 1 :] - m[i], axis=-1)
        alike += [(i, i + 1 + int(k)) for k in np.flatnonzero(np.nanmedian(apart, 1) < _SAME_PLACE)]
    if alike:
        pairs = ", ".join(f"{files[i]} and {files[j]}" for i, j in alike[:3])
        yield (
            f"the board and the camera did not move between {pairs}"
            f"{' …' if len(alike) > 3 else ''}: together they say hardly more than one of them"
        )


def field_of_view(result: "Calibration") -> str:
    """Spell the angles that the picture spans."""
    across, down = np.degrees(result.camera.field_of_view)
    if np.isnan(across + down):
        return "not known: the lens model ends inside the picture"
    return f"{across:.1f}° × {down:.1f}°"


def _in_brief(reason: str) -> str:
    """Cut a reason after its first clause, but keep what was found instead of the board."""
    first = _first_clause(reason)
    found = re.search(r"found, but ([^;)]*)|found (\d+×\d+ corners)", reason)
    if first == reason or found is None:
        return first
    return f"{first}: {found[1] or f'{found[2]} are there'}"


def _first_clause(reason: str) -> str:
    return reason if len(reason) <= _WIDE else re.split(r" \(|; ", reason, maxsplit=1)[0]
