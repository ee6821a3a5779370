"""Scene files: versioned JSON, read with all their faults at once (format: `scene_spec`, types: `components*`).

`mimics check` and `mimics run` both come through `load_scene`, so that what the one accepts the other runs.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.world import components, components_haptic, components_systems, haptic_checks
from mimics_app.world.paths import find_root
from mimics_app.world.scene import Scene
from mimics_app.world.scene_checks import check_meaning
from mimics_app.world.scene_loader import SceneLoader
from mimics_app.world.scene_source import read_sources
from mimics_app.world.struct_reader import is_comment

if TYPE_CHECKING:
    from mimics_app.world.world import World

__all__ = ["build_world", "load_scene"]

REGISTERING = (components, components_haptic, components_systems, haptic_checks)
"""Modules whose import makes the built-in component types, systems and checks known."""


def load_scene(path: Path, root: Path | None = None) -> Scene:
    """Read a scene file and everything it names.

    Args:
        path: The scene file.
        root: Folder that every file it names must stay inside; default: see `paths.find_root`.

    Raises:
        SceneError: every fault found, each with file, JSON pointer, what is wrong, and the nearest right name.
    """
    issues: list[Issue] = []
    folder = find_root(path) if root is None else root
    sources = read_sources(path, folder, issues)
    scene = SceneLoader(sources, folder, issues).load()
    issues += check_meaning(scene)
    if issues:
        raise SceneError(_distinct(issues))
    scene.hash = _hash(scene)
    return scene


def build_world(scene: Scene) -> World:
    """The running world a scene describes."""
    from mimics_app.world.build import build  # compiled code: not needed to check a scene

    return build(scene)


def _distinct(issues: list[Issue]) -> list[Issue]:
    """Each fault once, and nothing further about a value that is no number at all."""
    unusable = {(issue.file, issue.pointer) for issue in issues if "is not a finite number" in issue.what}
    kept: dict[Issue, None] = {}
    for issue in issues:
        if (issue.file, issue.pointer) not in unusable or "is not a finite number" in issue.what:
            kept[issue] = None
    return list(kept)


def _hash(scene: Scene) -> str:
    """SHA-256 of the resolved document, comments left out, and of the bytes of every file it names.

    The scene files themselves are left out: how a scene is spread over them, or laid out, changes nothing.
    """
    plain = _without_comments(scene.document)
    digest = hashlib.sha256(json.dumps(plain, sort_keys=True, separators=(",", ":"), allow_nan=False).encode())
    for name in sorted(scene.assets):
        digest.update(f"{name}:{scene.assets[name].digest}".encode())
    for path in scene.named_files:
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def _without_comments(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_comments(item) for key, item in value.items() if not is_comment(key)}
    if isinstance(value, list):
        return [_without_comments(item) for item in value]
    return value
