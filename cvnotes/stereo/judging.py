"""Whether a stereo calibration can be believed, in sentences."""

import numpy as np

from cvnotes.errors import Array
from cvnotes.reliability import Evidence, judge
from cvnotes.stereo.result import StereoCalibration

# Typical distance from the model, over the longer side of the picture, that no noise explains.
_MISFIT = 0.005


def judge_rig(
    result: StereoCalibration,
    corners: tuple[Array, Array],
    distances: tuple[Array, Array],
    strangers: list[int],
) -> tuple[tuple[str, ...], bool]:
    """Give sentences about what is doubtful, and whether the result is reliable all the same.

    Parameters
    ----------
    result : StereoCalibration
        Not judged yet.
    corners, distances : pair of ndarray, shape (n_views, n, 2) and (n_views, n)
        Where the corners were seen in the left and right pictures, and how far from there the
        model puts them; 0 where none was seen, NaN where the lens folds.
    strangers : list of int
        Pairs that show the cameras in another relative pose than the others do.
    """
    fatal: list[str] = []
    if strangers:
        fatal.append(
            f"pairs {', '.join(map(str, strangers))} show the cameras turned by more than 10° "
            "from where the others do: do left and right belong together, is the board numbered "
            "from the same corner in both, did the rig stay rigid?"
        )
    if not result.converged:
        fatal.append("the refinement stopped before it reached a minimum")
    if len(result.names) == 6:  # the cameras were known
        fatal += _misfits(result)
        return tuple(fatal), not fatal
    sentences, reliable = _judge_cameras(result, corners, distances)
    return (*fatal, *sentences), reliable and not fatal


def _misfits(result: StereoCalibration) -> list[str]:
    """Say when known cameras do not explain the corners."""
    typical = float(np.median(result.view_rms))
    if typical <= _MISFIT * max(result.left.size):
        return []
    return [
        f"the corners are {typical:.1f} px away from where the cameras put them, in a typical "
        "picture: do A and lens belong to these pictures?"
    ]


def _judge_cameras(
    result: StereoCalibration, corners: tuple[Array, Array], distances: tuple[Array, Array]
) -> tuple[list[str], bool]:
    """Judge each camera by what `calibrate` judges it by, at the joint minimum."""
    sentences: list[str] = []
    reliable = True
    poses = (result.poses, result.G @ result.poses)
    for i, side in enumerate(("left", "right")):
        camera = result.cameras[i]
        evidence = Evidence(
            A=camera.A,
            lens=camera.lens,
            size=camera.size,
            poses=poses[i],
            std={n.removeprefix(f"{side}."): s for n, s in result.std.items() if side in n},
            view_rms=result.view_rms[:, i],
            distances=distances[i],
            corners=corners[i],
            converged=True,
        )
        found, believed = judge(evidence)
        sentences += [f"{side} camera: {sentence}" for sentence in found]
        reliable = reliable and believed
    return sentences, reliable
