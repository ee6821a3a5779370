"""Contact test of a point's ball with any analytic shape: depth, normal and feature, in the frame of the shape."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.rendering.haptic.kernels.contact import sphere, wall
from mimics_app.rendering.haptic.kernels.objects.shapes_box import box
from mimics_app.rendering.haptic.kernels.objects.shapes_round import capsule, cylinder

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ContactRecord, ContactScratchRecord, ShapeRecord

__all__ = ["probe_shape"]


@kernel
def probe_shape(shape: ShapeRecord, scratch: ContactScratchRecord, contact: ContactRecord) -> None:
    """Find depth and normal of the present point in any analytic shape.

    Args:
        shape: SHAPE row of the present shape.
        scratch: CONTACT_SCRATCH record with p, v and radius; its vectors a and b are overwritten.
        contact: Record of `CONTACT`, updated; depth 0 outside.
    """
    p, v, radius = scratch.p, scratch.v, scratch.radius
    if shape.kind == ShapeKind.SPHERE:
        sphere(p, v, shape.size[0] + radius, contact)
    elif shape.kind == ShapeKind.BOX:
        core = scratch.a
        for i in range(3):
            core[i] = shape.size[i] - 2.0 * shape.rounding
        box(p, v, core, shape.rounding + radius, contact)
    elif shape.kind == ShapeKind.CYLINDER:
        core_length = shape.size[1] - 2.0 * shape.rounding
        cylinder(p, v, shape.size[0] - shape.rounding, core_length, shape.rounding + radius, contact)
    elif shape.kind == ShapeKind.CAPSULE:
        capsule(p, v, shape.size[0] + radius, shape.size[1], scratch.a, scratch.b, contact)
    elif shape.kind == ShapeKind.WALL:
        p[2] -= radius
        wall(p, contact)
        p[2] += radius
