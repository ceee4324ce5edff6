"""Image formation and camera calibration, after the course notes.

Each wing is a chapter; import what a chapter needs from the face of its wing, for example
``from cvnotes.camera import Lens``. ``docs/house.md`` is the plan.
"""

__version__ = "0.1.0"
