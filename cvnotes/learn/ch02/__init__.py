"""Exercises of chapter 2, vanishing points: where directions are seen, and what that tells."""
