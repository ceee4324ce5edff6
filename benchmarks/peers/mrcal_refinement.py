"""Time mrcal's refinement, in a Python that has mrcal: ``python3 mrcal_refinement.py FILE.npz``.

The file holds ``W`` (rows, columns, 2) and its ``spacing``, ``m`` (views, rows, columns, 2),
``size``, the start (``intrinsics``, ``frames``) and how often to repeat. Prints the RMS per point
and the seconds of each run.
"""

import json
import sys
import time

import mrcal
import numpy as np


def main() -> None:
    given = np.load(sys.argv[1])
    m, views = given["m"], len(given["m"])
    observations = np.concatenate([m, np.ones((*m.shape[:3], 1))], axis=-1)
    which = np.stack([np.arange(views), np.zeros(views), np.full(views, -1)], axis=-1)
    seconds = []
    for _ in range(int(given["repeats"]) + 1):
        problem = {
            "intrinsics": given["intrinsics"][None].copy(),
            "frames_rt_toref": given["frames"].copy(),
            "extrinsics_rt_fromref": np.zeros((0, 6)),
            "points": None,
            "observations_board": observations.copy(),
            "indices_frame_camintrinsics_camextrinsics": which.astype(np.int32),
            "observations_point": None,
            "indices_point_camintrinsics_camextrinsics": None,
            "lensmodel": "LENSMODEL_OPENCV4",
            "imagersizes": given["size"][None].astype(np.int32),
            "calibration_object_spacing": float(given["spacing"]),
            "do_optimize_calobject_warp": False,
            "do_apply_outlier_rejection": False,
            "do_apply_regularization": False,
            "verbose": False,
        }
        start = time.perf_counter()
        found = mrcal.optimize(**problem)
        seconds.append(time.perf_counter() - start)
    residuals = np.asarray(found["x"])[: 2 * m[..., 0].size]
    rms = float(np.sqrt((residuals**2).sum() / m[..., 0].size))
    print(json.dumps({"rms": rms, "seconds": seconds[1:]}))


if __name__ == "__main__":
    main()
