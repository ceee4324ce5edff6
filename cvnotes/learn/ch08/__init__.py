"""Exercises of chapter 8, image warping: between the pixels, backwards, and two cameras."""
