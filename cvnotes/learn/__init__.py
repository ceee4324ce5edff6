"""What makes it a course: exercises that answer, estimates held against the truth."""

from cvnotes.learn.cases.pictures import board_picture, rails_picture, stereo_pictures
from cvnotes.learn.exercises import EXERCISES, add_exercises, check, hint, progress, solution
from cvnotes.learn.guesses import answer, guess
from cvnotes.learn.personal import personal_camera
from cvnotes.learn.truth.verdict import Verdict, verdict
from cvnotes.learn.truth.verification import NotVerified, verify

__all__ = [
    "check",
    "hint",
    "solution",
    "progress",
    "guess",
    "answer",
    "EXERCISES",
    "add_exercises",
    "verify",
    "NotVerified",
    "verdict",
    "Verdict",
    "personal_camera",
    "board_picture",
    "rails_picture",
    "stereo_pictures",
]
