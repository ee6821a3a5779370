"""Which display a session's picture is shown on: what was requested, else what the scene says."""

from __future__ import annotations

import sys
from pathlib import Path

from mimics_app.contracts.display_choice import DISPLAY_KINDS, DisplayChoice, parse_display
from mimics_app.contracts.display_port import Display
from mimics_app.contracts.errors import SceneError, UsageError
from mimics_app.rendering.visual.displays.catalogue import make_display
from mimics_app.rendering.visual.displays.headset_file import load_headset
from mimics_app.rendering.visual.displays.wall_file import load_walls
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.world.components.systems import DisplaySettings
from mimics_app.world.scene.paths import PathFault, find_file
from mimics_app.world.scene.scene import Scene

__all__ = ["check_display", "chosen_display", "open_display"]


def open_display(scene: Scene, asked: str, surface: Surface) -> Display:
    """The display of a session; where another has to do in its place, one line on stderr says so.

    Args:
        scene: Its `systems.display` holds what was not requested.
        asked: KIND or KIND:FILE, "" for the scene's.
        surface: Whose context it is given.

    Raises:
        SceneError: the scene's display needs a file, or its file is wrong.
        DeviceError: it cannot be had.
    """
    settings = scene.system(DisplaySettings) or DisplaySettings()
    display, said = make_display(chosen_display(scene, asked), settings, surface)
    if said:
        sys.stderr.write(f"mimics: {said}\n")
    return display


def check_display(scene: Scene, asked: str) -> None:
    """Look at the file of a display, so that a wrong one is reported before anything begins.

    Raises:
        SceneError: the scene's display needs a file, or its file is wrong.
    """
    choice = chosen_display(scene, asked)
    if choice.kind in ("wall", "cave"):
        load_walls(Path(choice.file))
    elif choice.file:
        load_headset(Path(choice.file))


def chosen_display(scene: Scene, asked: str) -> DisplayChoice:
    """Kind and file: as requested, else as the scene says, its file looked for beside it."""
    if asked:
        return parse_display(asked)
    settings = scene.system(DisplaySettings) or DisplaySettings()
    wants = DISPLAY_KINDS[settings.kind]
    if not settings.file or wants == "never":
        try:
            return parse_display(settings.kind)
        except UsageError as error:
            raise SceneError(scene.issue("/systems/display", error.what, "give its file")) from None
    try:
        file: Path = find_file(settings.file, scene.path.parent, scene.root)
    except PathFault as fault:
        raise SceneError(scene.issue("/systems/display/file", fault.what, fault.fix)) from None
    return DisplayChoice(settings.kind, str(file))
