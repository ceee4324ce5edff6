"""Exercises of chapter 8, image warping: between the pixels, backwards, and two cameras."""

from cvnotes.learn.ch08.backward_warp import BACKWARD
from cvnotes.learn.ch08.bilinear import BILINEAR
from cvnotes.learn.ch08.count_holes import HOLES
from cvnotes.learn.ch08.depth import DEPTH
from cvnotes.learn.ch08.how_far import FAR
from cvnotes.learn.ch08.rectifying_rotation import RECTIFY
from cvnotes.learn.ch08.undistortion_map import UNDISTORTION

EXERCISES = (BILINEAR, BACKWARD, HOLES, UNDISTORTION, RECTIFY, DEPTH, FAR)
