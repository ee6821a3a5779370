"""Types of numbers that the structs of a task share, with their limits."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

__all__ = ["NotNegative", "Positive", "Seconds", "Share", "Vec3"]

Seconds = Annotated[float, Meta(ge=0.0, le=86_400.0)]
Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]
Share = Annotated[float, Meta(ge=0.0, le=1.0)]
Vec3 = tuple[float, float, float]
