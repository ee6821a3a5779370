"""Result of a command that draws files: the files and the driver."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from mimics_app.rendering.visual.frame_set import FrameSet
from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["Drawn"]


@dataclass(frozen=True, slots=True)
class Drawn:
    """Pictures on disk; its fields are keys of `--json`.

    Attributes:
        backend: Backend of the surface: "window", "egl" or "osmesa".
        gl: OpenGL version and driver.
        files: Files in the order they were drawn.
        ms_median: Median time of a frame [ms].
    """

    backend: str
    gl: str
    files: list[Path]
    ms_median: float

    @classmethod
    def on(cls, surface: Surface, frames: FrameSet) -> Drawn:
        """Return the result of drawing on a surface, which is still open."""
        return cls(surface.backend, surface.driver, frames.files, frames.ms_median)
