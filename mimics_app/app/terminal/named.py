"""Checks that what a command line names exists, before compiled code is imported."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.contracts.errors import Issue, SceneError, UsageError, nearest
from mimics_app.contracts.ports.display_choice import parse_display

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_adaptation", "check_camera", "check_file", "check_files"]


def check_files(action: Path | None, display: str, commands: Path | None = None) -> None:
    """Check that the files of actions, of the display and of commands exist.

    Raises:
        SceneError: A file is missing.
    """
    if action is not None:
        check_file(action, 'write actions there: [{"t": 5, "values": {..}}]')
    if commands is not None:
        check_file(commands, 'write commands there: [{"t": 5, "command": "pause"}]')
    shown = parse_display(display).file if display else ""
    if shown:
        check_file(Path(shown), "docs/displays.md shows what a display's file holds")


def check_file(file: Path, fix: str = "") -> None:
    """Check that a file exists.

    Raises:
        SceneError: It is missing; the message ends with `fix`.
    """
    if not os.path.exists(file):  # False, without an error, for names that no file can have
        raise SceneError(Issue(str(file), "", "no such file", fix))


def check_camera(name: str, scene: Scene) -> None:
    """Check that a scene that has cameras has one of a name; "": any.

    Raises:
        SceneError: It has none of the name.
    """
    from mimics_app.world.components.visible import CameraComponent

    cameras = [entity for entity, _, _ in scene.components(CameraComponent)]
    if name and cameras and name not in cameras:
        raise SceneError(scene.issue("/entities", f'has no camera "{name}"', nearest(name, cameras)))


def check_adaptation(learn: str, goal: str, estimator: str) -> None:
    """Check that a policy, a goal and an estimator exist, and that the policy can follow the goal; "" for none.

    Raises:
        UsageError: One does not exist, or the policy cannot; the message names those that do.
    """
    from mimics_app.estimation.registry import check_estimator
    from mimics_app.learning.goals import build_goal
    from mimics_app.learning.registry import check_goal, check_policy

    if learn:
        check_policy(learn)
    check_estimator(estimator)
    try:
        if goal:
            build_goal(goal)
        if learn and goal:
            check_goal(learn, goal)
    except ValueError as error:
        raise UsageError(str(error)) from error
