"""The vibrators of a session."""

from __future__ import annotations

from mimics_app.rendering.tactile.vibrators import NoVibrators, Vibrators
from mimics_app.world.components.tactile import TactileSettings
from mimics_app.world.scene.scene import Scene

__all__ = ["open_tactile"]


def open_tactile(scene: Scene, *, live: bool) -> Vibrators:
    """What drives the scene's vibrators: its line in a live session, else nothing but the record.

    Raises:
        DeviceError: the line cannot be opened.
    """
    settings = scene.system(TactileSettings) or TactileSettings()
    if not live or not settings.port:
        return NoVibrators()
    from mimics_app.rendering.tactile.vibrators import SerialVibrators

    return SerialVibrators(settings.port, settings.vibrators, settings.baud)
