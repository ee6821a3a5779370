"""The tick: device data in, command out. Live, un-timed and replayed runs call this very function.

    data -> motion -> ball -> tunnels -> objects -> safety -> what acts -> stability -> controller -> command, sample

Everything that a tick depends on is in its arguments: the device's data and status, the stop word, the late-tick class,
the measured period and the parameter block. All are recorded, so that a recording can be simulated again bit for bit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.device_descriptor import Kin
from mimics_app.contracts.haptic import SafetyState
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.acting import account, act, device_delay, own_damping
from mimics_app.rendering.haptic.kernels.contacts import collect, pass_on, publish_others, virtual_forces
from mimics_app.rendering.haptic.kernels.drive import control, note_arrival
from mimics_app.rendering.haptic.kernels.jumps import note_jump
from mimics_app.rendering.haptic.kernels.objects.hand import write_hand
from mimics_app.rendering.haptic.kernels.objects.published import sum_motions
from mimics_app.rendering.haptic.kernels.objects.touches import follow_touch, follow_touches
from mimics_app.rendering.haptic.kernels.rows import write_command, write_inputs, write_outputs
from mimics_app.rendering.haptic.kernels.safety import step_safety
from mimics_app.rendering.haptic.kernels.sensing import find_motion, size_ball, take_data
from mimics_app.rendering.haptic.kernels.tunnels import follow_tunnels, forget_tunnels
from mimics_app.rendering.haptic.kernels.vectors import copy
from mimics_app.rendering.haptic.kernels.watch import watch_contact, watch_margin

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import (
        Fields,
        ObjectCountsRecord,
        ObjectWork,
        Rows,
        SampleRecord,
        SceneRecord,
        Simulate,
        StateRecord,
        Table,
    )

__all__ = ["tick"]


@kernel
def _follow_contacts(objects: ObjectWork, counts: ObjectCountsRecord, state: StateRecord, dt: float) -> None:
    """Begin and end of contacts with a tunnel's wall and with objects; only what the user can feel counts."""
    felt = state.safety == SafetyState.ACTIVE or state.safety == SafetyState.DEGRADED
    state.contact_change = follow_touch(state, felt and state.tunnel.wall_force > 0.0, felt, dt)
    follow_touches(objects, counts, felt, dt)


@kernel
def _begin_tick(scene: SceneRecord, objects: ObjectWork, state: StateRecord) -> None:
    """Note which parameters act; a new trial forgets where the ball was in its tunnels."""
    state.tripped = 0
    state.parameters_taken = 1 if scene.sequence != state.sequence else 0
    state.sequence = scene.sequence
    if scene.trial != state.trial:
        state.trial = scene.trial
        forget_tunnels(objects.tunnels, state)


@kernel
def tick(
    scene: SceneRecord,
    rows: Rows,
    objects: ObjectWork,
    simulate: Simulate,
    fields: Fields,
    kin: Kin,
    states: Table[StateRecord],
    data: Vec,
    status: int,
    stop_word: int,
    held: int,
    period: float,
    dt: float,
    command: Vec,
    row: SampleRecord,
) -> None:
    """One tick.

    Args:
        scene: SCENE record, the parameters of this tick.
        rows: Tables of haptic objects beside it.
        objects: Working arrays of the objects, advanced by one tick.
        simulate: The objects' part of the tick, see rendering.haptic.objects.SIMULATE.
        fields: Force fields of the objects.
        kin: Kinematics functions of the device, in the order of contracts.device_descriptor.
        states: STATE records, one for each point of contact, advanced by one tick.
        data: What the device's read gave, shape [DATA_LENGTH].
        status: DeviceStatus of that read.
        stop_word: Not 0 while the stop key requests E_STOP.
        held: Late-tick class of this tick (safety.IN_TIME .. MISSED_STOP).
        period: Measured period [s]; dt where nothing can be late.
        dt: Tick [s].
        command: What the device's write takes, shape [COMMAND_LENGTH], filled here.
        row: SAMPLE record, filled here except for the timing fields.
    """
    state = states[0]
    _begin_tick(scene, objects, state)
    write_inputs(data, status, stop_word, held, period, state, dt, row)

    last_age = state.age
    take_data(scene, states, data, status, dt)
    find_motion(kin, scene, states)
    pass_on(scene, states)
    for c in range(max(1, scene.contacts)):
        note_jump(scene, states[c], status, last_age, dt)
        account(scene, states[c], dt)
    size_ball(scene, state, dt)
    own, delay = own_damping(scene), device_delay(scene, state)
    follow_tunnels(scene, rows.tunnels, objects.tunnels, state, own, delay, period)
    copy(state.tunnel.force_world, state.f_virt_world)
    write_hand(states, scene.contacts, dt, objects.hand)
    simulate(rows, objects, scene.objects, objects.hand, fields, dt, objects.force)
    state.objects_failed = objects.totals[0].status
    for i in range(3):
        state.f_virt_world[i] += objects.force[i]

    virtual_forces(scene, states, objects.totals)
    note_arrival(kin, scene, states)
    step_safety(scene, states, status, stop_word, held, dt)
    before = state.safety
    pass_on(scene, states)
    for c in range(max(1, scene.contacts)):
        act(scene, states[c], objects.totals[c], objects.touched[c], held, period, dt)
    _follow_contacts(objects, scene.objects, state, dt)
    for c in range(max(1, scene.contacts)):
        watch_margin(scene, states[c], objects, period)
        watch_contact(scene, states[c], objects, dt)
    collect(scene, states)
    control(kin, scene, states, held, dt)
    if state.safety != before:
        state.state_changed = 1
    write_command(scene, states, command)
    publish_others(scene, states, objects.totals)
    state.bodies = sum_motions(objects.motion_words, scene.objects.bodies)
    write_outputs(state, objects.totals[0], row)
    state.tick += 1
