"""Rules for the face of a box that the loop does not use, and the rate of depth of a contact on its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.contact import hold_face, in_box, leave, nearest_face

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ContactRecord

__all__ = ["cube_nearest_face", "rate_of_depth"]


@kernel
def rate_of_depth(v: Vec, contact: ContactRecord) -> float:
    """Rate of depth d' = -v.n [m/s], positive going in; v is the HIP's velocity in the object's frame (`to_object`)."""
    return -(v[0] * contact.normal[0] + v[1] * contact.normal[1] + v[2] * contact.normal[2])


@kernel
def cube_nearest_face(p: Vec, dimensions: Vec, contact: ContactRecord) -> None:
    """Test a box by the nearest face of every tick: rival of `cube` whose force flips where two faces are equally near.

    At 3 mm on 2 kN/m the force changes by sqrt(2) k d = 8.485 N within one tick.
    """
    if not in_box(p, dimensions):
        leave(p, contact)
        return
    contact.feature = nearest_face(p, dimensions)
    hold_face(p, dimensions, contact)
