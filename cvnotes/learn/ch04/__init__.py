"""Exercises of chapter 4, lens distortion: through the lens, and back."""

from cvnotes.learn.ch04.corner_shift import SHIFT
from cvnotes.learn.ch04.distort import DISTORT
from cvnotes.learn.ch04.fold_radius import FOLD
from cvnotes.learn.ch04.form_image import FORM
from cvnotes.learn.ch04.inverse_radius import INVERSE
from cvnotes.learn.ch04.undistort import UNDISTORT

EXERCISES = (DISTORT, UNDISTORT, FOLD, FORM, SHIFT, INVERSE)
