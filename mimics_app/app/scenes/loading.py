"""Reading and checking of scenes, the same for every command.

The files are checked first, without compiled code, so that a faulty scene is rejected before kernels are imported or
compiled. Then the stages check a scene whose files are right.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import mimics_app.tasks.scene_section  # noqa: F401  registers the task block
from mimics_app.app.scenes.scene_search import find_scene
from mimics_app.contracts.errors import Issue, MimicsError, SceneError
from mimics_app.world.files.scene.file import FaultyScene, load_scene
from mimics_app.world.files.scene.scene import Scene, SceneEdit

__all__ = ["check_scene", "load_checked_scene", "read_scene", "review_scene"]


def load_checked_scene(
    path: Path | str, before: Scene | None = None, *, device: str = "", edit: SceneEdit | None = None
) -> Scene:
    """Read a scene with the files it names, and check it.

    Args:
        path: The scene file, or the name of a shipped scene.
        before: The scene that it replaces, see `load_scene`.
        device: NAME or NAME:ADDRESS of the device that plays it, see `load_scene`.
        edit: Change for the person who plays, see `load_scene`.

    Raises:
        SceneError: Every fault of the files and, where they can be read, every fault that a stage has found, each with
            file and JSON pointer.
        DeviceError: The device of the scene's robot does not exist.
    """
    try:
        scene = read_scene(path, before, device=device, edit=edit)
    except FaultyScene as error:
        raise SceneError(dict.fromkeys([*error.issues, *_also_in(error.scene)])) from error
    return check_scene(scene)


def review_scene(path: Path, before: Scene, unsaved: Mapping[Path, bytes]) -> tuple[Scene | None, list[Issue]]:
    """Read and check a scene with edits that are not saved, as `load_checked_scene` would.

    Args:
        path: The scene file.
        before: The scene that it replaces.
        unsaved: See `load_scene`.

    Returns:
        (scene, faults): The scene is None where its files have a fault, and complete where only stages found one.
    """
    try:
        scene = load_scene(path, before=before, device=before.device, unsaved=unsaved)
    except FaultyScene as error:
        return None, list(dict.fromkeys([*error.issues, *_also_in(error.scene)]))
    except SceneError as error:
        return None, error.issues
    try:
        check_scene(scene)
    except MimicsError as error:
        return scene, error.issues
    return scene, []


def _also_in(scene: Scene | None) -> list[Issue]:
    """Return the faults that stages find in a scene with others, as far as those let them look."""
    if scene is None:
        return []
    from mimics_app.app.scenes.stage_checks import check_apart

    return check_apart(scene)


def read_scene(
    path: Path | str, before: Scene | None = None, *, device: str = "", edit: SceneEdit | None = None
) -> Scene:
    """Do the first half of `load_checked_scene`, the check of the files, which imports no compiled code.

    Raises:
        SceneError: Every fault of the files.
    """
    return load_scene(find_scene(Path(path)), before=before, device=device.partition(":")[0], edit=edit)


def check_scene(scene: Scene) -> Scene:
    """Do the second half of `load_checked_scene`: return the scene if the stages find no fault in it.

    Raises:
        SceneError: Every fault that a stage has found.
        DeviceError: The device of the scene's robot does not exist.
    """
    from mimics_app.app.scenes.stage_checks import check_stages

    issues = check_stages(scene)
    if issues:
        raise SceneError(issues)
    scene.read.clear()  # components read by the checks are not in use yet
    return scene
