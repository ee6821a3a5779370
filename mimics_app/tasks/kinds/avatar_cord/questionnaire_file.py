"""Questionnaires in files of their own, for published statements that may be used but not distributed."""

from __future__ import annotations

from pathlib import Path

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.tasks.kinds.avatar_cord.spec import QuestionnaireSpec
from mimics_app.world.files.reading.paths import PathFault, find_file
from mimics_app.world.files.reading.struct_file import read_struct_file

__all__ = ["check_questionnaire", "read_questionnaire"]

_MAX_BYTES = 1 << 20


def read_questionnaire(name: str, folder: Path, root: Path) -> QuestionnaireSpec:
    """Read a JSON object of what may stand under `task.avatar_cord.questionnaire`.

    Args:
        name: Path of the file from the scene's folder.
        folder: Folder of the scene file.
        root: Folder that it must lie inside.

    Raises:
        SceneError: no such file, no JSON, or with every fault of it.
    """
    try:
        path = find_file(name, folder, root)
    except PathFault as fault:
        raise SceneError(Issue(name, "", fault.what, fault.fix or "check the name")) from fault
    read = read_struct_file(path, QuestionnaireSpec, _MAX_BYTES)
    faults = [Issue(str(path), place, what, fix) for place, what, fix in check_questionnaire(read)]
    if faults:
        raise SceneError(faults)
    return read


def check_questionnaire(questions: QuestionnaireSpec) -> list[tuple[str, str, str]]:
    """Return the faults of a questionnaire: pointer within it, what is wrong, what to do."""
    faults = []
    if questions.least >= questions.most:
        faults.append(("/most", "is not above least", "give the scale's upper end"))
    ids = [item.id for item in questions.items]
    for number, name in enumerate(ids):
        if name in ids[:number]:
            faults.append((f"/items/{number}/id", f'another item is called "{name}"', "give each its own id"))
    return faults
