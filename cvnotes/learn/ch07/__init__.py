"""Exercises of chapter 7, Zhang's method: from homographies to the camera, its poses, its lens."""
