"""Live stability monitor: limit and margin of the touched surfaces, and the energy of their contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.acting import FREE_TIME, acting_contact
from mimics_app.rendering.haptic.kernels.closed_region import region_margin, stiffness_limit
from mimics_app.rendering.haptic.kernels.contact_limits import is_pressed, touched_margin
from mimics_app.rendering.haptic.kernels.passivity import observe, reset_observer
from mimics_app.rendering.haptic.kernels.safety import is_rendered
from mimics_app.rendering.haptic.kernels.stability import LARGEST_MARGIN

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import SceneRecord, StateRecord, Table, TotalsRecord, TouchedRecord

__all__ = ["watch_contact", "watch_margin"]

_CALM_MARGIN = 0.05
"""Margin above which a loss of stability may be reported again [-]."""


@kernel
def _rendered_share(state: StateRecord, totals: TotalsRecord) -> float:
    """Rendered share 0-1 of the authored stiffness: of touched shapes, else of the tunnel's wall; and of effects."""
    share = state.acting.effect_share
    if totals.touching > 0:
        share = min(share, state.acting.shape_share)
    if state.tunnel.there == 1 and (totals.touching == 0 or state.tunnel.penetration > 0.0):
        share = min(share, state.acting.wall_share)
    return share


@kernel
def watch_margin(
    scene: SceneRecord, state: StateRecord, totals: TotalsRecord, touched: Table[TouchedRecord], period: float
) -> None:
    """Set stability limit and margin of the rendered contacts, and the event of a margin that fell below 0.

    The wall of the tunnel counts before it is touched, shapes only while they are touched; of several contacts at once
    the worst direction counts.

    Args:
        scene: SCENE record.
        state: STATE record of one point of contact.
        totals: Its TOTALS record.
        touched: TOUCHED records of its contacts; their margins are set.
        period: Measured period [s].
    """
    tunnel = state.tunnel
    state.period = period
    state.stiffness_limit = stiffness_limit(state.region, tunnel.damping)
    state.margin = LARGEST_MARGIN
    if tunnel.there == 1:
        stiffness = state.acting.wall_share * tunnel.stiffness + tunnel.centring
        state.margin = region_margin(state.region, stiffness, tunnel.damping)
    state.wall_margin = state.margin
    if totals.touching > 0:
        touched_margin(state, totals, touched)
        if state.span.margin < state.margin or tunnel.there == 0:
            state.margin = state.span.margin
            state.stiffness_limit = state.span.limit
    lost = is_rendered(state) and state.margin < 0.0 and state.warned == 0
    state.margin_lost = 1 if lost else 0
    if lost:
        state.warned = 1
    elif state.margin > _CALM_MARGIN:
        state.warned = 0
    state.stiffness_share = _rendered_share(state, totals)


@kernel
def _follow_observer(scene: SceneRecord, state: StateRecord, rendered: bool, dt: float) -> None:
    """Energy of the contacts by the passivity observer, reset to 0 when a contact begins."""
    free = state.acting.free_ticks
    if rendered and free == 0 and state.in_touch == 0:
        state.in_touch = 1
        reset_observer(state.observer)
    elif state.in_touch == 1 and (not rendered or free * dt >= FREE_TIME):
        state.in_touch = 0
    acting_contact(scene, state, dt, state.work_a)
    observe(state.observer, state.hip_world, state.work_a)
    state.least_energy = min(state.least_energy, state.observer.lowest)


@kernel
def _keep_smallest(state: StateRecord, touched: Table[TouchedRecord], listed: int, margins: Vec) -> None:
    """Update the smallest margin of each touched shape and of the tunnel's wall."""
    for i in range(listed):
        shape = touched[i].shape
        margins[shape] = min(margins[shape], touched[i].margin)
    if is_pressed(state):
        state.least_wall_margin = state.wall_margin if state.wall_touched == 0 else state.least_wall_margin
        state.least_wall_margin = min(state.least_wall_margin, state.wall_margin)
        state.wall_touched = 1


@kernel
def watch_contact(
    scene: SceneRecord,
    state: StateRecord,
    totals: TotalsRecord,
    touched: Table[TouchedRecord],
    margins: Vec,
    dt: float,
) -> None:
    """Follow the energy of the contacts and their smallest margins, and set the event of a cap that began to act.

    Args:
        scene: SCENE record.
        state: STATE record of one point of contact, after `watch_margin`.
        totals: Its TOTALS record.
        touched: TOUCHED records of its contacts.
        margins: ObjectWork.margins, updated.
        dt: Tick [s].
    """
    rendered = is_rendered(state)
    _follow_observer(scene, state, rendered, dt)
    state.cap_began = 0
    acts = state.in_touch == 1 or totals.touching > 0 or state.acting.effect_share < 1.0
    if not (rendered and acts):
        state.capped = 0
        return
    _keep_smallest(state, touched, totals.listed, margins)
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
