"""Angular speed of the head."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from mimics_app.dsp.motion import Motion, motion_features

__all__ = ["CHANNEL", "HeadMovement"]


class HeadMovement(Motion):
    """Angular speed of the head [rad/s]."""

    name: ClassVar[str] = "head"
    unit: ClassVar[str] = "rad/s"
    part: ClassVar[str] = "head"
    features: ClassVar[Mapping[str, str]] = dict(zip(motion_features(part), (unit, "1/s", "1"), strict=True))
    least: ClassVar[float] = 0.05


CHANNEL = HeadMovement
