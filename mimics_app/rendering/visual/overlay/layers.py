"""Layers of the overlay, and the arrows of forces, contacts and handles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.figures.hud import Colour

__all__ = ["LAYERS", "Arrow", "Layer"]


Layer = Literal["graph", "wires", "bounds", "lights", "forces", "atlas"]
LAYERS: tuple[Layer, ...] = ("graph", "wires", "bounds", "lights", "forces", "atlas")
"""All layers, in the order of their keys."""


@dataclass(frozen=True, eq=False)
class Arrow:
    """An arrow of the layer "forces": origin and vector, both world [m], float64 [3]."""

    origin: F8
    vector: F8
    tint: Colour
