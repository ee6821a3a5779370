"""Content of the viewer: a scene, a glTF model or another mesh file, as a world with its notes."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.world.content.extent import Extent, world_extent
from mimics_app.world.content.world import World
from mimics_app.world.files.gltf.gltf_document import GLTF_SUFFIXES
from mimics_app.world.files.mesh_file import MESH_SUFFIXES, add_mesh_file
from mimics_app.world.files.scene.model_world import read_model
from mimics_app.world.files.scene.prefab import ModelPrefab
from mimics_app.world.graph.scene_node import SceneNode

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["MODEL_SUFFIXES", "Shown", "Up", "open_shown"]

Up = Literal["y", "z"]
"""Upward axis of a mesh file; scenes and glTF files define their own."""

MODEL_SUFFIXES = (*GLTF_SUFFIXES, *MESH_SUFFIXES)
"""Extensions of model files."""

_QUARTER = (-(0.5**0.5), 0.0, 0.0, 0.5**0.5)
"""Rotation from +z up to +y up, quaternion xyzw."""


@dataclass(eq=False)
class Shown:
    """A model or scene to show.

    Attributes:
        path: The file.
        world: The world with its contents, updated.
        scene: The scene, or None for a model.
        stand: Node of a model; None for a scene.
        notes: Notes on parts that were left out, repaired or are not shown.
        files: All files that it was read from.
        model: The glTF file, or None for other files.
    """

    path: Path
    world: World
    scene: Scene | None = None
    stand: SceneNode | None = None
    notes: list[str] = field(default_factory=list)
    files: list[Path] = field(default_factory=list)
    model: ModelPrefab | None = None

    def mesh_name(self, key: str) -> str:
        """Return the name in the model of a mesh of the world; its key where it has none."""
        return (self.model.mesh_name(key) if self.model is not None else "") or key

    def node_name(self, entity: int) -> str:
        """Return the name in the model of an entity's node; in a scene its name in the world."""
        name = self.world.graph.name(entity)
        return name if self.stand is None else name.removeprefix(f"{self.stand.name}/")

    @property
    def title(self) -> str:
        """Title of the scene, or name of the model file."""
        return self.path.name if self.scene is None else self.scene.title

    @property
    def extent(self) -> Extent | None:
        """Bounding box of the visible meshes; None where there are none."""
        return world_extent(self.world, None if self.stand is None else self.stand.index)

    @property
    def size(self) -> str:
        """Numbers of triangles and parts, and extent, in words; of levels of detail the finest counts."""
        listed, world = self.world.subentities(), self.world
        inside = [
            name
            for name, owner, level in zip(listed.mesh, listed.entity.tolist(), listed.level.tolist(), strict=True)
            if level == 0 and (self.stand is None or world.graph.hierarchy.is_inside(owner, self.stand.index))
        ]
        triangles = sum(world.meshes[name].triangle_count for name in inside if name in world.meshes)
        words = [_count(triangles, "triangle"), _count(len(inside), "part")]
        extent = self.extent
        if extent is not None:
            sides = (extent[1] - extent[0]).tolist()
            words.append(" x ".join(f"{side:.0f}" if 1e3 <= side < 1e7 else f"{side:.3g}" for side in sides) + " m")
        return ", ".join(words)


def open_shown(path: Path, up: Up = "y", *, faulty: bool = False) -> Shown:
    """Read a file to show.

    Args:
        path: A scene file or the name of a shipped scene, a glTF model, or a mesh file (`MESH_SUFFIXES`).
        up: Upward axis of a mesh file.
        faulty: Whether a scene may have faults that only the stages find, as an editor shows them.

    Raises:
        SceneError: The file is missing, of an unknown kind, or faulty.
    """
    suffix = path.suffix.lower()
    if suffix in (".json", ""):
        return _open_scene(path, faulty=faulty)
    if suffix not in MODEL_SUFFIXES:
        known = ", ".join((".json", *MODEL_SUFFIXES))
        raise SceneError(Issue(str(path), "", f'unsupported file type "{suffix}"', f"known: {known}"))
    world = World()
    stand = world.root.create_child("model")
    if up == "z":
        stand.set_orientation(_QUARTER)
    shown = Shown(path, world, stand=stand, files=[path])
    if suffix in GLTF_SUFFIXES:
        model = read_model(path, without_pictures=True)
        model.instantiate(world, stand)
        shown.files, shown.notes, shown.model = model.document.files, list(model.document.notes), model
    else:
        add_mesh_file(world, stand, path)
        shown.notes = [f"a {suffix[1:].upper()} file names no unit: taken as metres"]
    world.update()
    return shown


def _open_scene(path: Path, *, faulty: bool) -> Shown:
    from mimics_app.app.scenes.loading import load_checked_scene, read_scene
    from mimics_app.app.viewer.resting import rest
    from mimics_app.world.files.scene.file import build_world

    whole = True
    try:
        scene = load_checked_scene(path)
    except SceneError:
        if not faulty:
            raise
        scene, whole = read_scene(path), False
    world = build_world(scene)
    if whole:
        rest(scene, world)
    world.effects.trigger("start")
    return Shown(scene.path, world, scene, None, list(scene.notes), list(scene.files))


def _count(number: int, word: str) -> str:
    """Return a number with a noun, with blanks between thousands."""
    return f"{number:,} {word}{'' if number == 1 else 's'}".replace(",", " ")
