"""Publication after each tick: the newest snapshot with all poses, and the events."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from mimics_app.contracts.arrays import Words
from mimics_app.contracts.haptic import EventKind
from mimics_app.contracts.kernel import kernel
from mimics_app.contracts.ring import Records, push
from mimics_app.contracts.triple_buffer import back_slot, publish
from mimics_app.rendering.haptic.channels import Channels, Work
from mimics_app.rendering.haptic.kernels.objects.published import write_poses
from mimics_app.rendering.haptic.kernels.rows import write_snapshot
from mimics_app.rendering.haptic.kernels.state import CONTACT_BEGAN, CONTACT_ENDED
from mimics_app.rendering.haptic.kernels.vectors import norm

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import (
        EventRecord,
        ObjectCountsRecord,
        Rows,
        ShapeRecord,
        StateRecord,
        Table,
        TotalsRecord,
        TouchRecord,
    )

__all__ = ["publish_events", "publish_state"]


@kernel
def publish_state(channels: Channels, work: Work, counts: ObjectCountsRecord, t_ns: int) -> None:
    """Publish the newest state and poses to the main thread and the audio process.

    Args:
        channels: Arrays of the session.
        work: Arrays of the loop.
        counts: SCENE.objects of this tick.
        t_ns: Release time of the tick [ns].
    """
    slot = back_slot(channels.snapshot_words)
    write_snapshot(work.state[0], work.objects.totals[0], t_ns, channels.snapshots[slot])
    write_poses(work.objects.motions, counts.bodies, channels.poses[slot])
    channels.audio_snapshots[back_slot(channels.audio_words)] = channels.snapshots[slot]
    publish(channels.snapshot_words)
    publish(channels.audio_words)


class _Outlets(NamedTuple):
    """Current event and the rings of its three consumers; kept small because tuples are passed by value."""

    event: Records
    main_words: Words
    main: Records
    audio_words: Words
    audio: Records
    recorder_words: Words
    recorder: Records


@kernel
def _publish(outlets: _Outlets, kind: int, force: float) -> None:
    """Push the current event to its three consumers."""
    event = outlets.event
    event[0].kind = kind
    event[0].force = force
    push(outlets.main_words, outlets.main, event)
    push(outlets.audio_words, outlets.audio, event)
    push(outlets.recorder_words, outlets.recorder, event)


@kernel
def publish_events(channels: Channels, work: Work, rows: Rows, counts: ObjectCountsRecord, t_ns: int) -> None:
    """Publish this tick's events: parameters, state, trip, margin, cap, stale data, contacts, impact, losses."""
    outlets = _Outlets(
        work.event,
        channels.main_event_words,
        channels.main_events,
        channels.audio_event_words,
        channels.audio_events,
        channels.recorder_event_words,
        channels.recorder_events,
    )
    state = work.state[0]
    _publish_tick(outlets, state, t_ns)
    totals = work.objects.totals[0]
    if counts.shapes > 0:
        _publish_touches(outlets, state, totals, work.objects.touches, rows.shapes, counts.bodies, t_ns)
        _publish_impact(outlets, state, totals, t_ns)
    if counts.shapes + counts.effects > 0:
        _publish_losses(outlets, state, totals, t_ns)


@kernel
def _begin(event: EventRecord, state: StateRecord, t_ns: int, body_a: int, body_b: int) -> None:
    event.t_ns = t_ns
    event.tick = state.tick - 1
    event.body_a = body_a
    event.body_b = body_b
    event.material_a = 0
    event.material_b = 0


@kernel
def _publish_monitor(outlets: _Outlets, state: StateRecord) -> None:
    """Publish the reports of the monitors of stability and of stale device data."""
    if state.margin_lost == 1:
        _publish(outlets, EventKind.MARGIN, state.reported_margin)
    if state.cap_began == 1:
        _publish(outlets, EventKind.CAP, state.reported_share)
    if state.stale_began == 1:
        _publish(outlets, EventKind.STALE, state.age)


@kernel
def _publish_tick(outlets: _Outlets, state: StateRecord, t_ns: int) -> None:
    news = state.parameters_taken + state.state_changed + state.tripped + state.contact_change
    if news + state.margin_lost + state.cap_began + state.stale_began == 0:
        return
    event = outlets.event[0]
    _begin(event, state, t_ns, 0, -1)
    event.speed = state.tunnel.approach_speed
    event.value = state.tunnel.s
    for i in range(3):
        normal = state.tunnel.normal_world[i]
        event.position_world[i] = state.hip_world[i] - state.ball_radius * normal
        event.normal_world[i] = normal
    if state.parameters_taken == 1:
        _publish(outlets, EventKind.PARAMETERS, float(state.sequence))
    if state.state_changed == 1:
        _publish(outlets, EventKind.STATE, float(state.safety))
    if state.tripped == 1:
        _publish(outlets, EventKind.TRIP, float(state.cause))
    _publish_monitor(outlets, state)
    if state.contact_change == CONTACT_BEGAN:
        _publish(outlets, EventKind.CONTACT_BEGIN, norm(state.f_user_world))
    elif state.contact_change == CONTACT_ENDED:
        _publish(outlets, EventKind.CONTACT_END, norm(state.f_user_world))


@kernel
def _publish_touches(
    outlets: _Outlets,
    state: StateRecord,
    totals: TotalsRecord,
    touches: Table[TouchRecord],
    shapes: Table[ShapeRecord],
    bodies: int,
    t_ns: int,
) -> None:
    """Publish contacts of the HIP with the static scene (touch 0) and with bodies."""
    for k in range(bodies + 1):
        change = touches[k].change
        if change != CONTACT_BEGAN and change != CONTACT_ENDED:
            continue
        event = outlets.event[0]
        _begin(event, state, t_ns, 0, k if k > 0 else -1)
        event.material_b = shapes[totals.shape].material if totals.shape >= 0 else 0
        event.speed = totals.approach_speed
        event.value = float(totals.shape)
        for i in range(3):
            event.position_world[i] = state.hip_world[i]
            event.normal_world[i] = totals.normal[i]
        kind = EventKind.CONTACT_BEGIN if change == CONTACT_BEGAN else EventKind.CONTACT_END
        _publish(outlets, kind, norm(totals.shape_force))


@kernel
def _publish_impact(outlets: _Outlets, state: StateRecord, totals: TotalsRecord, t_ns: int) -> None:
    """Publish the hardest impact between bodies in this tick."""
    if totals.impact <= 0.0:
        return
    a = totals.impact_a + 1 if totals.impact_a >= 0 else -1
    b = totals.impact_b + 1 if totals.impact_b >= 0 else -1
    event = outlets.event[0]
    _begin(event, state, t_ns, a, b)
    event.speed = totals.impact
    event.value = 0.0
    for i in range(3):
        event.position_world[i] = totals.impact_position[i]
        event.normal_world[i] = totals.impact_normal[i]
    _publish(outlets, EventKind.IMPACT, totals.impact_force)


@kernel
def _publish_losses(outlets: _Outlets, state: StateRecord, totals: TotalsRecord, t_ns: int) -> None:
    """Publish losses of the simulation: shape pairs beyond the capacity, and a quarantined force field."""
    if totals.left_out == 0 and totals.quarantined < 0:
        return
    event = outlets.event[0]
    _begin(event, state, t_ns, -1, -1)
    event.speed = 0.0
    event.value = 0.0
    for i in range(3):
        event.position_world[i] = state.hip_world[i]
        event.normal_world[i] = 0.0
    if totals.left_out > 0:
        _publish(outlets, EventKind.LEFT_OUT, float(totals.left_out))
    if totals.quarantined >= 0:
        _publish(outlets, EventKind.QUARANTINE, float(totals.quarantined))
