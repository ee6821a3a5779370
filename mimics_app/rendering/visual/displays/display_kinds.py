"""Builders of the displays: built-in ones, and plug-ins by entry points of the group mimics_app.displays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.display_choice import PLUGINS, DisplayChoice
from mimics_app.contracts.ports.display_port import Display
from mimics_app.contracts.ports.plugins import PluginError
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

__all__ = ["BUILT_IN", "DisplayBuilder", "DisplayRequest", "check_display_file", "make_display"]


@dataclass(frozen=True, slots=True)
class DisplayRequest:
    """Arguments of a display's builder.

    Attributes:
        kind: Kind of the display; one builder may serve several.
        file: Its file, "" for none.
        settings: The scene's settings of eyes and screen.
        surface: Surface whose context a headset's runtime uses.
    """

    kind: str
    file: str
    settings: DisplaySettings
    surface: Surface


DisplayBuilder = Callable[[DisplayRequest], Display]
"""Type of the entry points of the group `mimics_app.displays`; raises SceneError for a faulty file, and DeviceError
where the display is not available."""


def _desktop(_: DisplayRequest) -> Display:
    return DesktopDisplay()


def _stereo(request: DisplayRequest) -> Display:
    settings = request.settings
    return StereoDisplay(request.kind, settings.ipd, settings.screen_distance, swap=settings.swap_eyes)


def _walls(request: DisplayRequest) -> Display:
    return WallDisplay(request.kind, load_walls(Path(request.file)))


def _headset_spec(request: DisplayRequest) -> HeadsetSpec:
    return load_headset(Path(request.file)) if request.file else HeadsetSpec()


def _raw_headset(request: DisplayRequest) -> Display:
    return RawHeadset(_headset_spec(request))


def _simulated_headset(request: DisplayRequest) -> Display:
    return HeadsetDisplay(request.kind, SimulatedRuntime(_headset_spec(request)))


def _openxr(request: DisplayRequest) -> Display:
    from mimics_app.rendering.visual.displays.openxr_runtime import OpenXrRuntime, no_runtime

    if why := no_runtime():
        raise DeviceError(why)
    return HeadsetDisplay("openxr", OpenXrRuntime(request.surface.backend))


BUILT_IN: dict[str, DisplayBuilder] = {
    "desktop": _desktop,
    **dict.fromkeys(STEREO_KINDS, _stereo),
    "wall": _walls,
    "cave": _walls,
    "hmd": _raw_headset,
    "openxr": _openxr,
    "sim-hmd": _simulated_headset,
}
"""Builders of the kinds of `display_choice.DISPLAY_KINDS`."""


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
    request = DisplayRequest(choice.kind, choice.file, settings, surface)
    try:
        return _find_builder(choice.kind)(request), ""
    except DeviceError as error:
        if choice.kind != "openxr":
            raise
        return DesktopDisplay(), f"{error}: the picture is shown on the desktop"


def check_display_file(choice: DisplayChoice) -> None:
    """Read the file of a built-in display, so that a faulty one is reported before anything starts.

    Raises:
        SceneError: The file is faulty.
    """
    if choice.file and choice.kind in BUILT_IN:
        (load_walls if BUILT_IN[choice.kind] is _walls else load_headset)(Path(choice.file))


def _find_builder(kind: str) -> DisplayBuilder:
    """Return the builder of a kind that exists.

    Raises:
        DeviceError: Its plug-in cannot be loaded.
    """
    if kind in BUILT_IN:
        return BUILT_IN[kind]
    try:
        return cast(DisplayBuilder, PLUGINS.load(kind))
    except PluginError as error:
        raise DeviceError(f'the display "{kind}" is not available: {error}') from error
