"""Loading of scene files: versioned JSON, all faults reported at once (format: `spec`, types: `world.components`).

`mimics check` and `mimics run` both use `load_scene`, so that the one accepts exactly what the other runs.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.contracts.errors import MOST_SOUGHT, Issue, SceneError
from mimics_app.contracts.ports.members import import_members
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.world import components
from mimics_app.world.components.plugins import register_plugins
from mimics_app.world.files.reading.json_text import CONTROL, NOT_FINITE, TOO_LARGE, TORN
from mimics_app.world.files.reading.paths import find_root
from mimics_app.world.files.reading.struct_reader import is_comment
from mimics_app.world.files.scene.checks import check_meaning
from mimics_app.world.files.scene.loader import SceneLoader
from mimics_app.world.files.scene.scene import Scene, SceneEdit
from mimics_app.world.files.scene.scene_files import read_sources

if TYPE_CHECKING:
    from mimics_app.world.content.world import World

__all__ = ["FaultyScene", "build_world", "load_scene"]

import_members(components)


class FaultyScene(SceneError):
    """Faults of a scene.

    Attributes:
        scene: The scene where all its files could be read and the faults are of their meaning; None otherwise.
    """

    def __init__(self, issues: Iterable[Issue], scene: Scene | None) -> None:
        super().__init__(issues)
        self.scene = scene


def load_scene(
    path: Path | str,
    root: Path | None = None,
    before: Scene | None = None,
    *,
    device: str = "",
    edit: SceneEdit | None = None,
    unsaved: Mapping[Path, bytes] | None = None,
) -> Scene:
    """Read a scene file and all files it names.

    Args:
        path: The scene file.
        root: Folder that all its files must be inside; default: see `paths.find_root`.
        before: Scene it replaces; data derived from equal sources is reused.
        device: Name of the device that plays it, whose entities replace others where the files have such; "": none.
        edit: Change of the resolved scene for the person who plays; None: none.
        unsaved: Bytes of scene files that count instead of those on the disk, by resolved file.

    Raises:
        SceneError: every fault found, each with file, JSON pointer, what is wrong, and the nearest right name.
    """
    path = Path(path)
    register_plugins()
    issues: list[Issue] = []
    folder = find_root(path) if root is None else root
    sources = read_sources(path, folder, issues, unsaved)
    _stop_after_many(issues, path)
    loader = SceneLoader(sources, folder, issues, device, edit)
    scene = loader.load()
    if before is not None:
        scene.take_over(before)
    _stop_after_many(issues, path)
    unusable = [issue for issue in issues if any(what in issue.what for what in (CONTROL, NOT_FINITE, TOO_LARGE, TORN))]
    above = _with_all_above(unusable)
    readable = sources[0].whole and not issues
    if sources[0].whole:
        issues += [issue for issue in check_meaning(scene) if (issue.file, issue.pointer) not in above]
    if issues:
        places = {(issue.file, issue.pointer) for issue in unusable}
        known = set(unusable)
        listed = [issue for issue in issues if issue in known or (issue.file, issue.pointer) not in places]
        raise FaultyScene(dict.fromkeys(listed), scene if readable else None)
    if loader.unedited is not None:
        raise loader.unedited  # the scene is right, so the edit is not: nobody plays what was not fitted
    scene.hash = scene_hash(scene)
    return scene


def build_world(scene: Scene) -> World:
    """Build the running world of a scene."""
    from mimics_app.world.files.scene.world_construction import build  # compiled code: not needed to check a scene

    return build(scene)


def _stop_after_many(issues: list[Issue], path: Path) -> None:
    """Refuse a scene with very many faults without further checks, which would take long."""
    if len(issues) >= MOST_SOUGHT:
        raise SceneError([*dict.fromkeys(issues), Issue(str(path), "", "has more faults, which were not searched for")])


def _with_all_above(unusable: list[Issue]) -> set[tuple[str, str]]:
    """Return file and pointer of all values that contain an unusable one: consequences are not reported again."""
    places = set()
    for issue in unusable:
        pointer = issue.pointer
        while (issue.file, pointer) not in places:
            places.add((issue.file, pointer))
            pointer = pointer.rpartition("/")[0]
    return places


def scene_hash(scene: Scene) -> str:
    """SHA-256 of the resolved document, comments left out, and of the bytes of every file it names.

    The scene files themselves do not count: layout and distribution over files do not change the hash.
    """
    text = _canonical(scene.document)
    if '"x-' in text:
        text = _canonical(_without_comments(scene.document))
    digest = hashlib.sha256(text.encode())
    for name in sorted(scene.assets):
        digest.update(f"{name}:{scene.assets[name].digest}".encode())
    for path in scene.named_files:
        try:
            digest.update(hashlib.sha256(read_regular(path)).digest())
        except OSError as error:
            raise SceneError(Issue(str(path), "", f"cannot be read: {error.strerror}")) from None
    return digest.hexdigest()


def _canonical(document: dict[str, Any]) -> str:
    return json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)


def _without_comments(value: object) -> Any:
    if isinstance(value, dict):
        return {key: _without_comments(item) for key, item in value.items() if not is_comment(key)}
    if isinstance(value, list):
        return [_without_comments(item) for item in value]
    return value
