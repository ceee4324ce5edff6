"""The mistakes that every way to a homography shares."""

from cvnotes.homography import dlt
from cvnotes.learn.checker.exercise import Misconception

EXCHANGED = Misconception(
    "src and dst exchanged",
    "Your H maps dst to src: the picture to the board. Did you exchange src and dst?",
    lambda src, dst: dlt(dst, src),
)
TRANSPOSED = Misconception(
    "transposed",
    "Your H is the transpose of the right one: h holds the rows of H one after the other.",
    lambda src, dst: dlt(src, dst).T,
)
V_BEFORE_U = Misconception(
    "u and v exchanged",
    "Your H gives (v, u): the first row of H belongs to u.",
    lambda src, dst: dlt(src, dst[:, ::-1]),
)
