"""Pictures from known cameras, for all chapters: boards and scenes by the exact model."""

from cvnotes.pictures import course
from cvnotes.pictures.antialiasing import pixel_centres
from cvnotes.pictures.boards import clutter, render
from cvnotes.pictures.exposure import compress, expose, gaussian_blur
from cvnotes.pictures.meshes import Scene
from cvnotes.pictures.placing import facing, hold_at
from cvnotes.pictures.posters import chart_room, poster_room
from cvnotes.pictures.scene_render import depth_map, radiance, render_scene
from cvnotes.pictures.scenes import blocks, corridor, desk, rails, room, room_with, target_scene
from cvnotes.pictures.views import covering_views, fronto_parallel_views, good_views

__all__ = [
    "course",
    # boards, and what a scene looks like
    "render",
    "clutter",
    "render_scene",
    "radiance",
    "depth_map",
    "Scene",
    # places, in the order of the chapters
    "rails",
    "blocks",
    "corridor",
    "room",
    "room_with",
    "chart_room",
    "poster_room",
    "desk",
    "target_scene",
    # sets of poses: one that is good, and those of chapter 7 that are not
    "good_views",
    "covering_views",
    "fronto_parallel_views",
    # one pose
    "facing",
    "hold_at",
    # from light to grey levels
    "pixel_centres",
    "expose",
    "gaussian_blur",
    "compress",
]
