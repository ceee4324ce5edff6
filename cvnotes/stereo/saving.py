"""A rig as a file: two cameras, how they stand to each other, and how well that is known."""

from collections.abc import Sequence

import numpy as np

from cvnotes.base import Array
from cvnotes.files import CameraInfo, Rejected
from cvnotes.files.cameras import RIG, VERSION, camera_to_dict, dump, pose_to_dict
from cvnotes.files.exchange import opencv_matrix
from cvnotes.stereo.rectification import RectifiedPair
from cvnotes.stereo.result import StereoCalibration

_METRE = 1000.0  # of our millimetres


def rig_json(
    rig: StereoCalibration,
    *,
    files: Sequence[tuple[str, str]],
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
        "standard_deviations": rig.honest_std,
        "standard_deviations_of_noise_alone": rig.std,
        "rejected": [{"file": r.file, "reason": str(r.reason)} for r in rejected],
        "pairs": pairs,
    }
    return dump(keys)


def camera_infos(
    rig: StereoCalibration, pair: RectifiedPair | None = None
) -> tuple[CameraInfo, CameraInfo]:
    """Describe both cameras as ROS does, by their rectified pictures if these are known.

    A rig in millimetres is then one in metres.

    Notes
    -----
    The third column of the right camera's P is −α b: P M = A (M − b e), e being the axis of the
    disparity.
    """
    named = zip(rig.cameras, ("left", "right"), strict=True)
    if pair is None:
        left, right = (CameraInfo(camera.moved(np.eye(4)), name) for camera, name in named)
        return left, right
    left, right = (
        CameraInfo(camera.moved(np.eye(4)), name, ideal.R @ camera.R.T, P)
        for (camera, name), ideal, P in zip(named, pair[:2], _projections(pair), strict=True)
    )
    return left, right


def _projections(pair: RectifiedPair, unit: float = _METRE) -> list[Array]:
    """Return P (3, 4) of both rectified cameras, in the frame that the left one has."""
    b = np.zeros(3)
    b[pair.axis] = pair.baseline / unit
    return [pair.left.A @ np.column_stack([np.eye(3), -x]) for x in (0 * b, b)]


def opencv_rig_yaml(
    rig: StereoCalibration, pair: RectifiedPair | None = None, *, note: str = ""
) -> str:
    """Spell a rig for ``cv2.FileStorage``, by the names of OpenCV's own example and functions.

    M, D of both cameras, R and T between them; rectified also R1, R2, P1, P2 and Q, which
    ``cv2.reprojectImageTo3D`` takes. Lengths are in the unit of the board.
    """
    w, h = rig.left.size
    remark = f"# {note}\n" if note else ""
    matrices: dict[str, Array] = {}
    for i, camera in enumerate(rig.cameras, start=1):
        matrices |= {f"M{i}": camera.A, f"D{i}": camera.lens.opencv_coefficients()[None]}
    matrices |= {"R": rig.R, "T": rig.T[:, None]}
    if pair is not None:
        P1, P2 = _projections(pair, unit=1.0)
        R1, R2 = (ideal.R @ camera.R.T for ideal, camera in zip(pair[:2], rig.cameras, strict=True))
        Q = np.eye(4)
        Q[:2, 3], Q[2:, 2:] = -P1[:2, 2], [[0, P1[0, 0]], [1 / pair.baseline, 0]]
        matrices |= {"R1": R1, "R2": R2, "P1": P1, "P2": P2, "Q": Q}
    text = "".join(opencv_matrix(name, M) for name, M in matrices.items())
    return f"%YAML:1.0\n---\n{remark}image_width: {w}\nimage_height: {h}\n{text}"
