"""A list of trials in a file of its own, so that one scene serves many protocols."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.json_file import pointer_step, read_json
from mimics_app.tasks.check import check_blocks
from mimics_app.tasks.task import BlockSpec, TaskSpec

__all__ = ["load_blocks", "resolve_trials", "trial_file_path"]


def resolve_trials(spec: TaskSpec, folder: Path) -> TaskSpec:
    """The same task with its trial file, if it names one, read.

    Args:
        spec: The task.
        folder: Folder of the scene file; the trial file must lie inside it.

    Raises:
        SceneError: with every fault of the trial file.
    """
    if not isinstance(spec.trials, str):
        return spec
    path = trial_file_path(spec.trials, folder)
    blocks = load_blocks(path)
    issues = check_blocks(spec, blocks, "", str(path))
    if issues:
        raise SceneError(issues)
    return msgspec.structs.replace(spec, trials=blocks)


def trial_file_path(name: str, folder: Path) -> Path:
    """Where a trial file lies; SceneError when that is outside the scene's folder."""
    path = (folder / name).resolve()
    if not path.is_relative_to(folder.resolve()):
        raise SceneError(Issue(name, "", "lies outside the scene's folder", "put the trial file beside the scene"))
    return path


def load_blocks(path: Path) -> list[BlockSpec]:
    """Read a JSON list of blocks.

    Raises:
        SceneError: no such file, no JSON, or blocks that are none; one issue per faulty block.
    """
    document = read_json(path, fix_missing="check the name under task/trials")
    if not isinstance(document, list) or not document:
        raise SceneError(Issue(str(path), "", "is no list of blocks", 'write [{"trials": [...]}, ...]'))
    blocks: list[BlockSpec] = []
    issues: list[Issue] = []
    for i, item in enumerate(document):
        try:
            blocks.append(msgspec.convert(_without_notes(item), BlockSpec))
        except msgspec.ValidationError as error:
            what, _, place = str(error).partition(" - at ")
            issues.append(Issue(str(path), f"/{i}{_pointer(place)}", what))
    if issues:
        raise SceneError(issues)
    return blocks


def _without_notes(item: Any) -> Any:
    """The item without `x-` keys, which belong to other programs and to people."""
    if isinstance(item, Mapping):
        return {name: _without_notes(value) for name, value in item.items() if not name.startswith("x-")}
    return [_without_notes(value) for value in item] if isinstance(item, list) else item


def _pointer(place: str) -> str:
    """A place `$.a[0].b` of msgspec as JSON pointer /a/0/b; a key it will not name (`[...]`) ends the pointer."""
    steps = re.findall(r"\.([^.\[`]+)|\[(\d+)\]", place.partition("[...]")[0])
    return "".join(f"/{pointer_step(name or index)}" for name, index in steps)
