"""An estimate held against the camera that took the pictures."""
