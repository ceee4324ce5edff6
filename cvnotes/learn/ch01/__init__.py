"""Exercises of chapter 1, projective space: lift and drop, lines and where they meet."""
