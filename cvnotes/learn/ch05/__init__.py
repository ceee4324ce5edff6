"""Exercises of chapter 5, calibration targets: the board, its corners, and which one is first."""
