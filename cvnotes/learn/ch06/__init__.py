"""Exercises of chapter 6, the homography: from point pairs to H, and how good it is."""
