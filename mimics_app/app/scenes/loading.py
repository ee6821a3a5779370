"""Scenes as the application reads them: one validator with every stage's own checks, for `check` and `run` alike.

What the files themselves say is checked first, without compiled code: a scene with a fault in it is refused at once,
and not after kernels were imported, or compiled. A scene without one meets what the stages know of it.
"""

from __future__ import annotations

from pathlib import Path

import mimics_app.tasks.scene_section  # noqa: F401  registers the task block
from mimics_app.app.scenes.finding import find_scene
from mimics_app.contracts.errors import SceneError
from mimics_app.world.scene.file import load_scene
from mimics_app.world.scene.scene import Scene

__all__ = ["check_scene", "load_checked_scene", "read_scene"]


def load_checked_scene(path: Path | str, before: Scene | None = None) -> Scene:
    """Read a scene and everything it names, and check what no single stage can.

    Args:
        path: The scene file, or a shipped scene's name.
        before: The scene it replaces, see `load_scene`.

    Raises:
        SceneError: every fault found in the files, or else every one that a stage has found, each with file and JSON
            pointer.
        DeviceError: the scene's robot has a device that nobody has.
    """
    return check_scene(read_scene(path, before))


def read_scene(path: Path | str, before: Scene | None = None) -> Scene:
    """The first half of `load_checked_scene`, which imports no compiled code: what the files say of themselves.

    Raises:
        SceneError: every fault found in the files.
    """
    return load_scene(find_scene(Path(path)), before=before)


def check_scene(scene: Scene) -> Scene:
    """The second half: the same scene, if the stages find no fault in it.

    Raises:
        SceneError: every fault that a stage has found.
        DeviceError: the scene's robot has a device that nobody has.
    """
    from mimics_app.app.scenes.stage_checks import check_stages

    issues = check_stages(scene)
    if issues:
        raise SceneError(issues)
    scene.read.clear()  # what is checked is not yet made use of
    return scene
