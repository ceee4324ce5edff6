"""Cameras in the YAML of OpenCV and of ROS, both ways.

Both give the distortion as k1, k2, p1, p2, k3 on pixels whose centres are integers, as we do, so
that nothing is converted; what they cannot hold is refused rather than dropped. The rational model
goes on with k4, k5, k6, the thin prism s1 … s4 and the sensor's tilt; a fisheye has k1 … k4 alone,
and says so by the name that ROS gives it, ``equidistant``.
"""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, FileError, intrinsic_matrix, matrix, numbers, rotation
from cvnotes.base.writing import printable
from cvnotes.camera import AnyLens, Camera, FisheyeLens, Lens, RationalLens
from cvnotes.files.entry import Entry

# What ROS calls the lenses that it and OpenCV know; OpenCV's own files have no name for a model.
_MODELS = tuple(lens.ros_name for lens in (Lens, RationalLens, FisheyeLens))


@dataclass(frozen=True, eq=False)
class CameraInfo:
    """A camera as ROS describes it in a ``camera_info`` file.

    Parameters
    ----------
    camera : Camera
        Sensor, lens and size.
    name : str
        The camera's name.
    rectification : array_like, shape (3, 3)
        Rotation into the rectified frame; the identity unless the camera is one of a stereo pair.
    projection : array_like, shape (3, 4), optional
        Projection of the rectified picture; by default [A|0].

    References
    ----------
    .. [1] ROS, message sensor_msgs/CameraInfo: D, K, R and P.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> CameraInfo(Camera(intrinsics(800, 800, 320, 240))).projection
    array([[800.,   0., 320.,   0.],
           [  0., 800., 240.,   0.],
           [  0.,   0.,   1.,   0.]])
    """

    camera: Camera
    name: str = "camera"
    rectification: Array = field(default_factory=lambda: np.eye(3))
    projection: npt.ArrayLike | None = None

    def __post_init__(self) -> None:
        P = self.camera.A @ np.eye(3, 4) if self.projection is None else self.projection
        object.__setattr__(self, "projection", matrix(P, "projection", 3, 4))
        object.__setattr__(self, "rectification", rotation(self.rectification, "rectification"))


def opencv_yaml(camera: Camera, *, note: str = "") -> str:
    """Spell a camera as ``cv2.FileStorage`` of OpenCV 4 and 5 reads it.

    Raises
    ------
    CvnotesError
        The lens has more than k1 k2 p1 p2 k3, or a distortion centre of its own.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> opencv_yaml(Camera(intrinsics(800, 800, 320, 240))).splitlines()[:3]
    ['%YAML:1.0', '---', 'image_width: 640']
    """
    remark = f"# {printable(note)}\n" if note else ""
    size = f"image_width: {camera.size[0]}\nimage_height: {camera.size[1]}\n"
    skew = "# OpenCV keeps the skew in the matrix but does not use it.\n" if camera.A[0, 1] else ""
    K = opencv_matrix("camera_matrix", camera.A)
    d = camera.lens.opencv_coefficients()
    D = opencv_matrix("distortion_coefficients", d[None])
    # (four numbers could also be k1, k2, p1, p2)
    model = f"distortion_model: {camera.lens.ros_name}\n" if d.size == 4 else ""
    return f"%YAML:1.0\n---\n{remark}{size}{skew}{K}{model}{D}"


def ros_yaml(info: CameraInfo, *, note: str = "") -> str:
    """Spell a camera as ROS's camera_info_manager and calibrators read it.

    A note for whoever opens the file goes to its beginning.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> info = CameraInfo(Camera(intrinsics(800, 800, 320, 240)), name="left")
    >>> print(ros_yaml(info).splitlines()[2])
    camera_name: "left"
    """
    if not info.name.isprintable() or set(info.name) & {'"', "\\"}:
        raise CvnotesError(f"name: expected plain text without quotes, got {info.name!r}")
    camera, remark = info.camera, f"# {printable(note)}\n" if note else ""
    return (
        f"{remark}image_width: {camera.size[0]}\nimage_height: {camera.size[1]}\n"
        f'camera_name: "{info.name}"\n'
        + _ros_matrix("camera_matrix", camera.A)
        + f"distortion_model: {camera.lens.ros_name}\n"
        + _ros_matrix("distortion_coefficients", camera.lens.opencv_coefficients()[None])
        + _ros_matrix("rectification_matrix", info.rectification)
        + _ros_matrix("projection_matrix", np.asarray(info.projection))
    )


def camera_info(entry: Entry) -> CameraInfo:
    """Understand the YAML of OpenCV or of ROS; OpenCV's has no name and no rectification."""
    model = entry.get("distortion_model")
    if model is not None and model.text() not in _MODELS:
        ours = ", ".join(_MODELS)
        raise model.error(f"the lens model {model.text()!r} is not one of ours: {ours}")
    name = entry.get("camera_name")
    R, P = entry.get("rectification_matrix"), entry.get("projection_matrix")
    size = (entry["image_width"].whole(), entry["image_height"].whole())
    A, d = _read_matrix(entry["camera_matrix"]), _read_matrix(entry["distortion_coefficients"])
    try:
        # (their four numbers could also be k1, k2, p1, p2: only the name tells)
        fisheye = model is not None and model.text() == FisheyeLens.ros_name
        lens = lens_from_opencv(d.ravel(), fisheye=fisheye)
        return CameraInfo(
            Camera(intrinsic_matrix(A, "camera_matrix"), lens=lens, size=size),
            name.text() if name is not None else "camera",
            _read_matrix(R) if R is not None else np.eye(3),
            _read_matrix(P) if P is not None else None,
        )
    except CvnotesError as error:
        raise FileError(f"{entry.file}: {error}") from error


def lens_from_opencv(coefficients: npt.ArrayLike, *, fisheye: bool = False) -> AnyLens:
    """Make a lens of OpenCV's coefficients.

    Parameters
    ----------
    coefficients : array_like
        4 or 5 (k1, k2, p1, p2[, k3]), or 8, 12 or 14 of the rational model, which make a
        `RationalLens` unless those after k3 are zero.
    fisheye : bool
        They are the k1 … k4 of ``cv2.fisheye``, or of ROS's ``equidistant``.

    Examples
    --------
    >>> lens_from_opencv([-0.25, 0.1, 0.001, 0.0])
    Lens(k=(-0.25, 0.1), p=(0.001, 0.0), centre=(0.0, 0.0))
    >>> lens_from_opencv([0.1, 0.01, 0.0, 0.0], fisheye=True)
    FisheyeLens(k=(0.1, 0.01, 0.0, 0.0))
    """
    d = numbers(coefficients, "coefficients").reshape(-1)
    # OpenCV's files do not name a model: how many numbers there are tells all but the fisheye
    if fisheye:
        if d.size != 4:
            raise CvnotesError(f"coefficients: a fisheye has 4 (k1 … k4), got {d.size}")
        return FisheyeLens(tuple(d))
    if d.size not in (4, 5, 8, 12, 14):
        raise CvnotesError(
            "coefficients: expected 4 or 5 coefficients (k1, k2, p1, p2, k3), or the 8, 12 or 14 "
            f"of the rational model, got {d.size}"
        )
    if d[5:].any():
        d = np.concatenate([d, np.zeros(14 - d.size)])
        return RationalLens((*d[:2], *d[4:8]), (d[2], d[3]), tuple(d[8:12]), (d[12], d[13]))
    k = d[[0, 1, 4]] if d[4:5].any() else d[:2]
    return Lens(k=tuple(k), p=(d[2], d[3]))


def _number(x: float) -> str:
    """Spell a float exactly; PyYAML takes 1e-05 for text, so the mantissa always has a point."""
    mantissa, e, exponent = repr(float(x)).partition("e")
    return (mantissa if "." in mantissa else mantissa + ".0") + e + exponent


def _rows(M: Array) -> str:
    """Spell the numbers of a matrix, a row per line."""
    return ",\n      ".join(", ".join(_number(x) for x in row) for row in M)


def opencv_matrix(key: str, M: Array) -> str:
    """Spell a matrix as ``cv2.FileStorage`` does."""
    rows, cols = M.shape
    head = f"{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {cols}\n   dt: d\n"
    return f"{head}   data: [ {_rows(M)} ]\n"


def _ros_matrix(key: str, M: Array) -> str:
    return f"{key}:\n  rows: {M.shape[0]}\n  cols: {M.shape[1]}\n  data: [{_rows(M)}]\n"


def _read_matrix(entry: Entry) -> Array:
    """Read {rows, cols, data} or OpenCV 5's {sizes, data}."""
    sizes = entry.get("sizes")
    if sizes is not None:
        shape = [item.whole() for item in sizes]
    else:
        shape = [entry["rows"].whole(), entry["cols"].whole()]
    data = entry["data"].array(None)
    if len(shape) > 2:
        raise entry.error(f"expected a matrix of rows and columns, got {len(shape)} sizes")
    if min(shape) < 0 or data.size != np.prod(shape, dtype=object):
        raise entry.error(f"expected {'×'.join(map(str, shape))} values in data, got {data.size}")
    return data.reshape(shape)
