"""Speed of the hand."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from mimics_app.dsp.motion import Motion, motion_features

__all__ = ["CHANNEL", "Speed"]


class Speed(Motion):
    """Speed of the hand [m/s]."""

    name: ClassVar[str] = "speed"
    unit: ClassVar[str] = "m/s"
    part: ClassVar[str] = "hand"
    features: ClassVar[Mapping[str, str]] = dict(zip(motion_features(part), (unit, "1/s", "1"), strict=True))
    least: ClassVar[float] = 0.01


CHANNEL = Speed
