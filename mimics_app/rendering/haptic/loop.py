"""The loop around the tick: live against absolute deadlines, un-timed on the virtual clock, or over a recording.

All three are one compiled call each and run the identical `tick`. The live one holds no lock, asks Python for nothing,
allocates nothing, and ends when the quit word is set.

A tick that comes late is run at once and the ones behind it follow back to back, so that tick k always stands for
session time k * period; beyond `late_stop_ns` (a latched stop anyway) the releases that passed are skipped and counted
as missed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import from_dtype, types
from numpy.typing import NDArray

from mimics_app.contracts.atomics import load_acquire, now_ns, sleep_until_ns, store_release
from mimics_app.contracts.haptic import SAMPLE, SCENE, EventKind
from mimics_app.contracts.kernel import kernel, typed_kernel
from mimics_app.contracts.loop_ports import (
    INBOX_ACTIVE,
    INBOX_BUTTONS,
    INBOX_GRASP,
    INBOX_TARGET,
    INBOX_TRIAL,
    READ,
    WRITE,
)
from mimics_app.contracts.ring import push
from mimics_app.contracts.session_memory import ControlWord
from mimics_app.contracts.triple_buffer import acquire, back_slot, publish
from mimics_app.rendering.haptic.channels import CHANNELS, WORK, Channels, Work
from mimics_app.rendering.haptic.histogram import count
from mimics_app.rendering.haptic.kernels.bodies import move_bodies, write_poses
from mimics_app.rendering.haptic.kernels.safety import HOLD, IN_TIME, LATE_DAMP, LATE_STOP, MISSED_STOP
from mimics_app.rendering.haptic.kernels.stability import follow_period
from mimics_app.rendering.haptic.kernels.state import CONTACT_BEGAN, CONTACT_ENDED, STATE
from mimics_app.rendering.haptic.kernels.tick import tick
from mimics_app.rendering.haptic.kernels.vectors import norm, rotate_back

__all__ = ["advance_ticks", "late_class", "replay_recorded", "run_live"]

Vec = NDArray[np.float64]
Read = Callable[..., Any]
Write = Callable[..., Any]

_STOP = int(ControlWord.STOP)
_QUIT = int(ControlWord.QUIT)
_TICKS = int(ControlWord.TICKS)
_MISSED = int(ControlWord.MISSED)
_HELD = int(ControlWord.HELD)
_STALE = int(ControlWord.STALE)
_TRIPS = int(ControlWord.TRIPS)
_START_NS = int(ControlWord.START_NS)

_CONTACT_BEGIN = int(EventKind.CONTACT_BEGIN)
_CONTACT_END = int(EventKind.CONTACT_END)
_STATE = int(EventKind.STATE)
_TRIP = int(EventKind.TRIP)
_PARAMETERS = int(EventKind.PARAMETERS)
_MARGIN = int(EventKind.MARGIN)


@kernel
def late_class(scene: Any, late_ns: int, missed_in_row: int) -> int:
    """Late-tick class of a tick that woke `late_ns` after its release with `missed_in_row` misses behind it."""
    held = IN_TIME
    if scene.sequence == 0:
        held = IN_TIME
    elif late_ns > scene.late_stop_ns:
        held = LATE_STOP
    elif missed_in_row >= scene.missed_stop:
        held = MISSED_STOP
    elif late_ns > scene.late_damp_ns:
        held = LATE_DAMP
    elif late_ns > scene.late_hold_ns:
        held = HOLD
    return held


@kernel
def _take_inbox(channels: Channels, work: Work, scene: Any) -> None:
    """Newest INBOX record as the device sees it: target in the robot frame."""
    slot, _ = acquire(channels.inbox_words)
    record = channels.inboxes[slot]
    target = work.state[0].work_a
    for i in range(3):
        target[i] = record.target_world[i] - scene.origin_world[i]
    rotate_back(scene.R_world_from_robot, target, work.inbox[INBOX_TARGET : INBOX_TARGET + 3])
    work.inbox[INBOX_GRASP] = record.grasp
    work.inbox[INBOX_BUTTONS] = float(record.buttons)
    work.inbox[INBOX_ACTIVE] = float(record.active)
    work.inbox[INBOX_TRIAL] = float(record.trial)


@kernel
def _publish_snapshot(channels: Channels, work: Work, t_ns: int, dt: float) -> None:
    """Offer the newest state and poses to main and audio."""
    state = work.state[0]
    slot = back_slot(channels.snapshot_words)
    out = channels.snapshots[slot]
    out.tick = state.tick - 1
    out.t_ns = t_ns
    out.sequence = state.sequence
    out.state = state.safety
    out.cause = state.cause
    out.contacts = state.contacts
    out.contact_tick = state.contact_tick
    for i in range(3):
        out.hip_world[i] = state.hip_world[i]
        out.v_world[i] = state.v_world[i]
        out.f_user_world[i] = state.f_user_world[i]
        out.f_meas_world[i] = state.f_meas_world[i]
        out.q[i] = state.q[i]
    out.grasp = state.grasp
    out.ball_radius = state.ball_radius
    out.s = state.tunnel.s
    out.progress = state.tunnel.progress
    out.distance = state.tunnel.distance
    out.penetration = state.tunnel.penetration
    out.tunnel_radius = state.tunnel.radius
    out.ramp = state.ramp
    out.period_s = state.period
    out.stiffness_limit = state.stiffness_limit
    out.margin = state.margin
    out.energy = state.observer.energy
    move_bodies(work.bodies, dt)
    write_poses(state.hip_world, work.bodies, channels.poses[slot])
    channels.audio_snapshots[back_slot(channels.audio_words)] = channels.snapshots[slot]
    publish(channels.snapshot_words)
    publish(channels.audio_words)


@kernel
def _tell(channels: Channels, work: Work, kind: int, force: float) -> None:
    """Send the event being filled to its three consumers."""
    work.event[0].kind = kind
    work.event[0].force = force
    push(channels.main_event_words, channels.main_events, work.event)
    push(channels.audio_event_words, channels.audio_events, work.event)
    push(channels.recorder_event_words, channels.recorder_events, work.event)


@kernel
def _tell_events(channels: Channels, work: Work, t_ns: int) -> None:
    """Events of this tick, in the order parameters, state, trip, margin, contact."""
    state = work.state[0]
    if state.parameters_taken + state.state_changed + state.tripped + state.margin_lost + state.contact_change == 0:
        return
    event = work.event[0]
    event.t_ns = t_ns
    event.tick = state.tick - 1
    event.body_a = 0
    event.body_b = -1
    event.material_a = 0
    event.material_b = 0
    event.speed = state.tunnel.approach_speed
    event.value = state.tunnel.s
    for i in range(3):
        normal = state.tunnel.normal_world[i]
        event.position_world[i] = state.hip_world[i] - state.ball_radius * normal
        event.normal_world[i] = normal
    if state.parameters_taken == 1:
        _tell(channels, work, _PARAMETERS, float(state.sequence))
    if state.state_changed == 1:
        _tell(channels, work, _STATE, float(state.safety))
    if state.tripped == 1:
        _tell(channels, work, _TRIP, float(state.cause))
    if state.margin_lost == 1:
        _tell(channels, work, _MARGIN, state.margin)
    if state.contact_change == CONTACT_BEGAN:
        _tell(channels, work, _CONTACT_BEGIN, norm(state.f_user_world))
    elif state.contact_change == CONTACT_ENDED:
        _tell(channels, work, _CONTACT_END, norm(state.f_user_world))


@kernel
def _run_tick(
    channels: Channels,
    work: Work,
    read: Read,
    write: Write,
    memory: Vec,
    late_ns: int,
    missed_in_row: int,
    period: float,
    t_ns: int,
    dt: float,
) -> int:
    """Read, tick, write, publish; return `late_stop_ns` of the parameters used."""
    slot, _ = acquire(channels.scene_words)
    scene = channels.scenes[slot]
    _take_inbox(channels, work, scene)
    state = work.state[0]
    status = read(memory, work.inbox, work.data, state.tick)
    stop_word = load_acquire(channels.control, _STOP)
    held = late_class(scene, late_ns, missed_in_row)
    tick(scene, state, work.data, status, stop_word, held, period, dt, work.command, work.sample[0])
    write(memory, work.command, state.tick - 1)
    control = channels.control
    control[_HELD] += 1 if held != IN_TIME else 0
    control[_STALE] += state.stale
    control[_TRIPS] += state.tripped
    _publish_snapshot(channels, work, t_ns, dt)
    _tell_events(channels, work, t_ns)
    return scene.late_stop_ns


_DEVICE = (types.FunctionType(READ), types.FunctionType(WRITE), types.float64[::1])


@typed_kernel(types.int64(CHANNELS, WORK, *_DEVICE, types.int64, types.int64))
def advance_ticks(
    channels: Channels, work: Work, read: Read, write: Write, memory: Vec, ticks: int, period_ns: int
) -> int:
    """Run `ticks` ticks un-timed on the virtual clock (tick k at k * period_ns); return the ticks done in all."""
    state = work.state[0]
    sample = work.sample[0]
    dt = period_ns * 1e-9
    for _ in range(ticks):
        _run_tick(channels, work, read, write, memory, 0, 0, dt, state.tick * period_ns, dt)
        sample.lateness_ns = 0.0
        sample.duration_ns = 0.0
        push(channels.sample_words, channels.samples, work.sample)
        store_release(channels.control, _TICKS, state.tick)
    return state.tick


@typed_kernel(types.int64(CHANNELS, WORK, *_DEVICE, types.int64, types.int64))
def run_live(
    channels: Channels, work: Work, read: Read, write: Write, memory: Vec, period_ns: int, spin_ns: int
) -> int:
    """Run a tick every `period_ns` until the quit word is set; return the ticks done in all.

    Sleeps to absolute deadlines and spins for the last `spin_ns`. Counts lateness and duration after the first second.
    A burst that catches up after one late wake-up counts once towards the misses in a row.
    """
    state = work.state[0]
    sample = work.sample[0]
    control = channels.control
    timespec = work.timespec
    dt = period_ns * 1e-9
    first_counted = state.tick + 1_000_000_000 // period_ns
    due = now_ns(timespec) + period_ns
    control[_START_NS] = due - state.tick * period_ns
    ended = due
    missed_in_row = 0
    total, squares, last_woke = dt, dt * dt, due - period_ns
    while load_acquire(control, _QUIT) == 0:
        sleep_until_ns(timespec, due - spin_ns)
        woke = now_ns(timespec)
        while woke < due:
            woke = now_ns(timespec)
        late = woke - due
        total, squares = follow_period(total, squares, float(woke - last_woke) * 1e-9, dt)
        last_woke = woke
        catching_up = ended > due
        late_stop_ns = _run_tick(channels, work, read, write, memory, late, missed_in_row, squares / total, due, dt)
        ended = now_ns(timespec)
        sample.lateness_ns = float(late)
        sample.duration_ns = float(ended - woke)
        push(channels.sample_words, channels.samples, work.sample)
        missed = ended - due > period_ns
        if not missed:
            missed_in_row = 0
        elif not catching_up or ended - woke > period_ns:
            missed_in_row += 1
        skipped = 0
        if late_stop_ns > 0 and late > late_stop_ns:
            skipped = late // period_ns
        if state.tick > first_counted:
            count(channels.lateness, late)
            count(channels.duration, ended - woke)
            control[_MISSED] += skipped + (1 if missed else 0)
        due += (1 + skipped) * period_ns
        store_release(control, _TICKS, state.tick)
    return state.tick


@typed_kernel(
    types.int64(
        from_dtype(SCENE)[::1],
        types.int64[::1],
        from_dtype(SAMPLE)[::1],
        from_dtype(STATE)[::1],
        types.float64[::1],
        types.float64[::1],
        types.float64,
        from_dtype(SAMPLE)[::1],
    )
)
def replay_recorded(
    scenes: NDArray[Any],
    which: NDArray[np.int64],
    inputs: NDArray[Any],
    states: NDArray[Any],
    data: Vec,
    command: Vec,
    dt: float,
    outputs: NDArray[Any],
) -> int:
    """Run the tick over recorded inputs.

    Args:
        scenes: SCENE blocks, shape [m].
        which: Index of each tick's block, shape [n].
        inputs: SAMPLE rows, shape [n]; only the inputs of each are used.
        states: STATE record to advance, shape [1].
        data: Scratch, shape [DATA_LENGTH].
        command: Scratch, shape [COMMAND_LENGTH].
        dt: Tick [s].
        outputs: SAMPLE rows out, shape [n]; timing fields are zero.

    Returns:
        Ticks done.
    """
    for k in range(inputs.shape[0]):
        row = inputs[k]
        for i in range(3):
            data[i] = row.q[i]
            data[3 + i] = row.dq[i]
            data[6 + i] = row.f_meas[i]
        data[9] = row.grasp
        data[10] = row.buttons
        data[11] = row.age
        data[12] = row.delay
        out = outputs[k]
        status = int(row.status)
        stop_word, held = int(row.stop_word), int(row.held)
        tick(scenes[which[k]], states[0], data, status, stop_word, held, row.period_s, dt, command, out)
        out.lateness_ns = 0.0
        out.duration_ns = 0.0
    return inputs.shape[0]
