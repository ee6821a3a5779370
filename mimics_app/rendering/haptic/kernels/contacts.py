"""Several points of contact of one device: what they have in common, and what leaves the loop of those behind it.

Each point has a STATE record of its own: motion, forces, what acts, its stability. What there is once for the device,
its joints, its safety state and its command, stands in the first one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.haptic import SafetyState, TripCause
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.safety import latch

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import SceneRecord, StateRecord, Table, TotalsRecord

__all__ = ["collect", "pass_on", "publish_others", "virtual_forces"]


_SAFE_STOP = int(SafetyState.SAFE_STOP)
_NOT_FINITE = int(TripCause.NOT_FINITE)


@kernel
def pass_on(scene: SceneRecord, states: Table[StateRecord]) -> None:
    """What the first state knows of the device and its safety, into those of the other points."""
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
def virtual_forces(scene: SceneRecord, states: Table[StateRecord], totals: Table[TotalsRecord]) -> None:
    """Virtual force on each point behind the first: of the shapes it touches, world [N]."""
    for c in range(1, scene.contacts):
        for i in range(3):
            states[c].f_virt_world[i] = totals[c].shape_force[i]


@kernel
def collect(scene: SceneRecord, states: Table[StateRecord]) -> None:
    """What happened at other points that concerns all: a stop, a margin below 0, a cap that began."""
    state = states[0]
    state.reported_margin = state.margin
    state.reported_share = state.stiffness_share
    for c in range(1, scene.contacts):
        other = states[c]
        if other.safety >= _SAFE_STOP and state.safety < _SAFE_STOP:
            latch(state, _SAFE_STOP, _NOT_FINITE)
        if other.margin_lost == 1 and state.margin_lost == 0:
            state.margin_lost = 1
            state.reported_margin = other.margin
        if other.cap_began == 1 and state.cap_began == 0:
            state.cap_began = 1
            state.reported_share = other.stiffness_share


@kernel
def publish_others(scene: SceneRecord, states: Table[StateRecord], totals: Table[TotalsRecord]) -> None:
    """The numbers of the points behind the first, into the first state, from where they leave the loop."""
    state = states[0]
    for c in range(1, scene.contacts):
        other, k = states[c], c - 1
        for i in range(3):
            state.others_world[3 * k + i] = other.hip_world[i]
            state.others_v_world[3 * k + i] = other.v_world[i]
            state.others_f_virt_world[3 * k + i] = other.f_virt_world[i]
            state.others_f_user_world[3 * k + i] = other.f_user_world[i]
        state.others_depth[k] = totals[c].depth
        state.others_margin[k] = other.margin
        state.others_share[k] = other.stiffness_share
        state.others_energy[k] = other.observer.energy
