"""The model that is a participant's own body in a scene, and why it is not shown."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from mimics_app.app.scenes.loading import read_scene
from mimics_app.app.scenes.person_edit import OWN_BODY
from mimics_app.app.study.study_folder import Participant, StudyFolder
from mimics_app.contracts.system.phrases import phrase
from mimics_app.world.files.gltf.gltf_document import GLTF_SUFFIXES

__all__ = ["OwnBody", "models_of", "own_body_of", "why_no_model"]


class OwnBody(NamedTuple):
    """The own body of a session.

    Attributes:
        file: The model; None: as the scene has it.
        why_not: Why it is not the participant's, "" where it is or the participant has none.
    """

    file: Path | None = None
    why_not: str = ""


def own_body_of(study: StudyFolder, participant: Participant, scene: Path) -> OwnBody:
    """Return the participant's own body in a scene; a scene that shows none keeps what it has.

    Raises:
        SceneError: The scene is faulty.
    """
    if not participant.avatar or OWN_BODY not in read_scene(scene).document["assets"]:
        return OwnBody()
    why = why_no_model(study, participant)
    return OwnBody(None, why) if why else OwnBody((study.path / participant.avatar).resolve())


def why_no_model(study: StudyFolder, participant: Participant) -> str:
    """Return why a participant's model cannot be shown, "" where it can, or there is none."""
    file = study.path / participant.avatar
    if not participant.avatar or (file.suffix.lower() in GLTF_SUFFIXES and file.is_file()):
        return ""
    return phrase("There is no model of the own body at {file}: the one of the scene is shown", file=file)


def models_of(study: StudyFolder, participant: Participant) -> list[str]:
    """Return the models in the folder of a participant, as paths from the study's folder."""
    folder = study.folder_of(participant)
    found = sorted(each for each in folder.glob("*.*") if each.suffix.lower() in GLTF_SUFFIXES)
    return [str(each.relative_to(study.path)) for each in found]
