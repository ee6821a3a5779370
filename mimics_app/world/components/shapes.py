"""Primitive shapes of scene files; `world.meshes.primitives` builds their meshes."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mimics_app.world.components.bounds import Angle, Extent, Length
from mimics_app.world.components.registry import Component

__all__ = ["BoxShape", "CapsuleShape", "CylinderShape", "PlaneShape", "RingShape", "Shape", "SphereShape", "TorusShape"]


class PlaneShape(Component, frozen=True, tag="plane", tag_field="shape"):
    """Rectangle in the xz plane, facing +y."""

    size: Annotated[tuple[Length, Length], Meta(description="Extent along x and z [m]")] = (1.0, 1.0)
    segments: Annotated[int, Meta(ge=1, le=256, description="Squares along each side")] = 1


class BoxShape(Component, frozen=True, tag="box", tag_field="shape"):
    """Box about the origin."""

    size: Annotated[tuple[Length, Length, Length], Meta(description="Extent along x, y, z [m]")] = (1.0, 1.0, 1.0)


class SphereShape(Component, frozen=True, tag="sphere", tag_field="shape"):
    """Sphere about the origin."""

    radius: Annotated[Length, Meta(description="Radius [m]")] = 0.5
    segments: Annotated[int, Meta(ge=3, le=512, description="Facets round the equator; half as many pole to pole")] = 32


class CylinderShape(Component, frozen=True, tag="cylinder", tag_field="shape"):
    """Closed cylinder about the y axis; a cone where `top_radius` is 0."""

    radius: Annotated[Length, Meta(description="Radius of the lower end [m]")] = 0.5
    top_radius: Annotated[
        Extent | None,
        Meta(description="Radius of the upper end [m]; absent: as `radius`"),
    ] = None
    height: Annotated[Length, Meta(description="Height [m]")] = 1.0
    segments: Annotated[int, Meta(ge=3, le=512, description="Facets round the axis")] = 32


class CapsuleShape(Component, frozen=True, tag="capsule", tag_field="shape"):
    """Cylinder about the y axis with half spheres at its ends."""

    radius: Annotated[Length, Meta(description="Radius [m]")] = 0.25
    length: Annotated[Length, Meta(description="Distance between the centres of the half spheres [m]")] = 0.5
    segments: Annotated[int, Meta(ge=4, le=512, description="Facets round the axis")] = 32


class RingShape(Component, frozen=True, tag="ring", tag_field="shape"):
    """Flat ring, or a sector of one, in the xz plane, facing +y; angle 0 is +x and pi/2 is -z."""

    inner_radius: Annotated[Extent, Meta(description="Inner radius [m]; 0: a disc")] = 0.25
    outer_radius: Annotated[Length, Meta(description="Outer radius [m]")] = 0.5
    start: Annotated[Angle, Meta(description="First angle [rad]")] = 0.0
    sweep: Annotated[float, Meta(gt=0, le=6.2832, description="Angle covered [rad]")] = 6.283185307179586
    segments: Annotated[int, Meta(ge=3, le=512, description="Facets along the arc")] = 48


class TorusShape(Component, tag="torus", tag_field="shape", frozen=True):
    """Round bar bent to a ring about the y axis."""

    radius: Annotated[Length, Meta(description="Radius of the bar's centre line [m]; beyond bar_radius")] = 0.5
    bar_radius: Annotated[Length, Meta(description="Radius of the bar [m]")] = 0.05
    segments: Annotated[int, Meta(ge=3, le=512, description="Facets round the ring")] = 64


Shape = PlaneShape | BoxShape | SphereShape | CylinderShape | CapsuleShape | RingShape | TorusShape
