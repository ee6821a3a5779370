"""Quality that a scene's live picture held on this machine, at which its next run starts.

It is kept in a file beside the compiled kernels, by scene, profile, picture size and driver, and replaced after every
run. A file that cannot be read or written is ignored.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

if TYPE_CHECKING:
    from mimics_app.app.picture.picture import Picture

__all__ = ["Held", "HeldQuality", "measure_frame_ms", "name_of_picture"]

_FRAMES = 3
"""Number of frames drawn to time one quality; the first one, in which the driver compiles, does not count."""

_MAX_KEPT = 500
"""Largest number of pictures in the file; the oldest are removed."""


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


class HeldQuality:
    """The file.

    Args:
        file: Path of the file; None: that of this machine.
    """

    def __init__(self, file: Path | None = None) -> None:
        self._file = file or _machine_file()

    def find(self, picture: str) -> Held | None:
        """Return the quality a picture held, by `name_of_picture`; None where it is unknown."""
        return self._read().get(picture)

    def keep(self, picture: str, held: Held) -> None:
        """Write the quality that a picture held."""
        if self._file is None:
            return
        known = {name: was for name, was in self._read().items() if name != picture}
        newest = dict(list(known.items())[-_MAX_KEPT + 1 :])
        written = self._file.with_suffix(".part")
        with suppress(OSError):
            written.write_bytes(msgspec.json.encode({**newest, picture: held}))
            written.replace(self._file)

    def _read(self) -> Mapping[str, Held]:
        if self._file is None:
            return {}
        with suppress(OSError, ValueError, RecursionError):
            return msgspec.convert(json.loads(self._file.read_bytes()), dict[str, Held])
        return {}


def _machine_file() -> Path | None:
    from mimics_app.contracts.kernel_cache import cache_folder
    from mimics_app.contracts.machine import describe_machine

    return None if cache_folder is None else cache_folder.parent / f"quality-{describe_machine().key}.json"


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
