"""Extremes of a trial, and the work of the person, tick by tick while the person leads the device."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.rendering.haptic.kernels.controller_slot import person_leads
from mimics_app.rendering.haptic.kernels.vectors import norm

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import SceneRecord, StateRecord, Table

__all__ = ["follow_extremes", "forget_extremes"]


@kernel
def forget_extremes(states: Table[StateRecord]) -> None:
    """Begin a trial without extremes and without work at any point of contact."""
    for c in range(len(states)):
        state = states[c]
        state.force_peak = 0.0
        state.distance_peak = 0.0
        state.progress_peak = 0.0
        state.own_work = 0.0


@kernel
def _power(scene: SceneRecord, state: StateRecord) -> float:
    """Power of the person at a point of contact [W]: that of the measured force.

    A force driven device measures none: there it is what the device's own damping takes less what its force gives,
    which leaves out the kinetic energy of the device. The work of both is at most zero for a hand that is passive and
    was at rest.
    """
    power = 0.0
    for i in range(3):
        force = state.f_meas_world[i]
        if scene.force_driven == 1:
            force = scene.device_damping * state.v_world[i] - state.f_user_world[i]
        power += force * state.v_world[i]
    return power


@kernel
def follow_extremes(scene: SceneRecord, states: Table[StateRecord], dt: float) -> None:
    """Take a tick of every point of contact; one in which the robot is driven or held counts in nothing."""
    if not person_leads(scene):
        return
    for c in range(max(1, scene.contacts)):
        state = states[c]
        state.force_peak = max(state.force_peak, norm(state.f_user_world))
        state.distance_peak = max(state.distance_peak, state.own_tunnel.distance)
        state.progress_peak = max(state.progress_peak, state.own_tunnel.progress)
        state.own_work += _power(scene, state) * dt
