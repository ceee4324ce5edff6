"""Time Ceres' refinement as COLMAP runs it: ``python3 ceres_refinement.py FILE.npz``.

In a Python that has pycolmap. The board's points are held, camera and poses are refined, with
COLMAP's own derivatives. The file and what is printed are those of ``mrcal_refinement.py``.
"""

import json
import sys
import time

import numpy as np
import pycolmap


def scene(given: dict[str, np.ndarray]) -> pycolmap.Reconstruction:
    """Return the start: one camera, an image for each view, the board's points."""
    found = pycolmap.Reconstruction()
    width, height = given["size"].tolist()
    camera = pycolmap.Camera.create_from_model_name(1, "OPENCV", 1.0, width, height)
    camera.params = given["intrinsics"]
    found.add_camera_with_trivial_rig(camera)
    W = given["W"].reshape(-1, 2)
    for i, point in enumerate(W, start=1):
        xyz = np.append(point, 0.0)
        found.add_point3D_with_id(i, pycolmap.Point3D(xyz=xyz))
    for i, (m, frame) in enumerate(zip(given["m"], given["frames"], strict=True), start=1):
        image = pycolmap.Image(
            name=str(i), image_id=i, camera_id=1, keypoints=m.reshape(-1, 2).astype(float)
        )
        rotation = pycolmap.Rotation3d(frame[:3])
        found.add_image_with_trivial_frame(image, pycolmap.Rigid3d(rotation, frame[3:]))
        for j in range(len(W)):
            found.add_observation(j + 1, pycolmap.TrackElement(i, j))
    return found


def main() -> None:
    given = dict(np.load(sys.argv[1]))
    options = pycolmap.BundleAdjustmentOptions()
    options.refine_principal_point, options.refine_points3D = True, False
    options.print_summary = False
    options.ceres.solver_options.function_tolerance = 1e-12
    config = pycolmap.BundleAdjustmentConfig()
    for i in range(1, len(given["m"]) + 1):
        config.add_image(i)
    for j in range(1, given["W"].size // 2 + 1):
        config.add_constant_point(j)
    seconds = []
    for _ in range(int(given["repeats"]) + 1):
        start = scene(given)
        adjuster = pycolmap.create_default_ceres_bundle_adjuster(options, config, start)
        begin = time.perf_counter()
        summary = adjuster.solve()
        seconds.append(time.perf_counter() - begin)
    rms = float(np.sqrt(2 * summary.ceres_summary.final_cost / given["m"][..., 0].size))
    print(json.dumps({"rms": rms, "seconds": seconds[1:]}))


if __name__ == "__main__":
    main()
