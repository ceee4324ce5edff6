"""Exercises of chapter 1, projective space: lift and drop, lines and where they meet."""

from cvnotes.learn.ch01.drop import DROP
from cvnotes.learn.ch01.lift import LIFT
from cvnotes.learn.ch01.line_through import LINE
from cvnotes.learn.ch01.measure_along import MEASURE
from cvnotes.learn.ch01.meet import MEET
from cvnotes.learn.ch01.same_points import SAME

EXERCISES = (LIFT, DROP, LINE, MEET, SAME, MEASURE)
