"""The sky and the light that comes from everywhere."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Sky"]

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Sky:
    """Colours are linear RGB.

    Attributes:
        zenith: Straight up.
        horizon: At the horizon.
        ground: Below it.
        ambient: Factor on the sky's light on surfaces.
    """

    zenith: Colour = (0.18, 0.30, 0.52)
    horizon: Colour = (0.62, 0.70, 0.78)
    ground: Colour = (0.20, 0.19, 0.18)
    ambient: float = 0.5
