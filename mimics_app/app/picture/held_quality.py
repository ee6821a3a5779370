"""Quality that a scene's live picture held on this machine, at which its next run starts.

It is kept by scene, profile, picture size and driver.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import msgspec

from mimics_app.contracts.system.machine_memory import MachineMemory, machine_file

if TYPE_CHECKING:
    from mimics_app.app.picture.picture import Picture

__all__ = ["Held", "held_quality", "measure_frame_ms", "name_of_picture"]

_FRAMES = 4
"""Even number of frames drawn to time one quality; the first two, in which the driver compiles, do not count."""


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


def measure_frame_ms(picture: Picture, nudge: Callable[[], None] | None = None) -> float:
    """Return the time of a frame of the present view, to its last pixel [ms]: the shortest of a few.

    Args:
        picture: The picture.
        nudge: Changes the world before each frame as a frame of the run does, so that what stays is drawn as little as
            then; None: each frame is drawn as a whole.
    """
    picture.renderer.forget_picture()
    frames = []
    for _ in range(_FRAMES):
        if nudge is None:
            picture.renderer.forget_picture()
        else:
            nudge()
        frames.append(picture.renderer.draw_finished(picture.views).cpu_ms)
    return min(frames[2:])
