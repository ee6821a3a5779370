"""Levels of detail of round primitives by fewer facets, with exact errors."""

from __future__ import annotations

import math

from msgspec.structs import replace

from mimics_app.world.components.shapes import CapsuleShape, Shape, SphereShape, TorusShape
from mimics_app.world.content.meshes.primitives import torus_sides
from mimics_app.world.graph.levels import coverages_of

__all__ = ["PIXELS", "shape_levels"]

PIXELS = 0.5
"""Maximum error of a level in a picture of `COVERED_PICTURE` [px]."""

_MIN_SEGMENTS = 24
"""Facets around a shape from which levels of detail pay: some 500 triangles."""

_COARSEST_SEGMENTS = 8
"""Minimum facets of the coarsest level."""


def shape_levels(shape: Shape) -> tuple[list[Shape], tuple[float, ...]]:
    """Return the levels of detail of a shape, the shape itself first, and the smallest coverage for each.

    Flat shapes, boxes and shapes of few facets have one level. Each level has half the facets of the one before.
    """
    if not isinstance(shape, SphereShape | CapsuleShape | TorusShape) or shape.segments < _MIN_SEGMENTS:
        return [shape], (0.0,)
    levels: list[SphereShape | CapsuleShape | TorusShape] = [shape]
    while levels[-1].segments // 2 >= _COARSEST_SEGMENTS:
        levels.append(replace(levels[-1], segments=levels[-1].segments // 2))
    errors = [_error(level) - _error(shape) for level in levels]
    coverages = coverages_of(_radius(shape), errors, PIXELS)
    return list(levels), coverages


def _radius(shape: SphereShape | CapsuleShape | TorusShape) -> float:
    """Return the radius of the bounding sphere [m]."""
    match shape:
        case SphereShape():
            return shape.radius
        case CapsuleShape():
            return shape.radius + 0.5 * shape.length
        case TorusShape():
            return shape.radius + shape.bar_radius


def _error(shape: SphereShape | CapsuleShape | TorusShape) -> float:
    """Return the largest distance of the exact surface from the facets [m], above the centre of a facet."""
    around = 1.0 - math.cos(math.pi / shape.segments)
    if isinstance(shape, TorusShape):
        bar = 1.0 - math.cos(math.pi / torus_sides(shape.segments))
        return (shape.radius + shape.bar_radius) * around + shape.bar_radius * bar
    return shape.radius * (2.0 - around) * around
