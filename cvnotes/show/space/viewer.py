"""3-D figures to turn in the hand, as GLB files.

The course's frames have y down and z ahead, OpenGL's cameras y up and z behind; `GL_FROM_CV`, half
a turn about x, lies between the two and is its own inverse.
"""

import os
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.show.space.directions import sheet, towards
from cvnotes.show.space.shapes import Faces, Label, Lines, Photo, Shape, extent

GL_FROM_CV = np.diag([1.0, -1.0, -1.0, 1.0])
# Colours have meanings, so they must be seen on the far side of the viewer's lamp too.
_GLOW = 0.7
_ANGLE = 45.0  # degrees that a viewer sees from top to bottom
_FRAME = 1.2  # its width by its height, at least
_ROOM = 1.03  # around the scene
# The letters of axes as strokes on a unit square, x to the right and y down; files hold no type.
_STROKES = {
    "X": (((0, 0), (1, 1)), ((1, 0), (0, 1))),
    "Y": (((0, 0), (0.5, 0.5)), ((1, 0), (0.5, 0.5)), ((0.5, 0.5), (0.5, 1))),
    "Z": (((0, 0), (1, 0)), ((1, 0), (0, 1)), ((0, 1), (1, 1))),
    "x": (((0, 0.3), (0.7, 1)), ((0.7, 0.3), (0, 1))),
    "y": (((0, 0.3), (0.35, 0.95)), ((0.7, 0.3), (0.1, 1.4))),
    "z": (((0, 0.3), (0.7, 0.3)), ((0.7, 0.3), (0, 1)), ((0, 1), (0.7, 1))),
}
_LETTER = 1 / 40  # of the scene


def build_scene(*shapes: Shape, view: tuple[float, float] | None = (20.0, -40.0)) -> Any:
    """Put shapes into a ``trimesh.Scene``, which `export_glb` writes.

    Parameters
    ----------
    *shapes : Faces, Lines, Photo or Label
        What the functions of `cvnotes.show.space.shapes` give. Of labels only the letters of axes
        are shown, facing the view; the others are left to the still.
    view : (elevation, azimuth)
        Where a viewer first sees it from, in degrees, as for `draw_scene`; None leaves that to it.

    Returns
    -------
    trimesh.Scene
        Upright in viewers, whose y points up: y and z are turned by `GL_FROM_CV`.

    Examples
    --------
    >>> from cvnotes.show import axes_shapes
    >>> list(build_scene(*axes_shapes()).geometry)
    ['WRF axes', 'X', 'Y', 'Z']
    """
    import trimesh
    from matplotlib.colors import to_rgba

    scene, reach = trimesh.Scene(), extent(*shapes)
    thickness = reach / 500  # of lines
    for shape in shapes:
        match shape:
            case Faces(name, corners, colours):
                meshes = _by_colour(corners, colours)
            case Lines(name, ends, colour, width):
                meshes = [_mesh(_bars(ends, thickness * width), np.array(to_rgba(colour)))]
            case Photo(name, corners, image):
                meshes = [_textured(corners, image)]
            case Label(name, at, colour, way) if name in _STROKES:
                at = at + 1.2 * _LETTER * reach * way / (np.linalg.norm(way) or 1)
                strokes = at + _LETTER * reach * _facing(_STROKES[name], view or (0, -90))
                meshes = [_mesh(_bars(strokes, 2 * thickness), np.array(to_rgba(colour)))]
            case Label():
                continue
        for mesh in meshes:
            mesh.apply_transform(GL_FROM_CV)
            # Names must differ: one colour of a shape, or one of two cameras, would hide another.
            unique = name if name not in scene.geometry else f"{name} ({len(scene.geometry)})"
            scene.add_geometry(mesh, node_name=unique, geom_name=unique)
    if scene.geometry and view is not None:
        scene.camera = trimesh.scene.Camera("camera", fov=(_FRAME * _ANGLE, _ANGLE))
        scene.camera_transform = _seen_from(view, scene)
    return scene


def _facing(strokes: Any, view: tuple[float, float]) -> Array:
    """Turn strokes on the unit square (k, 2, 2) about its middle to be read from a view."""
    return np.asarray((np.array(strokes) - 0.5) @ sheet(view))


def _seen_from(view: tuple[float, float], scene: Any) -> Array:
    """Place OpenGL's camera in a view of the scene's middle, just where all of it is seen."""
    right, down = sheet(view)
    way = GL_FROM_CV[:3, :3] @ towards(view)
    R = np.stack([GL_FROM_CV[:3, :3] @ right, -GL_FROM_CV[:3, :3] @ down, way], axis=1)
    middle = scene.bounds.mean(axis=0)
    corners = np.concatenate([mesh.vertices for mesh in scene.dump()]) - middle
    x, y, z = (corners @ R).T
    tangent = np.tan(np.radians(_ANGLE / 2))
    away = (z + np.maximum(np.abs(x) / _FRAME, np.abs(y)) / tangent).max()
    # Between a near and a far that are not further apart, depths are told apart: planes that cross
    # meet in a line and do not speckle.
    scene.camera.z_near, scene.camera.z_far = 0.02 * away, 20 * away
    G = np.eye(4)
    G[:3, :3], G[:3, 3] = R, middle + _ROOM * away * way
    return G


def export_glb(scene: Any, path: str | os.PathLike[str]) -> None:
    """Write a ``trimesh.Scene`` as GLB, the same bytes every time.

    The file opens offline in any viewer: everything is inside, no address outside.

    Examples
    --------
    >>> import tempfile
    >>> from cvnotes.show import axes_shapes
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     export_glb(build_scene(*axes_shapes()), f"{folder}/axes.glb")
    ...     Path(folder, "axes.glb").read_bytes()[:4]
    b'glTF'
    """
    from trimesh.exchange.gltf import export_glb as encode

    def sign(tree: dict[str, Any]) -> None:
        tree["asset"]["generator"] = "cvnotes"

    Path(path).write_bytes(encode(scene, tree_postprocessor=sign))


def _by_colour(corners: Array, colours: Array) -> list[Any]:
    """Make a mesh of the faces of each colour."""
    kinds, which = np.unique(colours, axis=0, return_inverse=True)
    return [_mesh(corners[which.ravel() == i], rgba) for i, rgba in enumerate(kinds)]


def _mesh(corners: Array, rgba: Array) -> Any:
    """Make a mesh of faces with three or four corners (m, 3 or 4, 3), all of one colour."""
    import trimesh

    m, n = corners.shape[:2]
    fan = np.array([[0, i, i + 1] for i in range(1, n - 1)])
    triangles = (n * np.arange(m)[:, None, None] + fan).reshape(-1, 3)
    visual = trimesh.visual.TextureVisuals(material=_paint(rgba))
    return trimesh.Trimesh(corners.reshape(-1, 3), triangles, visual=visual, process=False)


def _textured(corners: Array, image: npt.NDArray[np.uint8]) -> Any:
    """Make a rectangle with a picture on it."""
    import trimesh
    from PIL import Image

    uv = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], dtype=float)  # v points up in textures
    picture = Image.fromarray(image)
    paint = _paint(np.ones(4), baseColorTexture=picture, emissiveTexture=picture)
    visual = trimesh.visual.TextureVisuals(uv=uv, material=paint)
    return trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], visual=visual, process=False)


def _paint(rgba: Array, **kwargs: Any) -> Any:
    """Make a dull material, visible from both sides; without it viewers assume dark metal."""
    from trimesh.visual.material import PBRMaterial

    lit = np.append((1 - _GLOW) * rgba[:3], rgba[3])
    return PBRMaterial(
        baseColorFactor=np.rint(255 * lit).astype(np.uint8),
        emissiveFactor=_GLOW * rgba[:3],
        metallicFactor=0.0,
        roughnessFactor=1.0,
        doubleSided=True,
        alphaMode="OPAQUE" if rgba[3] == 1 else "BLEND",
        **kwargs,
    )


def _bars(ends: Array, thickness: float) -> Array:
    """Return segments (k, 2, 3) a body: the four long sides (4 k, 4, 3) of square bars."""
    way = ends[:, 1] - ends[:, 0]
    way = way / np.linalg.norm(way, axis=-1, keepdims=True)
    # Any direction that is not along the segment: the axis that it follows least.
    across = np.cross(way, np.eye(3)[np.abs(way).argmin(axis=-1)])
    across /= np.linalg.norm(across, axis=-1, keepdims=True)
    other = np.cross(way, across)
    rim = np.stack([across + other, other - across, -across - other, across - other], axis=1)
    near, far = (ends[:, i : i + 1] + rim * thickness / 2 for i in (0, 1))
    sides = np.stack([near, np.roll(near, -1, 1), np.roll(far, -1, 1), far], axis=2)
    return sides.reshape(-1, 4, 3)
