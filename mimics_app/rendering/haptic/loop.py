"""The loop around the tick: live against absolute deadlines, un-timed on the virtual clock, or over a recording.

All three are one compiled call each and run the identical `tick`. The live one holds no lock, asks Python for nothing,
allocates nothing, and ends when the quit word is set.

A tick that comes late is run at once and the ones behind it follow back to back, so that tick k always stands for
session time k * period; beyond `late_stop_ns` (a latched stop, or a pause of a simulated device) the releases that
passed are skipped and counted as missed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import from_dtype, types
from numpy.typing import NDArray

from mimics_app.contracts.atomics import load_acquire, now_ns, sleep_until_ns, store_release
from mimics_app.contracts.borrowed import borrowed
from mimics_app.contracts.device_descriptor import KINEMATICS_SET, Kin
from mimics_app.contracts.haptic import SAMPLE, SCENE
from mimics_app.contracts.kernel import kernel, typed_kernel
from mimics_app.contracts.loop_ports import (
    FIELDS,
    INBOX_ACTIVE,
    INBOX_BUTTONS,
    INBOX_GRASP,
    INBOX_TARGET,
    INBOX_TRIAL,
    READ,
    WRITE,
)
from mimics_app.contracts.object_rows import Rows
from mimics_app.contracts.ring import push
from mimics_app.contracts.session_memory import ControlWord
from mimics_app.contracts.triple_buffer import acquire
from mimics_app.rendering.haptic.channels import CHANNELS, WORK, Channels, Work
from mimics_app.rendering.haptic.histogram import count
from mimics_app.rendering.haptic.kernels.rows import read_inputs
from mimics_app.rendering.haptic.kernels.safety import (
    HOLD,
    IN_TIME,
    LATE_DAMP,
    LATE_STOP,
    MISSED_STOP,
    is_stopped,
)
from mimics_app.rendering.haptic.kernels.stability import follow_period
from mimics_app.rendering.haptic.kernels.tick import tick
from mimics_app.rendering.haptic.kernels.vectors import rotate_back
from mimics_app.rendering.haptic.objects import ROW_STACK, SIMULATE
from mimics_app.rendering.haptic.publish import publish_events, publish_state

__all__ = ["advance_ticks", "late_class", "replay_recorded", "run_live"]

Vec = NDArray[np.float64]
Read = Callable[..., Any]
Write = Callable[..., Any]
Simulate = Callable[..., Any]
Fields = tuple[Callable[..., Any], ...]

_STOP = int(ControlWord.STOP)
_QUIT = int(ControlWord.QUIT)
_TICKS = int(ControlWord.TICKS)
_MISSED = int(ControlWord.MISSED)
_HELD = int(ControlWord.HELD)
_STALE = int(ControlWord.STALE)
_STOPS = int(ControlWord.STOPS)
_HOLDS = int(ControlWord.HOLDS)
_START_NS = int(ControlWord.START_NS)


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
def _rows_of(stack: Rows, slot: int) -> Rows:
    """One slot of the tables of objects."""
    return Rows(
        stack.shapes[slot],
        stack.bodies[slot],
        stack.effects[slot],
        stack.points[slot],
        stack.wires[slot],
        stack.tunnels[slot],
    )


@kernel
def _run_tick(
    channels: Channels,
    work: Work,
    read: Read,
    write: Write,
    memory: Vec,
    simulate: Simulate,
    fields: Fields,
    kin: Kin,
    late_ns: int,
    missed_in_row: int,
    period: float,
    t_ns: int,
    dt: float,
) -> int:
    """Read, tick, write, publish; return `late_stop_ns` of the parameters used."""
    slot, _ = acquire(channels.scene_words)
    scene = channels.scenes[slot]
    rows = borrowed(_rows_of(channels.rows, slot))
    _take_inbox(channels, work, scene)
    state = work.state[0]
    status = read(memory, work.inbox, work.data, state.tick)
    stop_word = load_acquire(channels.control, _STOP)
    held = late_class(scene, late_ns, missed_in_row)
    tick(
        scene,
        rows,
        work.objects,
        simulate,
        fields,
        kin,
        work.state,
        work.data,
        status,
        stop_word,
        held,
        period,
        dt,
        work.command,
        work.sample[0],
    )
    write(memory, work.command, state.tick - 1)
    control = channels.control
    control[_HELD] += 1 if held != IN_TIME else 0
    control[_STALE] += state.stale
    control[_STOPS if is_stopped(state) else _HOLDS] += state.tripped
    publish_state(channels, work, scene.objects, t_ns)
    publish_events(channels, work, rows, scene.objects, t_ns)
    return scene.late_stop_ns


_SIMULATE = types.FunctionType(SIMULATE)
_PLUGINS = (types.FunctionType(READ), types.FunctionType(WRITE), types.float64[::1], _SIMULATE, FIELDS, KINEMATICS_SET)


@typed_kernel(types.int64(CHANNELS, WORK, *_PLUGINS, types.int64, types.int64))
def advance_ticks(
    channels: Channels,
    work: Work,
    read: Read,
    write: Write,
    memory: Vec,
    simulate: Simulate,
    fields: Fields,
    kin: Kin,
    ticks: int,
    period_ns: int,
) -> int:
    """Run `ticks` ticks un-timed on the virtual clock (tick k at k * period_ns); return the ticks done in all."""
    channels, work = borrowed(channels), borrowed(work)
    state = work.state[0]
    sample = work.sample[0]
    dt = period_ns * 1e-9
    for _ in range(ticks):
        _run_tick(channels, work, read, write, memory, simulate, fields, kin, 0, 0, dt, state.tick * period_ns, dt)
        sample.lateness_ns = 0.0
        sample.duration_ns = 0.0
        push(channels.sample_words, channels.samples, work.sample)
        store_release(channels.control, _TICKS, state.tick)
    return state.tick


@typed_kernel(types.int64(CHANNELS, WORK, *_PLUGINS, types.int64, types.int64))
def run_live(
    channels: Channels,
    work: Work,
    read: Read,
    write: Write,
    memory: Vec,
    simulate: Simulate,
    fields: Fields,
    kin: Kin,
    period_ns: int,
    spin_ns: int,
) -> int:
    """Run a tick every `period_ns` until the quit word is set; return the ticks done in all.

    Sleeps to absolute deadlines and spins for the last `spin_ns`. Counts lateness and duration after the first second.
    A burst that catches up after one late wake-up counts once towards the misses in a row.
    """
    channels, work = borrowed(channels), borrowed(work)
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
        late_stop_ns = _run_tick(
            channels, work, read, write, memory, simulate, fields, kin, late, missed_in_row, squares / total, due, dt
        )
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
        CHANNELS,
        WORK,
        from_dtype(SCENE)[::1],
        ROW_STACK,
        types.int64[::1],
        from_dtype(SAMPLE)[::1],
        _SIMULATE,
        FIELDS,
        KINEMATICS_SET,
        types.int64,
        from_dtype(SAMPLE)[::1],
    )
)
def replay_recorded(
    channels: Channels,
    work: Work,
    scenes: NDArray[Any],
    stack: Rows,
    which: NDArray[np.int64],
    inputs: NDArray[Any],
    simulate: Simulate,
    fields: Fields,
    kin: Kin,
    period_ns: int,
    outputs: NDArray[Any],
) -> int:
    """Run the tick over recorded inputs and tell its events and its newest state.

    Args:
        channels: Arrays of a session of its own; what is told goes there.
        work: Arrays of the loop, advanced.
        scenes: SCENE blocks, shape [m].
        stack: Tables of objects beside each of them, shape [m, capacity].
        which: Index of each tick's block, shape [n].
        inputs: SAMPLE rows, shape [n]; only the inputs of each are used.
        simulate: The objects' part of the tick.
        fields: Force fields of the objects.
        kin: Kinematics functions of the device.
        period_ns: Tick [ns].
        outputs: SAMPLE rows out, shape [n]; timing fields are zero.

    Returns:
        Ticks done.
    """
    channels, work, stack = borrowed(channels), borrowed(work), borrowed(stack)
    state, data = work.state[0], work.data
    for k in range(inputs.shape[0]):
        row = inputs[k]
        read_inputs(row, data)
        out = outputs[k]
        status = int(row.status)
        stop_word, held = int(row.stop_word), int(row.held)
        scene, rows = scenes[which[k]], borrowed(_rows_of(stack, which[k]))
        tick(
            scene,
            rows,
            work.objects,
            simulate,
            fields,
            kin,
            work.state,
            data,
            status,
            stop_word,
            held,
            row.period_s,
            period_ns * 1e-9,
            work.command,
            out,
        )
        publish_state(channels, work, scene.objects, (state.tick - 1) * period_ns)
        publish_events(channels, work, rows, scene.objects, state.tick * period_ns)
        out.lateness_ns = 0.0
        out.duration_ns = 0.0
    return inputs.shape[0]
