"""Results of all objects for one point of contact in one tick."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import TotalsRecord

__all__ = ["TOTALS", "clear_totals"]

TOTALS = np.dtype(
    [
        ("shape_force", "f8", (3,)),  # of all touched shapes on the user, world [N]
        ("effect_force", "f8", (3,)),  # of all effects on the user, world [N]
        ("ordered_force", "f8", (3,)),  # its part that shakes by order, and that of ripples, world [N]
        ("grip_force", "f8", (3,)),  # of the held body on the user, world [N]
        ("stiffness", "f8"),  # sum over contacts, effects and grip, of any direction [N/m]
        ("even_stiffness", "f8"),  # its isotropic part: of grip and effects [N/m]
        ("even_damping", "f8"),  # isotropic damping [N s/m]
        ("listed", "i8"),  # contacts in ObjectWork.touched
        ("touching", "i8"),  # (point, shape) pairs in contact
        ("static_touching", "i8"),  # the part of them with shapes of the static scene
        ("depth", "f8"),  # of the deepest contact [m]
        ("shape", "i8"),  # row of its shape, -1: none
        ("normal", "f8", (3,)),  # outward normal of its shape, world, unit; kept from the last contact
        ("approach_speed", "f8"),  # rate of its depth [m/s]
        ("held", "i8"),  # row of the gripped body, -1: none
        ("crushed", "i8"),  # row of the gripped body once the grasp exceeded its crush_force, -1: none
        ("impact", "f8"),  # largest approach speed of bodies whose contact began in this tick [m/s]
        ("impact_force", "f8"),  # force of that contact [N]
        ("impact_a", "i8"),  # bodies of that contact, STATIC: the scene; both STATIC: no impact
        ("impact_b", "i8"),
        ("impact_position", "f8", (3,)),  # world [m]
        ("impact_normal", "f8", (3,)),  # out of body b
        ("status", "i8"),  # 1: something was not finite
        ("left_out", "i8"),  # pairs of shapes beyond the capacity when their number is a new maximum, else 0
        ("quarantined", "i8"),  # row of the effect whose force field was quarantined in this tick, -1: none
    ],
    align=True,
)
"""Results of one tick; only `normal` is kept for the next."""


@kernel
def clear_totals(totals: TotalsRecord) -> None:
    """Clear the results at the begin of a tick."""
    for i in range(3):
        totals.shape_force[i] = 0.0
        totals.effect_force[i] = 0.0
        totals.ordered_force[i] = 0.0
        totals.grip_force[i] = 0.0
    totals.stiffness = 0.0
    totals.even_stiffness = 0.0
    totals.even_damping = 0.0
    totals.listed = 0
    totals.touching = 0
    totals.static_touching = 0
    totals.depth = 0.0
    totals.shape = -1
    totals.approach_speed = 0.0
    totals.held = -1
    totals.crushed = -1
    totals.impact = 0.0
    totals.impact_force = 0.0
    totals.impact_a = -1
    totals.impact_b = -1
    totals.status = 0
    totals.left_out = 0
    totals.quarantined = -1
