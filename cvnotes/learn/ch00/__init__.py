"""Exercise of the first page: how much a row of corners bends."""

from cvnotes.learn.ch00.bend import BEND

EXERCISES = (BEND,)
