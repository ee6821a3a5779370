"""Cost of one frame."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["FrameStats"]


@dataclass(frozen=True, slots=True)
class FrameStats:
    """Cost of one `Renderer.draw`.

    Attributes:
        cpu_ms: Time from the call to its return [ms]; a software renderer draws within it, a GPU mostly after it.
        gpu_ms: GPU time of the frame [ms]; None where it is not requested or not measured.
        triangles: Triangles submitted, shadow pass included.
        draws: Draw calls.
        items: Sub-entities that could be drawn, summed over the views.
        culled: Of these, those outside their view's frustum.
        hidden: Of the rest, those that are occluded.
        tests: Frustum tests of items or groups, summed over the views.
        bent: Vertices that were skinned in this frame.
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
