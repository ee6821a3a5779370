"""What one frame cost."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["FrameStats"]


@dataclass(frozen=True, slots=True)
class FrameStats:
    """Cost of one `Renderer.draw`.

    Attributes:
        cpu_ms: From the call to its return [ms]; a software renderer draws within it, a GPU mostly after it.
        gpu_ms: The driver's own time for the frame [ms], or None where it is not requested or not measured.
        triangles: Sent to the driver, shadow pass included.
        draws: Calls to the driver.
        items: Sub-entities that could be drawn, all views together.
        culled: Of these, those outside their view's frustum.
        hidden: Of the rest, those behind something solid.
        tests: Of items or groups against frustums, all views together.
        bent: Vertices that were bent anew.
    """

    cpu_ms: float
    gpu_ms: float | None
    triangles: int
    draws: int
    items: int = 0
    culled: int = 0
    hidden: int = 0
    tests: int = 0
    bent: int = 0
