"""Shapes a haptic object may be touched by, and the feel of a surface (D2.1 4.2.8). SI units."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from msgspec import Meta

from mimics_app.world.components.bounds import Quaternion
from mimics_app.world.components.registry import Component

__all__ = [
    "DEFAULT_SURFACE",
    "CapsuleSolid",
    "CubeSolid",
    "CylinderSolid",
    "MeshSolid",
    "Solid",
    "SphereSolid",
    "TouchSurface",
    "surface_of",
]

_LARGEST = 1e3
_STIFFEST = 1e6

Length = Annotated[float, Meta(gt=0, le=_LARGEST)]
NotNegative = Annotated[float, Meta(ge=0, le=_STIFFEST)]
Share = Annotated[float, Meta(ge=0, le=100)]
Coordinate = Annotated[float, Meta(ge=-_LARGEST, le=_LARGEST)]
Point = tuple[Coordinate, Coordinate, Coordinate]
Law = Literal["spring_damper", "hunt_crossley"]


class TouchSurface(Component, frozen=True):
    """How a surface feels. A shape takes what it leaves out from its object."""

    stiffness: Annotated[
        Annotated[float, Meta(gt=0, le=_STIFFEST)] | None,
        Meta(description="[N/m], Hunt-Crossley [N/m^exponent]; nowhere said: 1000"),
    ] = None
    damping: Annotated[
        NotNegative | None, Meta(description="[N s/m], Hunt-Crossley: a of (1 + a d') [s/m]; nowhere said: 5, or 1")
    ] = None
    friction_static: Annotated[Share | None, Meta(description="Until it slides; nowhere said: as friction_dynamic")] = (
        None
    )
    friction_dynamic: Annotated[Share | None, Meta(description="While it slides; nowhere said: 0, smooth")] = None
    friction_stiffness: Annotated[
        NotNegative | None, Meta(description="Sideways, while it sticks [N/m]; nowhere said: as stiffness")
    ] = None
    law: Annotated[
        Law | None,
        Meta(
            description="spring_damper: max(0, k d + b d'); hunt_crossley: k d^n (1 + a d'), no step at first touch; "
            "nowhere said: spring_damper"
        ),
    ] = None
    exponent: Annotated[
        Annotated[float, Meta(ge=1, le=3)] | None, Meta(description="n of Hunt-Crossley; nowhere said: 1.5")
    ] = None
    texture_height: Annotated[
        Annotated[float, Meta(ge=0, le=0.01)] | None, Meta(description="Of its ripples [m]; nowhere said: 0, smooth")
    ] = None
    texture_length: Annotated[Length | None, Meta(description="From ripple to ripple [m]; nowhere said: 0.005")] = None
    material: Annotated[str | None, Meta(description="Any name, for sounds and events; nowhere said: none")] = None


DEFAULT_SURFACE = TouchSurface(
    stiffness=1000.0,
    damping=None,  # of another unit for each law, see `surface_of`
    friction_static=None,
    friction_dynamic=None,
    friction_stiffness=None,
    law="spring_damper",
    exponent=1.5,
    texture_height=0.0,
    texture_length=0.005,
    material="",
)
"""What is used where neither a shape nor its object says anything."""

_DEFAULT_DAMPING = {"spring_damper": 5.0, "hunt_crossley": 1.0}


def surface_of(*layers: TouchSurface) -> TouchSurface:
    """What holds of several layers, the most special first: the first of each field that is given; none is None."""
    values: dict[str, Any] = {
        name: next((value for layer in layers if (value := getattr(layer, name)) is not None), None)
        for name in TouchSurface.__struct_fields__
    }
    for name, value in values.items():
        if value is None:
            values[name] = getattr(DEFAULT_SURFACE, name)
    if values["damping"] is None:
        values["damping"] = _DEFAULT_DAMPING[values["law"]]
    static, dynamic = values["friction_static"], values["friction_dynamic"]
    values["friction_dynamic"] = dynamic if dynamic is not None else (static or 0.0)
    values["friction_static"] = static if static is not None else values["friction_dynamic"]
    values["friction_stiffness"] = values["friction_stiffness"] or 0.0
    return TouchSurface(**values)


class _Placed(TouchSurface, frozen=True):
    """A shape at its place in the object."""

    position: Annotated[Point, Meta(description="Of its middle, in the object's frame [m]")] = (0.0, 0.0, 0.0)
    rotation: Annotated[Quaternion, Meta(description="In the object's frame, unit quaternion x, y, z, w")] = (
        0.0,
        0.0,
        0.0,
        1.0,
    )


class CubeSolid(_Placed, frozen=True, kw_only=True, tag="cube", tag_field="shape"):
    """Box of any edges about its middle."""

    size: Annotated[tuple[Length, Length, Length], Meta(description="Edges along x, y, z [m]")]
    rounding: Annotated[float, Meta(ge=0, le=_LARGEST, description="Radius of its edges [m]; 0: sharp")] = 0.0


class SphereSolid(_Placed, frozen=True, kw_only=True, tag="sphere", tag_field="shape"):
    """Sphere about its middle."""

    radius: Annotated[Length, Meta(description="[m]")]


class CylinderSolid(_Placed, frozen=True, kw_only=True, tag="cylinder", tag_field="shape"):
    """Cylinder about its own y axis."""

    radius: Annotated[Length, Meta(description="[m]")]
    length: Annotated[Length, Meta(description="From end to end [m]")]
    rounding: Annotated[float, Meta(ge=0, le=_LARGEST, description="Radius of its rims [m]; 0: sharp")] = 0.0


class CapsuleSolid(_Placed, frozen=True, kw_only=True, tag="capsule", tag_field="shape"):
    """Cylinder about its own y axis with half spheres at its ends."""

    radius: Annotated[Length, Meta(description="[m]")]
    length: Annotated[Length, Meta(description="Between the centres of the half spheres [m]")]


class MeshSolid(_Placed, frozen=True, kw_only=True, tag="mesh", tag_field="shape"):
    """Triangles of a model, or something simpler that fits round them."""

    source: Annotated[str, Meta(description='"asset", "asset#/nodes/Name" or "asset#/meshes/Name", as of a mesh')]
    fit: Annotated[
        Literal["mesh", "hull", "box", "sphere"],
        Meta(description="The triangles themselves, their convex hull, or the box or sphere round them"),
    ] = "mesh"
    scale: Annotated[float, Meta(ge=1e-6, le=1e6, description="Factor on all its lengths")] = 1.0


Solid = CubeSolid | SphereSolid | CylinderSolid | CapsuleSolid | MeshSolid
