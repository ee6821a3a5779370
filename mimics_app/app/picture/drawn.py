"""Result of a command that draws files: the files and the driver."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mimics_app.rendering.visual.frame_set import FrameSet
from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["Drawn"]


@dataclass(frozen=True, slots=True)
class Drawn:
    """Pictures on disk.

    Attributes:
        files: In the order they were drawn.
        backend: Of the surface: "window", "egl" or "osmesa".
        gl: Version and driver.
        ms_median: Time of a frame [ms].
    """

    files: list[Path]
    backend: str
    gl: str
    ms_median: float

    @classmethod
    def on(cls, surface: Surface, frames: FrameSet) -> Drawn:
        """Return the result of drawing on a surface, which is still open."""
        return cls(frames.files, surface.backend, surface.driver, frames.ms_median)

    def as_dict(self) -> dict[str, Any]:
        """The keys of `--json`."""
        return {"backend": self.backend, "gl": self.gl, "files": self.files, "ms_median": self.ms_median}
