"""Image formation and camera calibration, after the course notes.

Each module is a section of the notes; import what a section needs from its own module,
for example ``from cvnotes.camera.lens import Lens``.
"""

__version__ = "0.1.0"
