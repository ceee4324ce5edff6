"""Photographs read; cameras written and read, in our format and in those of others."""

from cvnotes.base.writing import write_whole
from cvnotes.files.cameras import read_camera, read_camera_info, read_rig, write_camera
from cvnotes.files.exchange import CameraInfo, lens_from_opencv, ros_yaml
from cvnotes.files.photos import Photo, list_photos, open_photos, read_photo, read_photos
from cvnotes.files.reasons import Reason, Rejected

__all__ = [
    "read_photo",
    "read_photos",
    "list_photos",
    "open_photos",
    "Photo",
    "Reason",
    "Rejected",
    "read_camera",
    "write_camera",
    "read_camera_info",
    "ros_yaml",
    "read_rig",
    "CameraInfo",
    "lens_from_opencv",
    "write_whole",
]
