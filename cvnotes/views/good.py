"""The set of views that calibrates a camera well."""

import numpy as np

from cvnotes.camera import Camera
from cvnotes.errors import Array, CvnotesError, DegenerateError, numbers
from cvnotes.faces import Target
from cvnotes.placing import every_face_seen, facing, hold_at
from cvnotes.views.turns import TILT, all_over, all_sides, guard, turned


def good_views(
    target: Target,
    camera: Camera,
    n: int,
    *,
    rng: np.random.Generator,
    tilt: tuple[float, float] = TILT,
) -> Array:
    """Hold a target as one should: tilted to all sides, all over the picture, large.

    Parameters
    ----------
    target : Target
        What is held; anything with ``faces``, none of which turns away.
    camera : Camera
        Who looks; its own pose does not matter.
    n : int
        How many views. Three suffice for a calibration, ten or more make a good one.
    rng : numpy.random.Generator
        Where the poses come from.
    tilt : (least, most)
        Angle in radians by which the target turns away from facing the camera.

    Returns
    -------
    ndarray, shape (n, 4, 4)
        Poses G of the target.

    Raises
    ------
    DegenerateError
        The target cannot be seen whole like this.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.targets import Chessboard
    >>> camera = Camera(intrinsics(800, 804, 325, 238))
    >>> G = good_views(Chessboard((9, 6), 25.0), camera, 10, rng=np.random.default_rng(1))
    >>> tilts = np.degrees(np.arccos(G[:, 2, 2]))
    >>> bool((tilts > 20).all() and (tilts < 45).all())
    True
    """
    guard(target, camera, n, rng)
    angles = numbers(tilt, "tilt")
    if angles.shape != (2,) or not 0 <= angles[0] <= angles[1] < np.pi / 2:
        raise CvnotesError(
            f"tilt: expected (least, most) in radians, between 0 and π/2, got {angles.tolist()}"
        )
    least, most = angles.tolist()
    views = []
    for towards, aim in zip(all_sides(n, rng), all_over(camera, n, rng), strict=True):
        for _ in range(100):
            R = turned(np.array([towards]), rng.uniform(least, most, 1), rng)[0] @ facing(target)
            G = hold_at(target, camera, R, aim, rng.uniform(1.0, 1.3))
            if every_face_seen(target, G):
                break
            towards = rng.uniform(0, 2 * np.pi)
        else:
            raise DegenerateError("tilted like this, a face of the target is hidden; tilt it less")
        views.append(G)
    return np.stack(views)
