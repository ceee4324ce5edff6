"""Exercises of chapter 4, lens distortion: through the lens, and back."""
