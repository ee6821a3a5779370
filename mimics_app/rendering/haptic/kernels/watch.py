"""Live stability monitor: limit and margin of what is touched, and the energy of each contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.haptic import SafetyState
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.acting import FREE_TIME, acting_contact, device_delay, own_damping
from mimics_app.rendering.haptic.kernels.contact_limits import is_pressed, touched_margin
from mimics_app.rendering.haptic.kernels.passivity import observe, reset_observer
from mimics_app.rendering.haptic.kernels.stability import LARGEST_MARGIN, margin_of, stiffness_limit

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import ObjectWork, SceneRecord, StateRecord, TotalsRecord

__all__ = ["felt_share", "watch_contact", "watch_margin"]

_CALM_MARGIN = 0.05
"""A margin that fell below 0 must rise above this before it is reported again."""


@kernel
def _is_felt(state: StateRecord) -> bool:
    return state.safety == SafetyState.ACTIVE or state.safety == SafetyState.DEGRADED


@kernel
def felt_share(state: StateRecord, totals: TotalsRecord) -> float:
    """Share 0-1 of the authored stiffness that is rendered: of touched shapes, else of the tunnel's wall."""
    share = 1.0
    if totals.touching > 0:
        share = state.acting.shape_share
    if state.tunnel.there == 1 and (totals.touching == 0 or state.tunnel.penetration > 0.0):
        share = min(share, state.acting.wall_share)
    return share


@kernel
def watch_margin(scene: SceneRecord, state: StateRecord, objects: ObjectWork, period: float) -> None:
    """Stability limit and margin of what is rendered, for the measured period; an event when one is lost.

    The wall of the tunnel counts before it is touched, shapes only while they are; of several contacts at once the
    worst direction counts.
    """
    tunnel = state.tunnel
    own = own_damping(scene)
    delay = device_delay(scene, state)
    state.period = period
    state.stiffness_limit = stiffness_limit(own + tunnel.damping, period, delay)
    stiffness = state.acting.wall_share * tunnel.stiffness + tunnel.centring if tunnel.there == 1 else 0.0
    state.margin = margin_of(state.stiffness_limit, stiffness)
    state.wall_margin = state.margin
    totals = objects.totals[state.contact]
    if totals.touching > 0:
        touched_margin(scene, state, totals, objects.touched[state.contact], own, 0.5 * period + delay)
        if state.span.margin < state.margin or tunnel.there == 0:
            state.margin = state.span.margin
            state.stiffness_limit = state.span.limit
    lost = _is_felt(state) and state.margin < 0.0 and state.warned == 0
    state.margin_lost = 1 if lost else 0
    if lost:
        state.warned = 1
    elif state.margin > _CALM_MARGIN:
        state.warned = 0
    state.stiffness_share = felt_share(state, totals)


@kernel
def _follow_observer(scene: SceneRecord, state: StateRecord, felt: bool, dt: float) -> None:
    """Energy of the contacts by the passivity observer, from 0 at the begin of each."""
    free = state.acting.free_ticks
    if felt and free == 0 and state.in_touch == 0:
        state.in_touch = 1
        reset_observer(state.observer)
    elif state.in_touch == 1 and (not felt or free * dt >= FREE_TIME):
        state.in_touch = 0
    acting_contact(scene, state, dt, state.work_a)
    observe(state.observer, state.hip_world, state.work_a)
    state.least_energy = min(state.least_energy, state.observer.lowest)


@kernel
def _keep_least(state: StateRecord, objects: ObjectWork) -> None:
    """The least margin of each contact."""
    for i in range(objects.totals[state.contact].listed):
        touched = objects.touched[state.contact, i]
        objects.margins[touched.shape] = min(objects.margins[touched.shape], touched.margin)
    if is_pressed(state):
        state.least_wall_margin = state.wall_margin if state.wall_touched == 0 else state.least_wall_margin
        state.least_wall_margin = min(state.least_wall_margin, state.wall_margin)
        state.wall_touched = 1


@kernel
def watch_contact(scene: SceneRecord, state: StateRecord, objects: ObjectWork, dt: float) -> None:
    """Energy of the contacts, the worst of all and of each, and when the cap begins to act.

    Args:
        scene: SCENE record.
        state: STATE record.
        objects: ObjectWork after this tick.
        dt: Tick [s].
    """
    totals = objects.totals[state.contact]
    felt = _is_felt(state)
    _follow_observer(scene, state, felt, dt)
    state.cap_began = 0
    if not (felt and (state.in_touch == 1 or totals.touching > 0)):
        state.capped = 0
        return
    _keep_least(state, objects)
    if state.capped == 0 and state.stiffness_share < 1.0:
        state.capped = 1
        state.cap_began = 1
    if state.touched == 0:
        state.touched = 1
        state.least_margin = LARGEST_MARGIN
        state.least_limit = state.stiffness_limit
        state.acting.least_share = 1.0
    state.least_margin = min(state.least_margin, state.margin)
    state.least_limit = min(state.least_limit, state.stiffness_limit)
    state.acting.least_share = min(state.acting.least_share, state.stiffness_share)
