"""Checks of the settings of a run, before compiled code and graphics are imported."""

from __future__ import annotations

from mimics_app.app.scenes.loading import read_scene
from mimics_app.app.settings import RunSettings
from mimics_app.tasks.scene_section import task_of
from mimics_app.tasks.tailoring import with_trials
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.trial_file import resolve_trials
from mimics_app.tasks.trials import check_first_trial, repeated, trial_blocks
from mimics_app.world.components.systems import DisplaySettings
from mimics_app.world.scene.scene import Scene

__all__ = ["as_long_as_asked", "read_asked"]


def read_asked(settings: RunSettings) -> Scene:
    """The scene of a run, not yet checked by the stages; it has the trial to begin with, its display's file is right.

    Raises:
        SceneError: the scene or the file of the display is wrong.
        UsageError: the session has no such trial.
    """
    scene = read_scene(settings.scene)
    if settings.display or scene.system(DisplaySettings) is not None:
        from mimics_app.app.picture.shown_on import check_display

        check_display(scene, settings.display)
    task = as_long_as_asked(resolve_trials(task_of(scene), scene.path.parent, scene.root), settings)
    trials = sum(len(block.trials) * block.repetitions for block in trial_blocks(task))
    check_first_trial(settings.from_trial, trials)
    return scene


def as_long_as_asked(task: TaskSpec, settings: RunSettings) -> TaskSpec:
    """The task, its trial file read, with as many trials as the run is to have."""
    task = with_trials(task, settings.trials, settings.seed)
    if settings.learn and settings.seconds is not None:
        return repeated(task, settings.seconds)
    return task
