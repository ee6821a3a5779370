"""Worlds of a single glTF file without a scene file, for viewers and measurements."""

from __future__ import annotations

from pathlib import Path

from mimics_app.world.content.world import World
from mimics_app.world.files.gltf.file import load_gltf
from mimics_app.world.files.scene.assets import ModelPart, SceneAsset
from mimics_app.world.files.scene.prefab import ModelPrefab

__all__ = ["load_model_world", "read_model"]


def read_model(path: Path, *, without_pictures: bool = False) -> ModelPrefab:
    """Read a glTF file as a prefab.

    Args:
        path: The file.
        without_pictures: As `load_gltf`.

    Raises:
        SceneError: every fault of the file.
    """
    model = load_gltf(path, without_pictures=without_pictures)
    asset = SceneAsset(path.stem, "model", path, model=model, files=tuple(model.files))
    return ModelPrefab(ModelPart(asset, model, tuple(model.roots)))


def load_model_world(path: Path | str) -> World:
    """Build a world of the default scene of a glTF file, updated, with no lights but the file's own.

    Raises:
        SceneError: every fault of the file.
    """
    world = World()
    read_model(Path(path)).instantiate(world, world.root)
    world.update()
    return world
