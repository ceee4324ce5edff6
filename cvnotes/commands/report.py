"""What `cvnotes calibrate` prints: a line for each photograph, the camera, what is doubtful."""

import csv
import io
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from cvnotes.base import text_table
from cvnotes.base.digits import with_deviation
from cvnotes.calibration.reliability import widest_angle
from cvnotes.commands.examined import Examined
from cvnotes.commands.ownership import TABLE_HEADER
from cvnotes.files import Rejected
from cvnotes.files.writing import harmless
from cvnotes.show.figures.quality import covered_cells

if TYPE_CHECKING:
    from cvnotes.calibration import Calibration

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
    rows += [[r.file, "–", _first_clause(r.reason)] for r in rejected]
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
    width, height = result.size
    rows = [
        [name, *with_deviation(value, error), unit] for name, value, error, unit in result.table()
    ]
    corners = sum(map(len, result.image_points))
    cells = covered_cells(result.image_points, result.size)
    lines = [
        f"Camera of {width}×{height} pixels",
        text_table([["", "value", "± 1 σ", ""], *rows]),
        f"Field of view   {field_of_view(result)}",
        f"RMS             {result.rms:.3f} px per point, of {corners} corners in "
        f"{len(result.poses)} photographs",
        f"Tilt            boards differ by up to {widest_angle(result.poses):.0f}°",
        f"Coverage        corners in {cells.sum()} of {cells.size} cells of the picture",
    ]
    return "\n".join(lines)


def doubts(result: "Calibration", examined: Sequence[Examined], *, symmetric: bool) -> list[str]:
    """List what whoever uses the result should know, in sentences."""
    sentences = list(result.warnings)
    if any(photo.turned for photo in examined):
        sentences.append(
            "some photographs ask to be turned by their EXIF data; the camera is that of the "
            "pixels as stored (read them with cv2.IMREAD_IGNORE_ORIENTATION)"
        )
    if symmetric:
        sentences.append(
            "this board looks the same after half a turn: poses may be turned by 180°, which "
            "does not change the camera"
        )
    if "skew" in result.names:
        sentences.append("OpenCV keeps the skew in calibration.yml but does not use it")
    return sentences


def field_of_view(result: "Calibration") -> str:
    """Spell the angles that the picture spans."""
    across, down = np.degrees(result.camera.field_of_view)
    if np.isnan(across + down):
        return "not known: the lens model ends inside the picture"
    return f"{across:.1f}° × {down:.1f}°"


def _first_clause(reason: str) -> str:
    return reason if len(reason) <= _WIDE else re.split(r" \(|; ", reason, maxsplit=1)[0]
