"""Choice of the display of a session: the requested one, else that of the scene."""

from __future__ import annotations

import sys
from pathlib import Path

from mimics_app.contracts.errors import DeviceError, SceneError, UsageError
from mimics_app.contracts.ports.display_choice import DisplayChoice, kind_of_display, parse_display
from mimics_app.contracts.ports.display_port import Display
from mimics_app.rendering.visual.displays.display_kinds import check_display_file, make_display
from mimics_app.rendering.visual.displays.display_size import check_drawn_size
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.world.components.systems import DisplaySettings
from mimics_app.world.files.reading.paths import PathFault, find_file
from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_display", "chosen_display", "open_display"]


def open_display(scene: Scene, requested: str, surface: Surface) -> Display:
    """Open the display of a session; a replacement is reported on stderr.

    Args:
        scene: The scene, with further settings in `systems.display`.
        requested: KIND or KIND:FILE, "" for the scene's.
        surface: Surface whose context the display uses.

    Raises:
        SceneError: The scene's display needs a file, or its file is faulty.
        DeviceError: The display is not available, or its picture is too large to be drawn.
    """
    from mimics_app.rendering.visual.surfaces.capabilities import read_capabilities

    settings = scene.system(DisplaySettings) or DisplaySettings()
    display, notice = make_display(chosen_display(scene, requested), settings, surface)
    if notice:
        sys.stderr.write(f"mimics: {notice}\n")
    try:
        check_drawn_size(display.kind, display.drawn_size(surface.size), read_capabilities(surface.ctx).texture_size)
    except DeviceError:
        display.close()
        raise
    return display


def check_display(scene: Scene, requested: str) -> None:
    """Read the file of a display, so that a faulty one is reported before anything starts.

    Raises:
        SceneError: The scene's display needs a file, or its file is faulty.
    """
    check_display_file(chosen_display(scene, requested))


def chosen_display(scene: Scene, requested: str) -> DisplayChoice:
    """Return kind and file of the display: the requested ones, else the scene's, whose file is beside the scene."""
    if requested:
        return parse_display(requested)
    settings = scene.system(DisplaySettings) or DisplaySettings()
    if not settings.file or kind_of_display(settings.kind).file == "never":
        try:
            return parse_display(settings.kind)
        except UsageError as error:
            raise SceneError(scene.issue("/systems/display", error.what, "give its file")) from None
    try:
        file: Path = find_file(settings.file, scene.path.parent, scene.root)
    except PathFault as fault:
        raise SceneError(scene.issue("/systems/display/file", fault.what, fault.fix)) from None
    return DisplayChoice(settings.kind, str(file))
