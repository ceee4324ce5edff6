"""A rig as a file: two cameras, how they stand to each other, and how well that is known."""

from collections.abc import Mapping, Sequence

import numpy as np

from cvnotes.files import Rejected
from cvnotes.files.cameras import RIG, VERSION, camera_to_dict, dump, pose_to_dict
from cvnotes.stereo.result import StereoCalibration


def rig_json(
    rig: StereoCalibration,
    *,
    files: Sequence[tuple[str, str]],
    std_of_pairs: Mapping[str, float],
    rows: float | None,
    rejected: Sequence[Rejected] = (),
    note: str = "",
) -> str:
    """Spell a rig as JSON.

    Parameters
    ----------
    rig : StereoCalibration
        The rig.
    files : sequence of (left, right)
        The photographs of each pair.
    std_of_pairs : mapping
        Deviations by the jackknife over pairs, see `cvnotes.stereo.jackknife`.
    rows : float or None
        RMS difference of rows (columns, for cameras one above the other) of rectified corners,
        px; None where they cannot be rectified.
    rejected : sequence of Rejected
        The photographs that were not used, with their reasons.
    note : str
        For whoever opens the file.
    """
    pairs = [
        {"left": left, "right": right, "rms": rms.tolist(), **pose_to_dict(G)}
        for (left, right), rms, G in zip(files, rig.view_rms, rig.poses, strict=True)
    ]
    keys = {
        "format": RIG,
        "version": VERSION,
        **({"note": note} if note else {}),
        "reliable": bool(rig.reliable),
        "converged": bool(rig.converged),
        "warnings": list(rig.warnings),
        "left": camera_to_dict(rig.left),
        "right": camera_to_dict(rig.right),
        "right_from_left": pose_to_dict(rig.G),
        "baseline": float(np.linalg.norm(rig.T)),
        "rms": float(rig.rms),
        "rms_of_rows": rows,
        "standard_deviations": dict(std_of_pairs),
        "standard_deviations_of_noise_alone": rig.std,
        "rejected": [{"file": r.file, "reason": str(r.reason)} for r in rejected],
        "pairs": pairs,
    }
    return dump(keys)
