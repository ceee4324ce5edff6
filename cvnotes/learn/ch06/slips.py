"""The mistakes that every way to a homography shares."""

from cvnotes.homography import dlt
from cvnotes.learn.cases.cameras import affine_fit
from cvnotes.tutor.checker.exercise import Misconception

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
Y_BEFORE_X = Misconception(
    "x and y exchanged",
    "Your H expects (y, x): its first column belongs to x.",
    lambda src, dst: dlt(src[:, ::-1], dst),
)
AFFINE = Misconception(
    "an affine map",
    "The last row of your H is (0, 0, 1): an affine map keeps parallels parallel, which a camera "
    "does not.",
    affine_fit,
)
