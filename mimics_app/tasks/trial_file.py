"""Trial files: lists of trials apart from the scene, so that one scene serves many protocols."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import msgspec

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.tasks.check import check_blocks
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.trial_specs import BlockSpec
from mimics_app.world.files.reading.paths import PathFault, find_file
from mimics_app.world.files.reading.struct_file import read_struct_file

__all__ = ["load_blocks", "resolve_files", "resolve_trials"]

_Blocks = Annotated[list[BlockSpec], msgspec.Meta(min_length=1)]


def resolve_trials(spec: TaskSpec, folder: Path, root: Path | None = None) -> TaskSpec:
    """Return the task with its trial file, if any, read.

    Args:
        spec: The task.
        folder: Folder of the scene file.
        root: Folder the trial file must lie inside; None: `folder`.

    Raises:
        SceneError: with every fault of the trial file.
    """
    if not isinstance(spec.trials, str):
        return spec
    path = _find_trial_file(spec.trials, folder, root)
    blocks = load_blocks(path)
    issues = check_blocks(spec, blocks, "", str(path))
    if issues:
        raise SceneError(issues)
    return msgspec.structs.replace(spec, trials=blocks)


def resolve_files(spec: TaskSpec, folder: Path, root: Path | None = None) -> TaskSpec:
    """Return the task with its trial file and the files of its kinds read.

    Args:
        spec: The task.
        folder: Folder of the scene file.
        root: Folder the files must lie inside; None: `folder`.

    Raises:
        SceneError: with every fault of a file.
    """
    sections = {kind: spec.section(kind.name) for kind in task_kinds()}
    read = {
        kind.name: kind.read_files(section, folder, root or folder)
        for kind, section in sections.items()
        if section is not None
    }
    return msgspec.structs.replace(resolve_trials(spec, folder, root), **read)


def _find_trial_file(name: str, folder: Path, root: Path | None = None) -> Path:
    """Return the path of a trial file.

    Raises:
        SceneError: It is missing, or lies outside the root.
    """
    try:
        return find_file(name, folder, root or folder)
    except PathFault as fault:
        raise SceneError(Issue(name, "", fault.what, fault.fix or "check the name under task/trials")) from fault


def load_blocks(path: Path) -> list[BlockSpec]:
    """Read a JSON list of blocks.

    Raises:
        SceneError: no such file, no JSON, or with every fault of every block.
    """
    return read_struct_file(path, _Blocks)
