"""Checks of the requested scene and trials of a run, before compiled code and graphics are imported."""

from __future__ import annotations

from pathlib import Path

from msgspec import structs

from mimics_app.app.scenes.loading import read_scene
from mimics_app.app.scenes.person_edit import PersonEdit, read_fit
from mimics_app.app.settings import NOT_FITTED, RunSettings
from mimics_app.app.terminal.named import check_file
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.messages.fit import Fit
from mimics_app.tasks.scene_section import task_of
from mimics_app.tasks.tailoring import with_trials
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.trial_file import resolve_trials
from mimics_app.tasks.trials import check_first_trial, repeated, trial_blocks
from mimics_app.world.components.systems import DisplaySettings
from mimics_app.world.files.gltf.gltf_document import GLTF_SUFFIXES
from mimics_app.world.files.scene.scene import Scene

__all__ = ["read_requested", "with_requested_trials"]

_LARGER_TEXT = 1.6
"""Factor of larger text, the largest that a calibration leads to unless a therapist allows more."""


def read_requested(settings: RunSettings) -> Scene:
    """Read the scene of a run, and check that its first trial exists and the file of its display is right.

    The stages have not checked it yet.

    Raises:
        SceneError: The scene or the file of the display is faulty.
        UsageError: The session has no such trial, or the scene has no mirror image.
    """
    scene = read_scene(settings.scene, device=settings.device, edit=_edit(settings))
    if settings.display or scene.system(DisplaySettings) is not None:
        from mimics_app.app.picture.shown_on import check_display

        check_display(scene, settings.display)
    task = with_requested_trials(resolve_trials(task_of(scene), scene.path.parent, scene.root), settings)
    trials = sum(len(block.trials) * block.repetitions for block in trial_blocks(task))
    check_first_trial(settings.from_trial, trials)
    return scene


def _edit(settings: RunSettings) -> PersonEdit | None:
    """Return the change of the scene for the person who plays; None: none."""
    fit = Fit() if settings.fit in (None, NOT_FITTED) else read_fit(settings.fit)
    if settings.larger_text:
        fit = structs.replace(fit, text=max(fit.text, _LARGER_TEXT))
    avatar = "" if settings.avatar is None else str(_model(settings.avatar))
    edit = PersonEdit(fit, settings.side, avatar, settings.high_contrast)
    return None if edit == PersonEdit() else edit


def _model(file: Path) -> Path:
    """Return the model of the person's own body, which every process of the session finds.

    Raises:
        SceneError: The file does not exist, or it is no glTF model.
    """
    if file.suffix.lower() not in GLTF_SUFFIXES:
        raise SceneError(Issue(str(file), "", "is no model of a person", "mimics avatar make writes one"))
    check_file(file)
    return file.resolve()


def with_requested_trials(task: TaskSpec, settings: RunSettings) -> TaskSpec:
    """Return a task, whose trial file has been read, with the number of trials of the run."""
    task = with_trials(task, settings.trials, settings.seed)
    if settings.learn and settings.seconds is not None:
        return repeated(task, settings.seconds)
    return task
