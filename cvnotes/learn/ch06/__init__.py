"""Exercises of chapter 6, the homography: from point pairs to H, and how good it is."""

from cvnotes.learn.ch06.design_matrix import DESIGN
from cvnotes.learn.ch06.dlt import DLT
from cvnotes.learn.ch06.four_points import FOUR
from cvnotes.learn.ch06.geometric_error import GEOMETRIC
from cvnotes.learn.ch06.normaliser import NORMALISER
from cvnotes.learn.ch06.ransac import RANSAC

EXERCISES = (DESIGN, NORMALISER, DLT, FOUR, GEOMETRIC, RANSAC)
