"""The quality that a scene's live picture held on this machine: where its next run starts.

Kept per scene, picture size, driver and profile beside the compiled kernels. Written anew after every run, so that it
follows what the machine can do; a file that cannot be read or written is as good as none.
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
"""Frames drawn to time one quality; the first of them, in which a driver compiles, does not count."""

_MOST_KEPT = 500
"""Pictures kept in the file; of more, those kept longest go."""


class Held(msgspec.Struct, frozen=True):
    """What a picture held.

    Attributes:
        steps: Names of all levels, in the order they are given up.
        growths: Frame time without each level over that with it, as far as levels were given up; >= 1.
        guessed: Which of these are of frames drawn as a whole, before the first one.
    """

    steps: tuple[str, ...]
    growths: tuple[float, ...]
    guessed: tuple[bool, ...]


class HeldQuality:
    """The file.

    Args:
        file: Where; None: the place of this machine.
    """

    def __init__(self, file: Path | None = None) -> None:
        self._file = file or _machine_file()

    def find(self, picture: str) -> Held | None:
        """Return the quality a picture held, by `name_of_picture`; None where it is unknown."""
        return self._read().get(picture)

    def keep(self, picture: str, held: Held) -> None:
        """Take down what a picture held."""
        if self._file is None:
            return
        known = {name: was for name, was in self._read().items() if name != picture}
        newest = dict(list(known.items())[-_MOST_KEPT + 1 :])
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
    """How long drawing all that is seen now takes, to its last pixel [ms]: the shortest of a few frames."""
    frames = []
    for _ in range(_FRAMES):
        picture.renderer.forget_picture()
        frames.append(picture.renderer.draw_finished(picture.views).cpu_ms)
    return min(frames[1:])
