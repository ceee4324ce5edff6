"""Pictures from known cameras: boards and scenes, rendered from the exact model."""

from cvnotes.pictures import course
from cvnotes.pictures.boards import clutter, render
from cvnotes.pictures.exposure import compress, expose, gaussian_blur, motion_blur
from cvnotes.pictures.meshes import Scene
from cvnotes.pictures.placing import facing, hold_at
from cvnotes.pictures.scene_render import depth_map, radiance, render_scene
from cvnotes.pictures.scenes import blocks, corridor, rails, room, target_scene
from cvnotes.pictures.views import (
    centre_only_views,
    fronto_parallel_views,
    good_views,
    nearly_parallel_views,
    one_axis_views,
    pure_translation_views,
    repeated_views,
)

__all__ = [
    "course",
    "render",
    "clutter",
    "render_scene",
    "radiance",
    "depth_map",
    "Scene",
    "rails",
    "blocks",
    "corridor",
    "room",
    "target_scene",
    "good_views",
    "fronto_parallel_views",
    "pure_translation_views",
    "nearly_parallel_views",
    "one_axis_views",
    "centre_only_views",
    "repeated_views",
    "facing",
    "hold_at",
    "expose",
    "gaussian_blur",
    "motion_blur",
    "compress",
]
