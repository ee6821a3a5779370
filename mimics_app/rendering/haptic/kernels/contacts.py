"""Points of contact of one device: the state they share, their events, and their output.

Each point has its own STATE record with motion, forces and stability. Joints, safety state and command exist once per
device, in the first record.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.maths.vec import norm
from mimics_app.rendering.haptic.kernels.acting import drop_force
from mimics_app.rendering.haptic.kernels.safety import is_stopped, latch

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import SceneRecord, StateRecord, Table

__all__ = ["collect_events", "set_virtual_forces", "share_device_state", "stop_together"]


@kernel
def share_device_state(scene: SceneRecord, states: Table[StateRecord]) -> None:
    """Copy the state of device and safety from the first record to those of the other points."""
    state = states[0]
    for c in range(1, scene.contacts):
        other = states[c]
        other.tick = state.tick
        other.readable = state.readable
        other.age = state.age
        other.delay = state.delay
        other.safety = state.safety
        other.cause = state.cause
        other.ramp = state.ramp


@kernel
def set_virtual_forces(scene: SceneRecord, states: Table[StateRecord], forces: Vec) -> None:
    """Set the virtual force on each point of contact, of the tunnel that holds it and of all objects.

    Args:
        scene: SCENE record.
        states: STATE records; f_virt_world [N] is set.
        forces: Force of all objects on each point, world [N], x y z concatenated.
    """
    for c in range(max(1, scene.contacts)):
        state = states[c]
        for i in range(3):
            state.f_virt_world[i] = state.tunnel.force_world[i] + forces[3 * c + i]


@kernel
def stop_together(scene: SceneRecord, states: Table[StateRecord]) -> None:
    """Take the force off every point in the tick in which one of them, whichever, latched a stop."""
    state = states[0]
    for c in range(1, scene.contacts):
        if is_stopped(states[c]):
            latch(state, states[c].safety, states[c].cause)
    if not is_stopped(state):
        return
    share_device_state(scene, states)
    for c in range(max(1, scene.contacts)):
        drop_force(states[c])


@kernel
def collect_events(scene: SceneRecord, states: Table[StateRecord]) -> None:
    """Take over the events of the other points: a margin below 0, a cap or a fading force that began."""
    state = states[0]
    state.reported_margin = state.margin
    state.reported_share = state.stiffness_share
    state.reported_force = norm(state.f_wanted)
    state.swing_reported = state.swing.reported
    state.reported_swing = math.sqrt(state.swing.force)
    state.calm = state.swing.calm
    for c in range(1, scene.contacts):
        other = states[c]
        if other.margin_lost == 1 and state.margin_lost == 0:
            state.margin_lost = 1
            state.reported_margin = other.margin
        if other.cap_began == 1 and state.cap_began == 0:
            state.cap_began = 1
            state.reported_share = other.stiffness_share
        if other.limit_began == 1 and state.limit_began == 0:
            state.limit_began = 1
            state.reported_force = norm(other.f_wanted)
        if other.swing.reported == 1 and state.swing_reported == 0:
            state.swing_reported = 1
            state.reported_swing = math.sqrt(other.swing.force)
        other.calm = other.swing.calm
