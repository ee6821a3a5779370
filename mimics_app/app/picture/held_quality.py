"""Quality that a scene's live picture held on this machine, at which its next run starts.

It is kept by scene, profile, picture size and driver.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec

from mimics_app.contracts.machine_memory import MachineMemory, machine_file

if TYPE_CHECKING:
    from mimics_app.app.picture.picture import Picture

__all__ = ["Held", "held_quality", "measure_frame_ms", "name_of_picture"]

_FRAMES = 3
"""Number of frames drawn to time one quality; the first one, in which the driver compiles, does not count."""


class Held(msgspec.Struct, frozen=True):
    """Quality that a picture held.

    Attributes:
        steps: Names of all levels, in the order in which they are lowered.
        growths: Ratio of the frame time without a level to that with it, for each lowered level; >= 1.
        guessed: Whether each of these was measured before the first frame.
    """

    steps: tuple[str, ...]
    growths: tuple[float, ...]
    guessed: tuple[bool, ...]


def held_quality() -> MachineMemory[Held]:
    """Return what this machine's pictures held, by `name_of_picture`."""
    return MachineMemory(Held, machine_file("quality"))


def name_of_picture(picture: Picture, scene: str, profile: str) -> str:
    """Return everything the cost of a picture depends on, as one line."""
    surface = picture.surface
    width, height = surface.size
    return f"{scene}, {profile}, {width}x{height}, {surface.ctx.info['GL_RENDERER']}"


def measure_frame_ms(picture: Picture) -> float:
    """Return the time of a complete frame of the present view, to its last pixel [ms]: the shortest of a few."""
    frames = []
    for _ in range(_FRAMES):
        picture.renderer.forget_picture()
        frames.append(picture.renderer.draw_finished(picture.views).cpu_ms)
    return min(frames[1:])
