"""Exercises of chapter 3, the camera model: sensor, pose, projection, and where it stands."""

from cvnotes.learn.ch03.cam1_from_cam2 import CHAIN
from cvnotes.learn.ch03.camera_centre import CENTRE
from cvnotes.learn.ch03.field_of_view import FIELD
from cvnotes.learn.ch03.intrinsics_from_sensor import INTRINSICS
from cvnotes.learn.ch03.nearest_rotation import NEAREST
from cvnotes.learn.ch03.new_intrinsics import NEW
from cvnotes.learn.ch03.project import PROJECT
from cvnotes.learn.ch03.rq import RQ

EXERCISES = (INTRINSICS, PROJECT, CENTRE, CHAIN, NEW, NEAREST, FIELD, RQ)
