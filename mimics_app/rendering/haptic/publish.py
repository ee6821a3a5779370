"""Publication after each tick: the newest snapshot with all poses, the events, and the sample."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.compiled.record_copy import copy_front
from mimics_app.contracts.loop.haptic import EventKind
from mimics_app.contracts.shared_memory.ring import prefetch_front, push, push_front
from mimics_app.contracts.shared_memory.triple_buffer import back_slot, publish
from mimics_app.maths.vec import copy, fill, norm
from mimics_app.rendering.haptic.channels import Channels, Work
from mimics_app.rendering.haptic.kernels.event_points import event_body
from mimics_app.rendering.haptic.kernels.objects.published import write_poses
from mimics_app.rendering.haptic.kernels.rows import sample_bytes, snapshot_bytes, write_snapshot
from mimics_app.rendering.haptic.kernels.state import CONTACT_BEGAN, CONTACT_ENDED

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Rows, SceneRecord, ShapeRecord, StateRecord, Table

__all__ = ["prefetch_sample", "publish_events", "publish_sample", "publish_state"]


@kernel
def publish_state(channels: Channels, work: Work, scene: SceneRecord, t_ns: int) -> None:
    """Publish the newest state and poses to the main thread and the audio process.

    Args:
        channels: Arrays of the session.
        work: Arrays of the loop.
        scene: SCENE record of this tick.
        t_ns: Release time of the tick [ns].
    """
    slot = back_slot(channels.snapshot_words)
    write_snapshot(scene.contacts, work.state, work.objects.totals, t_ns, channels.snapshots[slot])
    write_poses(work.objects.motions, scene.objects.bodies, channels.poses[slot])
    of_audio = channels.audio_snapshots[back_slot(channels.audio_words)]
    copy_front(of_audio, channels.snapshots[slot], snapshot_bytes(scene.contacts))
    publish(channels.snapshot_words)
    publish(channels.audio_words)


@kernel
def prefetch_sample(channels: Channels, work: Work) -> None:
    """Begin to load the memory that `publish_sample` writes at the end of the tick."""
    prefetch_front(channels.sample_words, channels.samples, sample_bytes(work.state[0].contacts))


@kernel
def publish_sample(channels: Channels, work: Work) -> None:
    """Push the sample of the tick, of as many points as the device has, to the recorder."""
    push_front(channels.sample_words, channels.samples, work.sample, sample_bytes(work.state[0].contacts))


@kernel
def _publish(channels: Channels, work: Work, kind: int, force: float) -> None:
    """Push the current event to its three consumers."""
    work.event[0].kind = kind
    work.event[0].force = force
    push(channels.main_event_words, channels.main_events, work.event)
    push(channels.audio_event_words, channels.audio_events, work.event)
    push(channels.recorder_event_words, channels.recorder_events, work.event)


@kernel
def publish_events(channels: Channels, work: Work, rows: Rows, scene: SceneRecord, t_ns: int) -> None:
    """Publish the events of this tick: of state, monitors, contacts, impacts and losses."""
    counts = scene.objects
    _publish_tick(channels, work, t_ns)
    for c in range(max(1, scene.contacts)):
        _publish_wall(channels, work, c, t_ns)
    if counts.shapes > 0:
        for c in range(max(1, scene.contacts)):
            _publish_touches(channels, work, rows.shapes, counts.bodies, c, t_ns)
        _publish_impact(channels, work, t_ns)
    if counts.shapes + counts.effects > 0:
        _publish_losses(channels, work, t_ns)


@kernel
def _begin(work: Work, contact: int, t_ns: int, body_a: int, body_b: int, speed: float, value: float) -> None:
    """Begin an event at a point of contact, without a direction and materials."""
    event, state = work.event[0], work.state[contact]
    event.t_ns = t_ns
    event.tick = work.state[0].tick - 1
    event.body_a = body_a
    event.body_b = body_b
    event.material_a = 0
    event.material_b = 0
    event.speed = speed
    event.value = value
    copy(state.hip_world, event.position_world)
    fill(event.normal_world, 0.0)


@kernel
def _publish_monitor(channels: Channels, work: Work, state: StateRecord) -> None:
    """Publish the reports of the monitors of stability, oscillation and stale device data."""
    if state.margin_lost == 1:
        _publish(channels, work, EventKind.MARGIN, state.reported_margin)
    if state.cap_began == 1:
        _publish(channels, work, EventKind.CAP, state.reported_share)
    if state.limit_began == 1:
        _publish(channels, work, EventKind.FORCE_LIMIT, state.reported_force)
    if state.swing_reported == 1:
        _publish(channels, work, EventKind.OSCILLATION, state.reported_swing)
    if state.stale_began == 1:
        _publish(channels, work, EventKind.STALE, state.age)


@kernel
def _begin_at_wall(work: Work, contact: int, t_ns: int) -> None:
    """Begin an event where the ball of a point of contact touches, or last touched, the wall of its tunnel."""
    state, event = work.state[contact], work.event[0]
    _begin(work, contact, t_ns, event_body(contact), -1, state.tunnel.approach_speed, state.tunnel.s)
    copy(state.tunnel.normal_world, event.normal_world)
    for i in range(3):
        event.position_world[i] = state.hip_world[i] - state.ball_radius * state.tunnel.normal_world[i]


@kernel
def _publish_wall(channels: Channels, work: Work, contact: int, t_ns: int) -> None:
    """Publish contacts of a point with the wall of its tunnel."""
    state = work.state[contact]
    if state.contact_change != CONTACT_BEGAN and state.contact_change != CONTACT_ENDED:
        return
    _begin_at_wall(work, contact, t_ns)
    kind = EventKind.CONTACT_BEGIN if state.contact_change == CONTACT_BEGAN else EventKind.CONTACT_END
    _publish(channels, work, kind, norm(state.f_user_world))


@kernel
def _publish_tick(channels: Channels, work: Work, t_ns: int) -> None:
    state = work.state[0]
    news = state.parameters_taken + state.state_changed + state.tripped + state.gait_changed
    news += state.margin_lost + state.cap_began + state.limit_began + state.swing_reported + state.stale_began
    if news == 0:
        return
    _begin_at_wall(work, 0, t_ns)
    if state.parameters_taken == 1:
        _publish(channels, work, EventKind.PARAMETERS, float(state.sequence))
    if state.state_changed == 1:
        _publish(channels, work, EventKind.STATE, float(state.safety))
    if state.tripped == 1:
        _publish(channels, work, EventKind.TRIP, float(state.cause))
    if state.gait_changed == 1:
        _publish(channels, work, EventKind.GAIT_STATE, float(state.gait_state))
    _publish_monitor(channels, work, state)


@kernel
def _publish_touches(
    channels: Channels, work: Work, shapes: Table[ShapeRecord], bodies: int, contact: int, t_ns: int
) -> None:
    """Publish contacts of a point with the static scene (touch 0) and with bodies."""
    totals, event, touches = work.objects.totals[contact], work.event[0], work.objects.touches[contact]
    body_a = event_body(contact)
    for k in range(bodies + 1):
        change = touches[k].change
        if change != CONTACT_BEGAN and change != CONTACT_ENDED:
            continue
        _begin(work, contact, t_ns, body_a, k if k > 0 else -1, totals.approach_speed, float(totals.shape))
        event.material_b = shapes[totals.shape].material if totals.shape >= 0 else 0
        copy(totals.normal, event.normal_world)
        kind = EventKind.CONTACT_BEGIN if change == CONTACT_BEGAN else EventKind.CONTACT_END
        _publish(channels, work, kind, norm(totals.shape_force))


@kernel
def _publish_impact(channels: Channels, work: Work, t_ns: int) -> None:
    """Publish the hardest impact between bodies in this tick."""
    totals, event = work.objects.totals[0], work.event[0]
    if totals.impact <= 0.0:
        return
    a = totals.impact_a + 1 if totals.impact_a >= 0 else -1
    b = totals.impact_b + 1 if totals.impact_b >= 0 else -1
    _begin(work, 0, t_ns, a, b, totals.impact, 0.0)
    copy(totals.impact_position, event.position_world)
    copy(totals.impact_normal, event.normal_world)
    _publish(channels, work, EventKind.IMPACT, totals.impact_force)


@kernel
def _publish_losses(channels: Channels, work: Work, t_ns: int) -> None:
    """Publish losses of the simulation: shape pairs beyond the capacity, and a quarantined force field."""
    totals = work.objects.totals[0]
    if totals.left_out == 0 and totals.quarantined < 0:
        return
    _begin(work, 0, t_ns, -1, -1, 0.0, 0.0)
    if totals.left_out > 0:
        _publish(channels, work, EventKind.LEFT_OUT, float(totals.left_out))
    if totals.quarantined >= 0:
        _publish(channels, work, EventKind.QUARANTINE, float(totals.quarantined))
