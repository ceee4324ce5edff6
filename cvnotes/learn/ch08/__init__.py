"""Exercises of chapter 8, image warping: between the pixels, backwards, and without a lens."""
