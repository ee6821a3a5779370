"""What all objects together do to the user in one tick."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.kernel import kernel

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import TotalsRecord

__all__ = ["TOTALS", "clear_totals"]

TOTALS = np.dtype(
    [
        ("shape_force", "f8", (3,)),  # of all touched shapes on the user, world [N]
        ("effect_force", "f8", (3,)),  # of all effects on the user, world [N]
        ("grip_force", "f8", (3,)),  # of what is held on the user, world [N]
        ("stiffness", "f8"),  # sum over what is touched or held [N/m], whatever its direction
        ("even_stiffness", "f8"),  # what of it counts in all directions alike: what is held, effects [N/m]
        ("even_damping", "f8"),  # its damping [N s/m]
        ("listed", "i8"),  # contacts in ObjectWork.touched
        ("touching", "i8"),  # (point, shape) pairs in contact
        ("static_touching", "i8"),  # those of them whose shape belongs to the static scene
        ("depth", "f8"),  # of the deepest of them [m]
        ("shape", "i8"),  # row of that shape, -1: none
        ("normal", "f8", (3,)),  # out of it, world, unit; kept from the last contact
        ("approach_speed", "f8"),  # rate of its depth [m/s]
        ("held", "i8"),  # row of the body that is gripped, -1: none
        ("crushed", "i8"),  # the same once the grip went beyond its crush_force, -1: it did not
        ("impact", "f8"),  # largest approach speed of bodies that began to touch in this tick [m/s]
        ("impact_force", "f8"),  # force of that contact [N]
        ("impact_a", "i8"),  # its bodies, STATIC: the scene; both STATIC: no impact
        ("impact_b", "i8"),
        ("impact_position", "f8", (3,)),  # world [m]
        ("impact_normal", "f8", (3,)),  # out of body b
        ("status", "i8"),  # 1: something was not finite
        ("left_out", "i8"),  # pairs of shapes that could not be looked at, where there were never so many; else 0
        ("quarantined", "i8"),  # row of the effect whose force field was put away in this tick, -1: none
    ],
    align=True,
)
"""Results of one tick; `normal` alone outlives it."""


@kernel
def clear_totals(totals: TotalsRecord) -> None:
    """Begin a tick: nothing touched, no force."""
    for i in range(3):
        totals.shape_force[i] = 0.0
        totals.effect_force[i] = 0.0
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
