"""Tangential friction of one contact in its tangent plane (or along one axis): an anchor that is dragged at the cone.

4.3.2 prints F_fric = +mu F_penal v_y/|v_y|: without the minus sign it drives the foot. It also has one tangential axis
only, and is 0/0 for a threshold of 0 at rest. With both corrected it still does not stick: a load F < mu F_N creeps at
threshold F/(mu F_N), while the text requires stiction. The law is therefore the anchor of Hayward and Armstrong; its
rivals are in the laboratory.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import FrictionRecord, MemoryRecord

__all__ = ["forget_friction", "hayward_armstrong"]


@kernel
def forget_friction(state: FrictionRecord) -> None:
    """Clear the state of a contact that ended, was teleported or disabled."""
    for i in range(2):
        state.anchor[i] = 0.0
        state.bristle[i] = 0.0
    state.touching = 0
    state.sticking = 0


@kernel
def hayward_armstrong(
    x: Vec, normal_force: float, mu: float, stiffness: float, state: FrictionRecord | MemoryRecord, out: Vec
) -> None:
    """Friction by position alone (Hayward & Armstrong 2000): a spring to an anchor that is dragged at the cone.

    F = -k_t (x - w), and w follows at distance mu F_N / k_t: no velocity enters, no drift, never outside the cone, and
    no stability limit beyond that of the spring k_t.

    Args:
        x: Position in the tangent plane [m], shape [1] or [2].
        normal_force: F_N [N] >= 0; 0 ends the contact.
        mu: Coefficient of friction.
        stiffness: k_t [N/m] > 0.
        state: Record of `FRICTION`; the anchor is set at first touch.
        out: Receives the force on the body [N], as x.
    """
    reach = mu * normal_force / stiffness
    if normal_force <= 0.0:
        state.touching = 0
    elif not state.touching:
        state.touching = 1
        for i in range(out.shape[0]):
            state.anchor[i] = x[i]
    distance = 0.0
    for i in range(out.shape[0]):
        out[i] = x[i] - state.anchor[i]
        distance += out[i] * out[i]
    distance = math.sqrt(distance)
    state.sticking = distance <= reach
    if not state.touching:
        for i in range(out.shape[0]):
            out[i] = 0.0
        return
    share = 1.0 if state.sticking else reach / distance
    for i in range(out.shape[0]):
        state.anchor[i] = x[i] - share * out[i]
        out[i] = -stiffness * share * out[i]
