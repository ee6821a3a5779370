"""Reader of recorded motion of any supported format, as a clip of a model."""

from __future__ import annotations

from pathlib import Path

from mimics_app.contracts.errors import Issue, SceneError, UsageError
from mimics_app.world.motion.animator import Rig
from mimics_app.world.motion.clip import Clip
from mimics_app.world.motion.humanoid import HumanoidMap

__all__ = ["read_motion"]


def read_motion(path: Path, target: Rig, bones: HumanoidMap) -> tuple[Clip, list[str]]:
    """Read recorded motion as a clip of a model, named after the file; return it and a report of the mapping.

    Args:
        path: A .bvh or .c3d file.
        target: Nodes of the model.
        bones: Bones of the model.

    Raises:
        SceneError: the file has faults, or its skeleton is not humanoid.
        UsageError: the format is unknown, or a library that reads it is not installed.
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
    raise UsageError(f"{path} is not a file of recorded motion", "give a .bvh or a .c3d file")
