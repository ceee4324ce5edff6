"""Exercises of chapter 11, the board we believed: two kinds of standard deviations."""
