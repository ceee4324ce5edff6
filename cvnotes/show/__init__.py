"""Figures on axes, scenes in space and explorations with sliders, for all chapters."""

from cvnotes.show.axes import panels
from cvnotes.show.banner import one_corner
from cvnotes.show.explorations import explore, pull_points
from cvnotes.show.figures.calibration import draw_cube
from cvnotes.show.figures.ideas import draw_meanings
from cvnotes.show.figures.images import draw_corners, draw_image, draw_points
from cvnotes.show.figures.lines import draw_lines, draw_segments
from cvnotes.show.links import chain
from cvnotes.show.picture import Picture, show
from cvnotes.show.projects import eight_projects, exercise_map
from cvnotes.show.space.camera_shapes import camera_shapes, ray_shapes
from cvnotes.show.space.shapes import (
    Faces,
    Label,
    Lines,
    Photo,
    axes_shapes,
    scene_shapes,
    target_shapes,
)
from cvnotes.show.space.stills import draw_scene
from cvnotes.show.space.viewer import Viewer, build_scene, export_glb, show_scene
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, LENS, WORLD, colour_of

__all__ = [
    # a picture on the page
    "show", "Picture", "panels", "one_corner",
    # pictures, and what is drawn into them
    "draw_image", "draw_points", "draw_corners", "draw_lines", "draw_segments",
    # the colours
    "draw_meanings",
    # chapter 7: its strip, a cube on the board
    "chain", "draw_cube",
    # the further exercises
    "eight_projects", "exercise_map",
    # in space
    "draw_scene", "build_scene", "show_scene", "Viewer", "export_glb", "axes_shapes",
    "target_shapes", "scene_shapes", "camera_shapes", "ray_shapes", "Faces", "Lines", "Photo",
    "Label", "colour_of",
    # colours with a meaning
    "WORLD", "CAMERA", "IDEAL", "LENS", "ESTIMATED",
    # an idea with sliders, and a photograph with points to be pulled
    "explore", "pull_points",
]  # fmt: skip
