"""Exercises of chapter 2, vanishing points: where directions are seen, and what that tells."""

from cvnotes.learn.ch02.focal_from_vanishing_points import FOCAL
from cvnotes.learn.ch02.horizon import HORIZON
from cvnotes.learn.ch02.person_height import PERSON
from cvnotes.learn.ch02.vanishing_point import VANISHING
from cvnotes.learn.ch02.where_the_rails_meet import RAILS

EXERCISES = (VANISHING, HORIZON, FOCAL, RAILS, PERSON)
