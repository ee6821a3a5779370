"""Contact test of a box with rounded edges: all points within `reach` of a core box, (14) with the face of entry held.

A sharp box has a core of its own size and a reach of 0. The ball of a point adds its radius to the reach.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.maths.vec import fill
from mimics_app.rendering.haptic.kernels.contact import cube, remember

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ContactRecord

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
def _still_held(p: Vec, core: Vec, reach: float, contact: ContactRecord) -> bool:
    """True while the point is behind the face by which it entered the core, and not beside that face.

    However far behind: a point pressed through a plate is still pushed back to where it came from.
    """
    face = contact.feature
    if contact.inside == 0 or face == SHELL or face == 0:
        return False
    for i in range(3):
        if i == abs(face) - 1:
            along = p[i] if face > 0 else -p[i]
            if not along <= 0.5 * core[i]:
                return False
        elif not abs(p[i]) < 0.5 * core[i] + reach:
            return False
    return True


@kernel
def _faces(p: Vec, core: Vec) -> int:
    """Face in front of which the point is; 0: in front of an edge or corner."""
    face = 0
    for i in range(3):
        if abs(p[i]) >= 0.5 * core[i]:
            if face != 0:
                return 0
            face = i + 1 if p[i] > 0.0 else -i - 1
    return face


@kernel
def _went_through(p: Vec, core: Vec, contact: ContactRecord) -> bool:
    """True for a point in the shell that was in the shell before the opposite face: it passed the core in one tick."""
    if contact.inside == 0 or contact.feature != SHELL:
        return False
    face = _faces(p, core)
    return face != 0 and face == -_faces(contact.previous, core)


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
    point entered the core is held (Figure 27) until the point is beside that face or in front of it again: on the other
    side of a thin plate too, as by a proxy on the face.

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
    if _went_through(p, core, contact):
        contact.feature = _faces(contact.previous, core)
    distance = _distance(p, core)
    if _still_held(p, core, reach, contact):
        axis = abs(contact.feature) - 1
        sign = 1.0 if contact.feature > 0 else -1.0
        contact.depth = 0.5 * core[axis] - sign * p[axis] + reach
        fill(contact.normal, 0.0)
        contact.normal[axis] = sign
    elif 0.0 < distance < reach:
        _shell(p, core, reach, distance, contact)
    else:
        contact.depth = 0.0
        contact.feature = 0
    contact.inside = contact.depth > 0.0
    remember(p, contact)
