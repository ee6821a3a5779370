"""Reader of STL, OBJ, PLY and OFF files for the viewer, by trimesh."""

from __future__ import annotations

import io
import logging
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.read_budget import READ_BUDGET, afford
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.maths.colour import linear_light
from mimics_app.world.content.materials.material import Material, TextureData
from mimics_app.world.content.meshes.mesh import FARTHEST, MeshData
from mimics_app.world.content.meshes.shading_groups import shaded_mesh
from mimics_app.world.content.world import World
from mimics_app.world.files.reading.file_bytes import read_bytes
from mimics_app.world.graph.scene_node import SceneNode

if TYPE_CHECKING:
    import trimesh

__all__ = ["MESH_SUFFIXES", "add_mesh_file"]

MESH_SUFFIXES = (".stl", ".obj", ".ply", ".off")
"""Supported endings of file names."""

_MAX_TRIANGLES = 20_000_000
_GREY = (0.62, 0.62, 0.64, 1.0)


def add_mesh_file(world: World, node: SceneNode, path: Path) -> None:
    """Add the bodies of a mesh file below a node; its unit is taken as the metre.

    Raises:
        SceneError: it cannot be read, or has no triangle.
    """
    for number, (name, body) in enumerate(_bodies(path)):
        key = f"{path.stem}#{number}"
        mesh, material = _mesh(path, body), _material(path, key, body, world)
        world.replace_mesh(key, mesh)
        world.set_material(material)
        node.create_child(name if name not in world else "").create_entity(key, key)


def _bodies(path: Path) -> list[tuple[str, trimesh.Trimesh]]:
    """Return every body of a file, in the file's own frame."""
    import trimesh

    data = read_bytes(path, str(path), READ_BUDGET)
    logging.getLogger("trimesh").setLevel(logging.CRITICAL + 1)  # its faults are reported below, in one line
    try:
        try:
            loaded = _load(path, data)
        except ImportError:  # the library that guesses an encoding other than UTF-8 is not installed
            loaded = _load(path, data.decode("utf-8", "replace").encode())
        bodies = [(str(name), loaded.geometry[name]) for name in loaded.geometry]
    except MemoryError:
        raise SceneError(Issue(str(path), "", "does not fit into memory")) from None
    except Exception as error:  # each of its readers has its own errors
        what = f"is damaged or not a {path.suffix[1:].upper()} file"
        if not isinstance(
            error, AttributeError | LookupError | TypeError
        ):  # these speak of the reader, not of the file
            what += f": {' '.join(str(error).split())[:160] or type(error).__name__}"
        raise SceneError(Issue(str(path), "", what)) from error
    found = [(name, body) for name, body in bodies if isinstance(body, trimesh.Trimesh) and len(body.faces)]
    if not found:
        raise SceneError(Issue(str(path), "", "has no triangle"))
    if sum(len(body.faces) for _, body in found) > _MAX_TRIANGLES:
        raise SceneError(Issue(str(path), "", f"has more than {_MAX_TRIANGLES} triangles"))
    return found


def _load(path: Path, data: bytes) -> trimesh.Scene:
    import trimesh

    class Beside(trimesh.resolvers.FilePathResolver):
        """Gives the library what a mesh names beside it: regular files of its folder, materials and pictures."""

        def get(self, name: str) -> bytes:
            place = self.absolute(name.strip().lstrip("/"))
            return read_regular(place if place.exists() else self.absolute(os.path.split(name)[-1]), READ_BUDGET)

    kind = path.suffix[1:].lower()
    beside = Beside(os.fspath(path))
    return trimesh.load_scene(io.BytesIO(data), file_type=kind, resolver=beside, process=False)


def _mesh(path: Path, body: trimesh.Trimesh) -> MeshData:
    vertices, faces = np.asarray(body.vertices, np.float64), np.asarray(body.faces, np.int64)
    if not (np.abs(vertices) < FARTHEST).all() or faces.min(initial=0) < 0 or faces.max(initial=0) >= len(vertices):
        raise SceneError(Issue(str(path), "", "has vertices or indices out of range"))
    uvs = getattr(body.visual, "uv", None)
    colours = _vertex_colours(body)
    if uvs is None or len(uvs) != len(vertices):
        return shaded_mesh(vertices, faces, colours)
    flipped = np.asarray(uvs, np.float32)[:, :2] * (1.0, -1.0) + (0.0, 1.0)  # v = 0 is at the top here
    normals = np.asarray(body.vertex_normals, np.float32)
    return MeshData(vertices.astype(np.float32), normals, faces.reshape(-1).astype(np.uint32), flipped.astype("f4"))


def _vertex_colours(body: trimesh.Trimesh) -> NDArray[np.float32] | None:
    """Return linear RGBA of the vertices, where the file has vertex colours."""
    visual: Any = body.visual
    if getattr(visual, "kind", None) != "vertex":
        return None
    values = np.asarray(visual.vertex_colors, np.float32) / 255.0
    return np.concatenate([linear_light(values[:, :3]), values[:, 3:]], axis=1).astype(np.float32)


def _material(path: Path, key: str, body: trimesh.Trimesh, world: World) -> Material:
    """Return a material with the file's texture, else its colour, else plain grey."""
    given: Any = getattr(body.visual, "material", None)
    picture = getattr(given, "image", None) or getattr(given, "baseColorTexture", None)
    if picture is not None:
        afford(str(path), "", 4 * picture.width * picture.height, "give its texture fewer pixels")
        world.textures[key] = TextureData(np.array(picture.convert("RGBA"), np.uint8))
        return Material(key, base_colour=(1.0, 1.0, 1.0, 1.0), base_texture=key, double_sided=True)
    if getattr(body.visual, "kind", None) == "vertex":
        return Material(key, base_colour=(1.0, 1.0, 1.0, 1.0), double_sided=True)
    colour = getattr(given, "main_color", None) if getattr(body.visual, "kind", None) == "texture" else None
    if colour is None:
        return Material(key, base_colour=_GREY, roughness=0.5, double_sided=True)
    red, green, blue, alpha = ((float(value) / 255.0) ** 2.2 for value in colour)
    return Material(key, base_colour=(red, green, blue, alpha ** (1 / 2.2)), double_sided=True)
