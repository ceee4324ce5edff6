"""What `cvnotes calibrate` prints: a line for each photograph, the camera, what is doubtful."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from cvnotes.base import text_table
from cvnotes.base.digits import with_deviation
from cvnotes.base.writing import as_csv
from cvnotes.calibration.coverage import covered_cells, joined
from cvnotes.calibration.prediction import angles_seen
from cvnotes.calibration.reliability import widest_angle
from cvnotes.files import Reason
from cvnotes.files.ownership import TABLE_HEADER
from cvnotes.files.reasons import together
from cvnotes.photographs import Detection, Photographs

if TYPE_CHECKING:
    from cvnotes.base import Array
    from cvnotes.calibration import BoardShape, Calibration

_WIDE = 80  # letters that a reason may have in the table


# A sentence, facts by their names, or a table with its header.
Block = str | dict[str, str] | list[list[str]]


def as_text(blocks: Sequence[Block]) -> str:
    """Lay out blocks for a terminal.

    Examples
    --------
    >>> print(as_text(["A camera", {"RMS": "0.1 px"}]))
    A camera
    RMS   0.1 px
    """
    lines = []
    for block in blocks:
        if isinstance(block, dict):
            width = max(map(len, block)) + 3
            lines += [f"{name:<{width}}{text}" for name, text in block.items()]
        else:
            lines.append(block if isinstance(block, str) else text_table(block))
    return "\n".join(lines)


def photo_table(photographs: Photographs, result: "Calibration | None" = None) -> str:
    """Return the table of photographs: those used, with their RMS, then the rest with reasons.

    A long reason is cut in the table, and stands below it, once for all that have it.
    """
    names, rejected = photographs.named()
    rms = [""] * len(names) if result is None else [f"{x:.3f}" for x in result.view_rms]
    rows = [list(row) for row in zip(names, rms, notes_of(photographs, result), strict=True)]
    rows += [[r.file, "–", _fitting(r.reason)] for r in rejected]
    long = together(r for r in rejected if _fitting(r.reason) != str(r.reason))
    table = text_table([["photograph", "RMS (px)", "note"], *rows])
    return "\n".join([table, *(f"! {sentence}" for sentence in long)])


def _fitting(reason: Reason) -> str:
    words = str(reason)
    return words if len(words) <= _WIDE else reason.brief


def notes_of(photographs: Photographs, result: "Calibration | None" = None) -> list[str]:
    """Say what was done to each photograph that is used; see `note_of`."""
    if result is None:
        return [note_of(photo) for photo in photographs.used]
    seen = (camera.project(photographs.board.points) for camera in result.cameras)
    return [note_of(photo, m) for photo, m in zip(photographs.used, seen, strict=True)]


def note_of(photo: Detection, m: "Array | None" = None) -> str:
    """Say what was done to a photograph that is used, and how much of the board is lost.

    As soon as the camera is known, which sees the board's corners at m (n, 2), also why.
    """
    n, far, clear = len(photo.seen), len(photo.astray), "they cannot be seen clearly"
    outside = 0
    if m is None:
        clear += ", or are outside the picture"
    else:
        inside = ((m > -0.5) & (m < np.array(photo.size) - 0.5)).all(-1)
        outside = np.count_nonzero(~inside & ~photo.seen)
    hidden = np.count_nonzero(~photo.seen) - far - outside
    by = ", ".join(f"{d:.1f} px" for d in photo.astray)
    words = [
        photo.note,
        f"{outside} of {n} corners are outside the picture" if outside else "",
        f"{hidden} of {n} corners left out: {clear}" if hidden > 0 else "",
        f"{far} of {n} corners left out: {by} from their place" if far else "",
    ]
    return "; ".join(filter(None, words))


def photo_csv(photographs: Photographs, result: "Calibration") -> str:
    """Return the same table for other programs: reasons in full, no RMS for what was not used."""
    names, rejected = photographs.named()
    used = zip(names, result.view_rms, notes_of(photographs, result), strict=True)
    rows = [(file, f"{rms:.4f}", note) for file, rms, note in used]
    return as_csv([TABLE_HEADER, *rows, *((r.file, "", str(r.reason)) for r in rejected)])


def camera_report(result: "Calibration") -> list[Block]:
    """Return the camera with its error bars, and what the result rests on."""
    width, height = result.size
    rows = [
        [name, *with_deviation(value, error), unit] for name, value, error, unit in result.table()
    ]
    corners = sum(map(len, result.image_points))
    cells = covered_cells(result.image_points, result.size)
    facts = {
        "Field of view": field_of_view(result),
        "RMS": f"{result.rms:.3f} px per point, of {corners} corners in "
        f"{len(result.poses)} photographs",
        "Tilt": f"boards differ by up to {widest_angle(result.poses):.0f}°",
        "Coverage": f"corners in {cells.sum()} of {cells.size} cells of the picture",
    }
    if result.shape is not None:
        facts["Board"] = _in_mm(result.shape)
    table = [["", "value", "± 1 σ", ""], *rows]
    blocks: list[Block] = [
        f"Camera of {width}×{height} pixels",
        table,
        *result.notes_on_deviations,
        facts,
    ]
    if (choice := result.choice) is not None:
        for what, rms_of, chosen in (
            ("Lens", choice.by_lens, choice.lens),
            ("Board", choice.by_board, choice.board),
        ):
            blocks += ["", _choice(what, rms_of, chosen)] * (len(rms_of) > 1)
    return blocks


def _choice(what: str, rms_of: Mapping[str, float], chosen: str) -> list[list[str]]:
    """Return how well each lens, or board, predicts photographs that it has not seen."""
    rows = [[name, f"{rms:.3f}", "chosen" * (name == chosen)] for name, rms in rms_of.items()]
    return [[what, "px off in photographs left out", ""], *rows]


def _in_mm(shape: "BoardShape") -> str:
    """Describe how far a board is from flat."""
    z, aside = shape.heights, np.linalg.norm(shape.offsets[:, :2], axis=1)
    words = (
        f"{z.min().round(2) + 0.0:.2f} to {z.max():.2f} mm out of its plane "
        f"(± {np.median(shape.std[:, 2]):.2f})"
    )
    moved = f", corners up to {aside.max():.2f} mm beside their places"
    return words + moved * (shape.kind == "free")


def field_of_view(result: "Calibration") -> str:
    """Spell the angles that the part of the picture spans in which corners were seen."""
    angles, std = np.degrees(angles_seen(result))
    if np.isnan(angles).any():
        return "not known: the lens model ends where corners were seen"
    known = " × ".join(
        "{}° ± {}°".format(*with_deviation(a, s)) if np.isfinite(s) else f"{a:.1f}°"
        for a, s in zip(angles, std, strict=True)
    )
    m = joined(result.image_points)
    part = " × ".join(f"{x:.0%}" for x in np.ptp(m, axis=0) / result.size)
    return f"{known}, where corners were seen ({part} of the picture)"
