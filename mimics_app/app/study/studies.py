"""The studies of a folder: found, made where there is none; codes in them, and the newest calibration of a code."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec

from mimics_app.app.scenes.person_edit import FitFile
from mimics_app.app.study.forms import SHIPPED_FORMS
from mimics_app.app.study.own_bodies import OwnBody, own_body_of
from mimics_app.app.study.study_folder import Participant, StudyFolder
from mimics_app.app.study.study_runs import CALIBRATION
from mimics_app.app.terminal.participant import why_no_code
from mimics_app.contracts.errors import MimicsError
from mimics_app.contracts.messages.calibration_record import newest_of
from mimics_app.contracts.system.alone import alone_in
from mimics_app.recording.calibrations import calibration_of
from mimics_app.recording.event_log import to_json
from mimics_app.recording.history import played_by
from mimics_app.recording.report_values import mapping
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import write_atomically
from mimics_app.recording.session_header import read_session

__all__ = ["USUAL_STUDY", "body_of_code", "codes_in", "fit_of_code", "recorded_codes", "studies_in", "usual_study"]

USUAL_STUDY = "participants"
"""Name of its folder."""
_SCENES = ("wavy_tunnel", "pick_and_place")
_FORMS = ("person", "nasa_tlx")
_SESSIONS = 20
_FIT = "fit.json"
"""File of the fit in a participant's folder of a study."""
_MOST_FOLDERS = 400
"""Newest run folders that are read, by their names."""


def studies_in(folder: Path) -> list[Path]:
    """Return the folders of the studies in a folder, by name."""
    return sorted(each.parent for each in folder.glob("*/study.json"))


def codes_in(study: Path) -> list[str]:
    """Return the codes of the participants of a study, as they were added; none of one that is damaged."""
    try:
        return [each.code for each in StudyFolder(study).participants]
    except MimicsError:
        return []


def recorded_codes(runs: Path) -> list[str]:
    """Return the codes of the participants of the newest run folders, the last one first, without what is no code."""
    headers = (read_session(folder)[0] for folder in _newest_runs(runs))
    codes = dict.fromkeys(played_by(header)[1] for header in headers)
    return [code for code in codes if code and not why_no_code(code)]


def usual_study(folder: Path) -> StudyFolder:
    """Make the study in a folder.

    Raises:
        OutputError: Its folder exists, or cannot be made.
    """
    protocol: dict[str, Any] = {
        "format": "mimics study",
        "version": 1,
        "title": "",
        "sessions": _SESSIONS,
        "conditions": {scene: {"scene": scene} for scene in _SCENES},
        "blocks": [{"conditions": list(_SCENES)}],
        "forms": {name: msgspec.to_builtins(SHIPPED_FORMS[name]) for name in _FORMS},
    }
    return StudyFolder.create(folder / USUAL_STUDY, protocol)


def fit_of_code(code: str, runs: Path) -> Path | None:
    """Return what a session of a participant is fitted to: a file of a fit or a run folder; None for nothing.

    Args:
        code: Code of the participant.
        runs: Parent of the run folders; studies are beside it.
    """
    return _in_studies(code, runs.parent) or _in_runs(code, runs)


def body_of_code(code: str, runs: Path, scene: Path) -> OwnBody:
    """Return the own body of a participant in a scene, from the first study beside the run folders that keeps one.

    Raises:
        SceneError: The scene is faulty.
    """
    kept = ((study, person) for study, person in _found(code, runs.parent) if person.avatar)
    study, person = next(kept, (None, None))
    return OwnBody() if study is None or person is None else own_body_of(study, person, scene)


def _found(code: str, folder: Path) -> Iterator[tuple[StudyFolder, Participant]]:
    """Yield a participant in each study that has the code; a damaged study is left out."""
    for place in studies_in(folder):
        try:
            study = StudyFolder(place)
            person = next((each for each in study.participants if each.code == code), None)
        except MimicsError:
            continue
        if person is not None:
            yield study, person


def _in_studies(code: str, folder: Path) -> Path | None:
    for study, person in _found(code, folder):
        try:
            kept = study.calibrations_of(person)
        except MimicsError:
            continue
        if kept and study.protocol.fitting.on:
            file = study.folder_of(person) / _FIT
            newest = newest_of([calibration for _, calibration in kept])
            with alone_in(study.path):  # each run of a participant writes it
                write_atomically(file, to_json(msgspec.to_builtins(FitFile(newest, study.protocol.fitting))))
            return file
    return None


def _in_runs(code: str, runs: Path) -> Path | None:
    for folder in _newest_runs(runs):
        header, _ = read_session(folder)
        scene, settings = mapping(header.get("scene")), mapping(header.get("settings"))
        if scene.get("name") != CALIBRATION or settings.get("participant") != code:
            continue
        if calibration_of(Run(folder)) is not None:
            return folder
    return None


def _newest_runs(runs: Path) -> list[Path]:
    """Return the newest run folders in a folder, the newest first."""
    return sorted(runs.glob("*_*"), reverse=True)[:_MOST_FOLDERS]
