"""Photographs read, cameras and calibrations written and read, in our format and in others'."""

from cvnotes.files.cameras import (
    read_camera,
    read_camera_info,
    write_camera,
    write_camera_info,
)
from cvnotes.files.exchange import CameraInfo, lens_from_opencv, opencv_coefficients
from cvnotes.files.photos import (
    Photo,
    Rejected,
    list_photos,
    open_photos,
    read_photo,
    read_photos,
)
from cvnotes.files.results import read_calibration, write_calibration
from cvnotes.files.writing import write_whole

__all__ = [
    "CameraInfo",
    "Photo",
    "Rejected",
    "lens_from_opencv",
    "list_photos",
    "open_photos",
    "opencv_coefficients",
    "read_calibration",
    "read_camera",
    "read_camera_info",
    "read_photo",
    "read_photos",
    "write_calibration",
    "write_camera",
    "write_camera_info",
    "write_whole",
]
