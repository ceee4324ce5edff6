"""Pictures of scenes, as a known camera takes them, and how deep they are.

Every pixel is the mean over its square of what the rays through it meet. A ray in the middle is
enough where nothing happens; where colours change, or an edge passes, many rays are cast. All
rays go through the lens exactly.
"""

from cvnotes.rendering.pictures import depth_map, radiance, render_scene

__all__ = ["depth_map", "radiance", "render_scene"]
