"""Contact test of a box with rounded edges: all points within `reach` of a core box, (14) with the face of entry held.

A sharp box has a core of its own size and a reach of 0. The ball of a point adds its radius to the reach.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.contact import cube, remember

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import ContactRecord

__all__ = ["SHELL", "box"]


SHELL = 9
"""Feature of a contact outside the core: faces and rounded edges as one smooth surface."""


@kernel
def _distance(p: Vec, core: Vec) -> float:
    """Distance from the core box, 0 inside it [m]."""
    total = 0.0
    for i in range(3):
        over = max(abs(p[i]) - 0.5 * core[i], 0.0)
        total += over * over
    return math.sqrt(total)


@kernel
def _in_core(p: Vec, core: Vec) -> bool:
    """True for a point inside the core."""
    for i in range(3):
        if not abs(p[i]) < 0.5 * core[i]:
            return False
    return True


@kernel
def _still_held(p: Vec, core: Vec, contact: ContactRecord) -> bool:
    """True while the point is behind the face by which it entered the core."""
    face = contact.feature
    if contact.inside == 0 or face == SHELL:
        return False
    axis = abs(face) - 1
    along = p[axis] if face > 0 else -p[axis]
    return along <= 0.5 * core[axis]


@kernel
def _shell(p: Vec, core: Vec, reach: float, distance: float, contact: ContactRecord) -> None:
    """Set depth in the offset surface and its normal, the direction from the core's closest point."""
    for i in range(3):
        over = max(abs(p[i]) - 0.5 * core[i], 0.0)
        contact.normal[i] = math.copysign(over, p[i]) / distance
    contact.depth = reach - distance
    contact.feature = SHELL


@kernel
def box(p: Vec, v: Vec, core: Vec, reach: float, contact: ContactRecord) -> None:
    """Find depth and normal in the offset surface of a box.

    In the shell around the core the normal is continuous around the edges. Deeper than the reach the face by which the
    point entered the core is held (Figure 27) until the point is outside of the shape or in front of that face again.

    Args:
        p: HIP' [m].
        v: Velocity of the HIP [m/s] in the object's frame; decides ties.
        core: Edge lengths of the core [m], shape [3], >= 0.
        reach: Radius around the core [m] >= 0: rounding of the box and radius of the point.
        contact: Record of `CONTACT`, updated; features +-1, +-2, +-3 as `cube`, or `SHELL`.
    """
    if _in_core(p, core):
        if contact.feature == SHELL:
            contact.inside = 0
        cube(p, v, core, contact)
        contact.depth += reach
        return
    distance = _distance(p, core)
    if distance < reach and _still_held(p, core, contact):
        axis = abs(contact.feature) - 1
        along = p[axis] if contact.feature > 0 else -p[axis]
        contact.depth = 0.5 * core[axis] - along + reach
    elif 0.0 < distance < reach:
        _shell(p, core, reach, distance, contact)
    else:
        contact.depth = 0.0
        contact.feature = 0
    contact.inside = contact.depth > 0.0
    remember(p, contact)
