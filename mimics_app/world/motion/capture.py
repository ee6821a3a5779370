"""Recorded motion of any file that is read, as a clip of a model, by what the file calls itself."""

from __future__ import annotations

from pathlib import Path

from mimics_app.contracts.errors import Issue, SceneError, UsageError
from mimics_app.world.motion.animator import Rig
from mimics_app.world.motion.clip import Clip
from mimics_app.world.motion.humanoid import HumanoidMap

__all__ = ["read_motion"]


def read_motion(path: Path, target: Rig, bones: HumanoidMap) -> tuple[Clip, list[str]]:
    """A clip of a model, called as the file, that does what was recorded; and what was found and guessed.

    Args:
        path: A .bvh or .c3d file.
        target: Nodes of the model.
        bones: Its bones.

    Raises:
        SceneError: the file is wrong, or what it holds is no person.
        UsageError: it is neither, or a library that reads it is not installed.
    """
    kind = path.suffix.lower()
    if kind == ".bvh":
        from mimics_app.world.motion.bvh import capture_clip, read_bvh

        try:
            return capture_clip(read_bvh(path), path.stem, target, bones)
        except ValueError as error:
            raise SceneError(Issue(str(path), "", str(error))) from error
    if kind == ".c3d":
        from mimics_app.world.motion.c3d_file import read_c3d
        from mimics_app.world.motion.marker_clip import marker_clip

        return marker_clip(read_c3d(path), path.stem, target, bones)
    raise UsageError(f"{path} is no file of recorded motion", "give a .bvh or a .c3d file")
