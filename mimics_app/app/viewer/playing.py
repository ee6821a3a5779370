"""Animation in the viewer: clips by name and time, and the world positions of all vertices."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.viewer.shown import Shown
from mimics_app.contracts.errors import Issue, OutputError, SceneError, UsageError, nearest
from mimics_app.world.content.motion.animator import Animator
from mimics_app.world.content.motion.clip import Clip
from mimics_app.world.content.motion.humanoid import HumanoidMap
from mimics_app.world.content.motion.rig import Rig

__all__ = ["add_motion", "animators_of", "clips_of", "play_clip", "read_motion", "write_vertices"]


def animators_of(shown: Shown) -> list[Animator]:
    """Return the animators of the model or scene shown."""
    return [animator for animator in shown.world.motion.animators.values() if animator.clips]


def clips_of(shown: Shown) -> list[str]:
    """Return the names of the clips of the model or scene, in the order of the files."""
    return list(dict.fromkeys(name for animator in animators_of(shown) for name in animator.clips))


def add_motion(shown: Shown, path: Path) -> None:
    """Add a recorded motion to the first person shown, as a further clip; its report is added to the notes.

    Args:
        shown: The model or scene; it gets a clip and notes.
        path: A .bvh or .c3d file; its name without extension is that of the clip.

    Raises:
        SceneError: The file is faulty, or no person is shown.
        UsageError: The file is of neither kind.
    """
    from mimics_app.world.content.motion.humanoid import find_humanoid

    for animator in shown.world.motion.animators.values():
        bones = find_humanoid(animator.rig)
        if bones.complete:
            clip, report = read_motion(path, animator.rig, bones)
            animator.clips = {**animator.clips, clip.name: clip}
            shown.notes += report
            return
    raise SceneError(Issue(str(shown.path), "/skins", "shows no person who could move so", "see mimics avatar import"))


def play_clip(shown: Shown, name: str, at: float = 0.0, *, speed: float = 1.0) -> None:
    """Play a clip in every model that has it, instead of the present one; "" returns all models to rest.

    Args:
        shown: The model or scene; its world is updated.
        name: Name of the clip.
        at: Time in the clip at which to begin [s].
        speed: Clip time per time [-]; 0 holds the clip.

    Raises:
        SceneError: No model has such a clip; the message names the nearest one, or the existing ones.
    """
    playing = animators_of(shown)
    if name and not any(name in animator.clips for animator in playing):
        known = clips_of(shown)
        hint = nearest(name, known) if known else "there is nothing that moves in it"
        raise SceneError(Issue(str(shown.path), "/animations", f'has no clip "{name}"', hint))
    for animator in playing:
        animator.layers.clear()
        animator.moves = True
        if name in animator.clips:
            animator.play(name, at=at, speed=speed)
    shown.world.update()


def write_vertices(shown: Shown, path: Path) -> int:
    """Write the positions of all drawn vertices, and return their number.

    The file has `positions`, world [m] after morphs and skins, float64 [n, 3], and for each vertex `mesh` and `node`,
    the names in the model. Of several levels of detail the finest is written.

    Raises:
        OutputError: The file cannot be written.
    """
    world, listed = shown.world, shown.world.subentities()
    stand = None if shown.stand is None else shown.stand.index
    places: list[NDArray[np.float64]] = [np.zeros((0, 3))]
    meshes, nodes = list[str](), list[str]()
    for number in np.flatnonzero((listed.visible != 0) & (listed.level == 0)).tolist():
        key, entity = listed.mesh[number], int(listed.entity[number])
        if stand is not None and not world.graph.hierarchy.is_inside(entity, stand):
            continue
        local = world.mesh_positions(key)
        matrix = world.transforms.world[listed.row[number]]
        places.append(local @ matrix[:3, :3].T + matrix[:3, 3])
        meshes += [shown.mesh_name(key)] * len(local)
        nodes += [shown.node_name(entity)] * len(local)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("wb") as file:
            np.savez(
                file,
                positions=np.concatenate(places),
                mesh=np.array(meshes, dtype=np.str_),
                node=np.array(nodes, dtype=np.str_),
            )
    except OSError as error:
        raise OutputError(path, f"cannot be written: {error.strerror}", "name another file") from error
    return len(meshes)


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
        from mimics_app.world.files.capture.bvh import capture_clip, read_bvh

        try:
            return capture_clip(read_bvh(path), path.stem, target, bones)
        except ValueError as error:
            raise SceneError(Issue(str(path), "", str(error))) from error
    if kind == ".c3d":
        from mimics_app.world.files.capture.c3d_file import read_c3d
        from mimics_app.world.files.capture.marker_clip import marker_clip

        return marker_clip(read_c3d(path), path.stem, target, bones)
    raise UsageError(f"{path} is not a file of recorded motion", "give a .bvh or a .c3d file")
