"""Coarser forms of round shapes, and how far each lies from the round: levels of detail without a simplifier."""

from __future__ import annotations

import math

from msgspec.structs import replace

from mimics_app.world.components.shapes import CapsuleShape, Shape, SphereShape, TorusShape
from mimics_app.world.levels import coverages_of
from mimics_app.world.meshes.primitives import torus_sides

__all__ = ["PIXELS", "shape_levels"]

PIXELS = 0.5
"""Largest error of a level of a round shape [px] of a picture of `COVERED_PICTURE`."""

_FEWEST = 24
"""Facets round a shape from which coarser forms are worth having: some 500 triangles."""

_COARSEST = 8
"""Facets of the coarsest form."""


def shape_levels(shape: Shape) -> tuple[list[Shape], tuple[float, ...]]:
    """A shape with its coarser forms, the shape itself first, and the least coverage of the picture for each.

    Flat shapes, boxes, and what has few facets anyway, have one form. Each form has half the facets of the one before.
    """
    if not isinstance(shape, SphereShape | CapsuleShape | TorusShape) or shape.segments < _FEWEST:
        return [shape], (0.0,)
    forms: list[SphereShape | CapsuleShape | TorusShape] = [shape]
    while forms[-1].segments // 2 >= _COARSEST:
        forms.append(replace(forms[-1], segments=forms[-1].segments // 2))
    errors = [_error(form) - _error(shape) for form in forms]
    coverages = coverages_of(_radius(shape), errors, PIXELS)
    return list(forms), coverages


def _radius(shape: SphereShape | CapsuleShape | TorusShape) -> float:
    """Of the sphere about it [m]."""
    match shape:
        case SphereShape():
            return shape.radius
        case CapsuleShape():
            return shape.radius + 0.5 * shape.length
        case TorusShape():
            return shape.radius + shape.bar_radius


def _error(shape: SphereShape | CapsuleShape | TorusShape) -> float:
    """Farthest the round lies from the facets [m]: over the middle of a facet that is bent in both directions."""
    around = 1.0 - math.cos(math.pi / shape.segments)
    if isinstance(shape, TorusShape):
        bar = 1.0 - math.cos(math.pi / torus_sides(shape.segments))
        return (shape.radius + shape.bar_radius) * around + shape.bar_radius * bar
    return shape.radius * (2.0 - around) * around
