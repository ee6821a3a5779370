"""Windows of the size a person prefers: the size last given by hand is remembered."""

from __future__ import annotations

from mimics_app.app.terminal.user_files import read_config, write_config
from mimics_app.rendering.visual.surfaces.contexts import create_window
from mimics_app.rendering.visual.surfaces.surface import Size, Surface

__all__ = ["open_window", "remember_size"]

_FILE, _KEY = "window", "size"
_LARGEST = 16384
"""Largest remembered width and height [px]: that of a texture."""


def open_window(
    size: Size | None,
    title: str,
    *,
    vsync: bool = True,
    stereo: bool = False,
    scene: bool = True,
    visible: bool = True,
) -> Surface:
    """Open a window.

    Args:
        size: Width and height [px]; None: as a person last gave a window, else as suits the monitor.
        title: Title of the window.
        vsync: See `create_window`.
        stereo: See `create_window`.
        scene: See `create_window`.
        visible: See `create_window`.

    Raises:
        DeviceError: See `create_window`.
    """
    return create_window(size or _remembered(), title, vsync=vsync, stereo=stereo, scene=scene, visible=visible)


def remember_size(surface: Surface) -> None:
    """Remember the size of a window, full screen aside, for the next one if it is not the size it was opened with."""
    size = surface.resized_to
    if size is not None:
        write_config(_FILE, {_KEY: size})


def _remembered() -> Size | None:
    """Return the remembered size; None where there is none, or the file holds another thing."""
    size = read_config(_FILE).get(_KEY)
    if not isinstance(size, list) or [type(side) for side in size] != [int, int]:
        return None
    width, height = size
    return (width, height) if 1 <= min(size) <= max(size) <= _LARGEST else None
