"""Exercises of chapter 3, the camera model: sensor, pose, projection, and where it stands."""
