"""Scenes of triangles with flat or checkered faces, in the WRF.

A scene is arrays: who wants another one computes it. Textures are checkers only, because their
corners are known exactly; `uv` are measured in squares, so that the square (i, j) of the checker
covers i ≤ u < i + 1 and j ≤ v < j + 1, and has the first colour where i + j is even.
"""

from cvnotes.meshes.building import box, join, quads
from cvnotes.meshes.scene import Colour, Scene, Surroundings, Triangles

__all__ = ["Colour", "Scene", "Surroundings", "Triangles", "box", "join", "quads"]
