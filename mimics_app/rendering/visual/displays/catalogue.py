"""Factory of all kinds of display."""

from __future__ import annotations

from pathlib import Path
from typing import cast

from mimics_app.contracts.display_choice import DISPLAY_KINDS, DisplayChoice
from mimics_app.contracts.display_port import PLUGINS, Display, DisplayBuilder, DisplayRequest
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.plugins import PluginError
from mimics_app.rendering.visual.displays.desktop import DesktopDisplay
from mimics_app.rendering.visual.displays.headset import RawHeadset
from mimics_app.rendering.visual.displays.headset_file import HeadsetSpec, load_headset
from mimics_app.rendering.visual.displays.headset_session import HeadsetDisplay
from mimics_app.rendering.visual.displays.simulated_headset import SimulatedRuntime
from mimics_app.rendering.visual.displays.stereo import STEREO_KINDS, StereoDisplay
from mimics_app.rendering.visual.displays.wall_file import load_walls
from mimics_app.rendering.visual.displays.walls import WallDisplay
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.world.components.systems import DisplaySettings

__all__ = ["find_builder", "make_display"]


def make_display(choice: DisplayChoice, settings: DisplaySettings, surface: Surface) -> tuple[Display, str]:
    """Return the display, and a message where it is not the requested one, else "".

    Args:
        choice: Kind and file.
        settings: The scene's settings of eyes and screen.
        surface: Surface whose context a headset's runtime uses.

    Raises:
        SceneError: the display's file is invalid.
        DeviceError: the display is not available, and a plain window is no replacement.
    """
    kind, file = choice.kind, Path(choice.file)
    if kind not in DISPLAY_KINDS:
        return find_builder(kind)(DisplayRequest(choice.file, settings.ipd, settings.screen_distance)), ""
    if kind in STEREO_KINDS:
        return StereoDisplay(kind, settings.ipd, settings.screen_distance, swap=settings.swap_eyes), ""
    if kind in ("wall", "cave"):
        return WallDisplay(kind, load_walls(file)), ""
    if kind in ("hmd", "sim-hmd"):
        spec = load_headset(file) if choice.file else HeadsetSpec()
        return (RawHeadset(spec) if kind == "hmd" else HeadsetDisplay(kind, SimulatedRuntime(spec))), ""
    if kind == "openxr":
        return _openxr(surface)
    return DesktopDisplay(), ""


def find_builder(kind: str) -> DisplayBuilder:
    """Return the builder of a plug-in's display.

    Raises:
        DeviceError: The plug-in cannot be loaded.
    """
    try:
        return cast(DisplayBuilder, PLUGINS.load(kind))
    except PluginError as error:
        raise DeviceError(f'the display "{kind}" is not available: {error}') from error


def _openxr(surface: Surface) -> tuple[Display, str]:
    """Return the headset, or a plain display and the reason in one line."""
    from mimics_app.rendering.visual.displays.openxr_runtime import OpenXrRuntime, no_runtime

    why = no_runtime()
    if not why:
        try:
            return HeadsetDisplay("openxr", OpenXrRuntime(surface.backend)), ""
        except DeviceError as error:
            why = str(error)
    return DesktopDisplay(), f"{why}: the picture is shown on the desktop"
