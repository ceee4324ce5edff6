"""Exercises of chapter 5, calibration targets: the board, its corners, and which one is first."""

from cvnotes.learn.ch05.board_points import BOARD
from cvnotes.learn.ch05.first_corner import FIRST
from cvnotes.learn.ch05.harris_measure import HARRIS
from cvnotes.learn.ch05.knows_its_origin import ORIGIN
from cvnotes.learn.ch05.saddle_point import SADDLE

EXERCISES = (BOARD, HARRIS, SADDLE, ORIGIN, FIRST)
