"""Size of a new window, from the work areas of the monitors [px]."""

from __future__ import annotations

from types import ModuleType

from mimics_app.rendering.visual.surfaces.surface import Size

__all__ = ["on_the_desktop", "smallest_size", "usual_size"]

_SMALLEST = (1280, 720)
"""Size at a content scale of 1 in which the launcher and the board of a task are read at arm's length [px]."""
_SHARE = 2.0 / 3.0
"""Share of the work area's width and height: 1280x720 on a monitor of 1920x1080, 2560x1440 on one of 3840x2160."""


def usual_size(glfw: ModuleType) -> Size:
    """Return a size of 16:9 that suits the primary monitor; text grows with the window, so it stays readable."""
    area = _work_area(glfw)
    width = max(smallest_size(glfw)[0], _SHARE * min(area[0], area[1] * _SMALLEST[0] / _SMALLEST[1]))
    return round(width), round(width * _SMALLEST[1] / _SMALLEST[0])


def smallest_size(glfw: ModuleType) -> Size:
    """Return the smallest size with readable text; it grows with the content scale where GLFW counts pixels."""
    monitor = glfw.get_primary_monitor()
    counts_pixels = glfw.get_platform() in (glfw.PLATFORM_X11, glfw.PLATFORM_WIN32)
    scale = max(1.0, glfw.get_monitor_content_scale(monitor)[0]) if monitor and counts_pixels else 1.0
    return round(_SMALLEST[0] * scale), round(_SMALLEST[1] * scale)


def on_the_desktop(glfw: ModuleType, size: Size) -> Size:
    """Limit a size to that of all monitors' work areas together [px]."""
    areas = [glfw.get_monitor_workarea(monitor) for monitor in glfw.get_monitors()]
    areas = [area for area in areas if area[2] > 0 and area[3] > 0]
    if not areas:
        return size
    width = max(x + w for x, _, w, _ in areas) - min(x for x, _, _, _ in areas)
    height = max(y + h for _, y, _, h in areas) - min(y for _, y, _, _ in areas)
    return min(size[0], width), min(size[1], height)


def _work_area(glfw: ModuleType) -> Size:
    """Return width and height of the primary monitor's work area; (0, 0) where it is unknown."""
    monitor = glfw.get_primary_monitor()
    return glfw.get_monitor_workarea(monitor)[2:] if monitor else (0, 0)
