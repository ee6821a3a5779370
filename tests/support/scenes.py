"""Small scene files made by tests."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from mimics_app.app.scenes.stage_checks import check_components
from mimics_app.contracts.errors import SceneError
from mimics_app.world.files.scene.file import load_scene


def scene(*entities: dict[str, Any], **parts: Any) -> dict[str, Any]:
    """A scene document with these entities."""
    return {"format": "mimics-scene", "version": 1, "entities": list(entities), **parts}


def thing(name: str, **components: Any) -> dict[str, Any]:
    """An entity with these components."""
    return {"id": name, "components": components}


def write(folder: Path, document: Any, name: str = "scene.json") -> Path:
    """Write a document; NaN and Infinity as the tokens they are not allowed to be. Text is written as it is."""
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(document if isinstance(document, str) else json.dumps(document), encoding="utf-8")
    return path


def faults(path: Path, **options: Any) -> list[str]:
    """The lines a scene is refused with, file names shortened; [] when it is right."""
    try:
        issues = check_components(load_scene(path, **options))
    except SceneError as error:
        issues = error.issues
    return [str(issue).replace(str(path.parent) + "/", "") for issue in issues]
