"""Exercises of chapter 9, your own camera: residuals, error bars, judgement, the whole pipeline."""

from cvnotes.learn.ch09.error_bars import ERRORS
from cvnotes.learn.ch09.jackknife import JACKKNIFE
from cvnotes.learn.ch09.own_camera import OWN
from cvnotes.learn.ch09.pipeline import PIPELINE
from cvnotes.learn.ch09.residuals import RESIDUALS
from cvnotes.learn.ch09.which_to_trust import TRUST

EXERCISES = (RESIDUALS, ERRORS, TRUST, OWN, PIPELINE, JACKKNIFE)
