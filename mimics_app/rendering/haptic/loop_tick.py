"""One tick with its input and output, compiled once: the live, virtual and replay loops call it by pointer.

Inlined into each loop, the tick would be compiled and loaded three times.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from numba import from_dtype, types

from mimics_app.compiled.atomics import load_acquire
from mimics_app.compiled.borrowed import borrowed, borrowed_type
from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.device_descriptor import KINEMATICS_SET, Kin
from mimics_app.contracts.loop.haptic import SAMPLE, SCENE, SECOND_NS, DeviceStatus, SafetyState
from mimics_app.contracts.loop.loop_ports import (
    FIELDS,
    INBOX_ACTIVE,
    INBOX_BUTTONS,
    INBOX_GRASP,
    INBOX_TARGET,
    INBOX_TRIAL,
    READ,
    WRITE,
)
from mimics_app.contracts.loop.object_rows import Rows
from mimics_app.contracts.shared_memory.session_memory import ControlWord
from mimics_app.contracts.shared_memory.shared_words import STOP_STRIDE
from mimics_app.contracts.shared_memory.triple_buffer import acquire
from mimics_app.maths.vec import rotate_back
from mimics_app.rendering.haptic.channels import CHANNELS, WORK, Channels, Work
from mimics_app.rendering.haptic.kernels import tick as ticking
from mimics_app.rendering.haptic.kernels.safety import (
    HOLD,
    IN_TIME,
    LATE_DAMP,
    LATE_STOP,
    MISSED_STOP,
    is_stopped,
)
from mimics_app.rendering.haptic.kernels.spoiled_data import ORDERS, is_deaf, spoil
from mimics_app.rendering.haptic.kernels.state import STATE
from mimics_app.rendering.haptic.objects import OBJECT_WORK, ROWS, SIMULATE
from mimics_app.rendering.haptic.publish import prefetch_sample, publish_events, publish_state
from mimics_app.rendering.haptic.struck import publish_forces

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        Fields,
        Read,
        SceneRecord,
        Simulate,
        StateRecord,
        Tick,
        Write,
    )

__all__ = ["LOOP_FUNCTIONS", "LOOP_TICK", "SIMULATION", "TICK", "late_class", "loop_tick", "rows_of", "tick"]


_FAULT = int(DeviceStatus.FAULT)
_CLEARED = int(ControlWord.CLEARED)
_HELD = int(ControlWord.HELD)
_STALE = int(ControlWord.STALE)
_STOPS = int(ControlWord.STOPS)
_HOLDS = int(ControlWord.HOLDS)

SIMULATION = types.FunctionType(SIMULATE)
"""Compiled type of the objects' part of the tick."""

_VECTOR = types.float64[::1]

TICK = types.void(
    from_dtype(SCENE),
    borrowed_type(ROWS),
    borrowed_type(OBJECT_WORK),
    SIMULATION,
    FIELDS,
    KINEMATICS_SET,
    borrowed_type(from_dtype(STATE)[::1]),
    _VECTOR,
    types.int64,
    types.int64,
    types.int64,
    types.float64,
    types.float64,
    _VECTOR,
    from_dtype(SAMPLE),
)
"""Signature of `tick`, see `kernels.tick.tick`."""

LOOP_TICK = types.int64(
    borrowed_type(CHANNELS),
    borrowed_type(WORK),
    types.FunctionType(TICK),
    types.FunctionType(READ),
    types.FunctionType(WRITE),
    _VECTOR,
    SIMULATION,
    FIELDS,
    KINEMATICS_SET,
    types.int64,
    types.int64,
    types.float64,
    types.int64,
    types.float64,
)
"""Signature of `loop_tick`."""

LOOP_FUNCTIONS = types.Tuple(  # type: ignore[no-untyped-call]
    (
        types.FunctionType(LOOP_TICK),
        types.FunctionType(TICK),
        types.FunctionType(READ),
        types.FunctionType(WRITE),
        SIMULATION,
        FIELDS,
        KINEMATICS_SET,
    )
)
"""Types of the compiled functions that a loop gets: both layers of the tick, the device's, and the objects' part."""


tick: Tick = typed_kernel(TICK)(ticking.tick.py_func)  # type: ignore[attr-defined]
"""`kernels.tick.tick` compiled for the loop's types, callable by pointer."""


@kernel
def late_class(scene: SceneRecord, late_ns: int, missed_in_row: int) -> int:
    """Return the late-tick class of a tick `late_ns` after its release and with `missed_in_row` misses before it."""
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
def _take_inbox(channels: Channels, work: Work, scene: SceneRecord) -> None:
    """Copy the newest INBOX record to work.inbox, with the targets in the robot frame."""
    slot, _ = acquire(channels.inbox_words)
    record = channels.inboxes[slot]
    target = work.state[0].work_a
    for c in range(max(1, scene.contacts)):
        for i in range(3):
            target[i] = record.target_world[c, i] - scene.origin_world[i]
        first = INBOX_TARGET + 3 * c
        rotate_back(scene.R_world_from_robot, target, work.inbox[first : first + 3])
        work.inbox[INBOX_GRASP + c] = record.grasp[c]
    work.inbox[INBOX_BUTTONS] = float(record.buttons)
    work.inbox[INBOX_ACTIVE] = float(record.active)
    work.inbox[INBOX_TRIAL] = float(record.trial)


@kernel
def rows_of(stack: Rows, slot: int) -> Rows:
    """Return the tables of objects in one slot."""
    return Rows(
        stack.shapes[slot],
        stack.bodies[slot],
        stack.effects[slot],
        stack.points[slot],
        stack.wires[slot],
        stack.tunnels[slot],
        stack.curves[slot],
    )


@kernel
def _takes_nothing(scene: SceneRecord, state: StateRecord, dt: float) -> bool:
    """Whether a device that sends data has taken no command for longer than its data may age: nothing can stop it."""
    return state.safety >= SafetyState.HOMED and state.refused_ticks * dt * SECOND_NS > scene.stale_stop_ns


@kernel
def _stop_word(channels: Channels) -> int:
    """Return 1 while a source of commands requests a stop that no reset has answered, else 0."""
    requests = 0
    for i in range(0, len(channels.stop_words), STOP_STRIDE):
        requests += load_acquire(channels.stop_words, i)
    return 1 if requests != load_acquire(channels.control, _CLEARED) else 0


@typed_kernel(LOOP_TICK)
def loop_tick(
    channels: Channels,
    work: Work,
    tick: Tick,
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
    """Read the device, tick, write the device, publish; return `late_stop_ns` of the parameters used."""
    slot, _ = acquire(channels.scene_words)
    scene = channels.scenes[slot]
    rows = borrowed(rows_of(channels.rows, slot))
    prefetch_sample(channels, work)
    _take_inbox(channels, work, scene)
    state = work.state[0]
    status = read(memory, work.inbox, work.data, state.tick)
    spoiled = work.spoiling[ORDERS] != 0.0
    if spoiled:
        status = spoil(work.spoiling, work.data, status, state.tick, dt)
    if status == DeviceStatus.FRESH and _takes_nothing(scene, state, dt):
        status = _FAULT
    stop_word = _stop_word(channels)
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
    taken = False if spoiled and is_deaf(work.spoiling) else write(memory, work.command, state.tick - 1) == 0
    state.refused_ticks = 0 if taken else state.refused_ticks + 1
    control = channels.control
    control[_HELD] += 1 if held != IN_TIME else 0
    control[_STALE] += state.stale
    control[_STOPS if is_stopped(state) else _HOLDS] += state.tripped
    publish_state(channels, work, scene, t_ns)
    publish_events(channels, work, rows, scene, t_ns)
    publish_forces(channels, work, scene, t_ns)
    return scene.late_stop_ns
