"""Worlds to photograph: boards, rails, a room, a corridor (notes 2b.1 and 2b.4).

Lengths are millimetres. The WRF of a place is that of a camera without a pose, held at eye
height: x to the right, y down, z ahead, the ground at y = 1600. So
``render_scene(rails(), Camera(A))`` is a picture.
"""

from cvnotes.scenes.places import GROUND, Span, blocks, corridor, rails, room
from cvnotes.scenes.things import from_trimesh, target_scene

__all__ = [
    "GROUND",
    "Span",
    "blocks",
    "corridor",
    "from_trimesh",
    "rails",
    "room",
    "target_scene",
]
