"""What `cvnotes calibrate` prints: a line for each photograph, the camera, what is doubtful."""

import csv
import io
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from cvnotes.base import text_table
from cvnotes.base.digits import with_deviation
from cvnotes.base.writing import harmless
from cvnotes.calibration.coverage import covered_cells, joined
from cvnotes.calibration.prediction import angles_seen
from cvnotes.calibration.reliability import widest_angle
from cvnotes.files import Reason
from cvnotes.files.ownership import TABLE_HEADER
from cvnotes.photographs import Detection, Photographs

if TYPE_CHECKING:
    from cvnotes.calibration import BoardShape, Calibration

_WIDE = 80  # letters that a reason may have in the table


def photo_table(photographs: Photographs, result: "Calibration | None" = None) -> str:
    """Return the table of photographs: those used, with their RMS, then the rest with reasons.

    A long reason is cut in the table, and stands once in full below it.
    """
    names, rejected = photographs.named()
    rms = [""] * len(names) if result is None else [f"{x:.3f}" for x in result.view_rms]
    rows = [list(row) for row in zip(names, rms, map(note_of, photographs.used), strict=True)]
    rows += [[r.file, "–", _fitting(r.reason)] for r in rejected]
    long = dict.fromkeys(str(r.reason) for r in rejected if _fitting(r.reason) != str(r.reason))
    return "\n".join(
        [text_table([["photograph", "RMS (px)", "note"], *rows]), *(f"! {r}" for r in long)]
    )


def _fitting(reason: Reason) -> str:
    words = str(reason)
    return words if len(words) <= _WIDE else reason.brief


def note_of(photo: Detection) -> str:
    """Say what was done to a photograph that is used, and how much of the board is lost."""
    n, lost = len(photo.seen), np.count_nonzero(~photo.seen)
    far, hidden = len(photo.astray), lost - len(photo.astray)
    by = ", ".join(f"{d:.1f} px" for d in photo.astray)
    words = [
        photo.note,
        f"{hidden} of {n} corners left out: they cannot be seen clearly" if hidden else "",
        f"{far} of {n} corners left out: {by} from their place" if far else "",
    ]
    return "; ".join(filter(None, words))


def photo_csv(photographs: Photographs, result: "Calibration") -> str:
    """Return the same table for other programs: reasons in full, no RMS for what was not used."""
    names, rejected = photographs.named()
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(TABLE_HEADER)
    for file, rms, photo in zip(names, result.view_rms, photographs.used, strict=True):
        writer.writerow([harmless(file), f"{rms:.4f}", harmless(note_of(photo))])
    writer.writerows([harmless(r.file), "", harmless(str(r.reason))] for r in rejected)
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
        *result.notes_on_deviations,
        f"Field of view   {field_of_view(result)}",
        f"RMS             {result.rms:.3f} px per point, of {corners} corners in "
        f"{len(result.poses)} photographs",
        f"Tilt            boards differ by up to {widest_angle(result.poses):.0f}°",
        f"Coverage        corners in {cells.sum()} of {cells.size} cells of the picture",
    ]
    if result.shape is not None:
        lines.append(f"Board           {_in_mm(result.shape)}")
    if (choice := result.choice) is not None:
        for what, rms_of, chosen in (
            ("Lens", choice.by_lens, choice.lens),
            ("Board", choice.by_board, choice.board),
        ):
            lines += ["", _choice(what, rms_of, chosen)] * (len(rms_of) > 1)
    return "\n".join(lines)


def _choice(what: str, rms_of: Mapping[str, float], chosen: str) -> str:
    """Return how well each lens, or board, predicts photographs that it has not seen."""
    rows = [[name, f"{rms:.3f}", "chosen" * (name == chosen)] for name, rms in rms_of.items()]
    return text_table([[what, "px off in photographs left out", ""], *rows])


def _in_mm(shape: "BoardShape") -> str:
    """Describe how far a board is from flat."""
    z, aside = shape.heights, np.linalg.norm(shape.offsets[:, :2], axis=1)
    words = (
        f"not flat: {z.min():.2f} to {z.max():.2f} mm out of its plane "
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
