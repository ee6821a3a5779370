"""The tick of the haptic loop: device data in, command out. Live, un-timed and replayed runs call this one function.

    data -> motion -> tunnels, objects -> safety -> force on the user -> stability -> controller -> command, sample

A tick depends on its arguments alone: the device's data and status, the stop word, the late-tick class, the measured
period and the parameter block. All of them are recorded, so that a replay is bit-exact.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.device_descriptor import Kin
from mimics_app.maths.vec import norm
from mimics_app.rendering.haptic.kernels.acting import delay_ticks, device_delay, set_user_force, update_energy
from mimics_app.rendering.haptic.kernels.closed_region import find_region
from mimics_app.rendering.haptic.kernels.contacts import (
    collect_events,
    set_virtual_forces,
    share_device_state,
    stop_together,
)
from mimics_app.rendering.haptic.kernels.controller_slot import person_leads
from mimics_app.rendering.haptic.kernels.drive import control, note_arrival
from mimics_app.rendering.haptic.kernels.jumps import note_jump, note_lag
from mimics_app.rendering.haptic.kernels.objects.object_inputs import write_object_inputs
from mimics_app.rendering.haptic.kernels.objects.published import sum_motions
from mimics_app.rendering.haptic.kernels.objects.touches import follow_touch, follow_touches
from mimics_app.rendering.haptic.kernels.oscillation import watch_swing
from mimics_app.rendering.haptic.kernels.rows import write_command, write_inputs, write_outputs
from mimics_app.rendering.haptic.kernels.safety import is_rendered, step_safety
from mimics_app.rendering.haptic.kernels.sensing import find_motion, read_sample, size_ball
from mimics_app.rendering.haptic.kernels.tunnels import follow_tunnels, reset_tunnel_tracking
from mimics_app.rendering.haptic.kernels.watch import watch_contact, watch_margin
from mimics_app.rendering.haptic.reference.generator import step_reference

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        Fields,
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
    """Update extremes and work of every point of contact; while the robot drives or is held they stay as they are."""
    if not person_leads(scene):
        return
    for c in range(max(1, scene.contacts)):
        state = states[c]
        state.force_peak = max(state.force_peak, norm(state.f_user_world))
        state.distance_peak = max(state.distance_peak, state.own_tunnel.distance)
        state.progress_peak = max(state.progress_peak, state.own_tunnel.progress)
        state.own_work += _power(scene, state) * dt


@kernel
def _begin_tick(scene: SceneRecord, objects: ObjectWork, states: Table[StateRecord]) -> None:
    """Note whether parameters changed; a new trial restarts the tracking of the tunnels and the extremes."""
    state = states[0]
    state.tripped = 0
    state.contacts = scene.contacts
    state.parameters_taken = 1 if scene.sequence != state.sequence else 0
    state.sequence = scene.sequence
    if scene.trial != state.trial:
        state.trial = scene.trial
        reset_tunnel_tracking(objects.tunnels, states)
        forget_extremes(states)


@kernel
def _read_motion(kin: Kin, scene: SceneRecord, states: Table[StateRecord], data: Vec, status: int, dt: float) -> None:
    """Motion of every point of contact from the device's data, its energy account, and the size of its ball."""
    last_age = states[0].age
    read_sample(scene, states, data, status, dt)
    find_motion(kin, scene, states)
    share_device_state(scene, states)
    for c in range(max(1, scene.contacts)):
        note_lag(scene, states[c], dt)
        note_jump(scene, states[c], status, last_age, dt)
        update_energy(scene, states[c], dt)
        size_ball(scene, states[c], dt)


@kernel
def _find_virtual_forces(
    scene: SceneRecord,
    rows: Rows,
    objects: ObjectWork,
    simulate: Simulate,
    fields: Fields,
    states: Table[StateRecord],
    period: float,
    dt: float,
) -> None:
    """Virtual force on every point of contact, from tunnels and objects, which advance by one tick."""
    state = states[0]
    for c in range(max(1, scene.contacts)):
        find_region(scene, device_delay(scene, state), period, states[c].region)
        follow_tunnels(scene, rows.tunnels, objects.tunnels, states[c], c)
    write_object_inputs(states, scene.contacts, dt, objects.inputs)
    simulate(rows, objects, scene.objects, objects.inputs, fields, dt, objects.force)
    state.objects_failed = objects.totals[0].status
    set_virtual_forces(scene, states, objects.force)


@kernel
def _act_on_user(scene: SceneRecord, objects: ObjectWork, states: Table[StateRecord], held: int, dt: float) -> None:
    """Force on the user at every point of contact, and the contacts that begin or end with it."""
    share_device_state(scene, states)
    for c in range(max(1, scene.contacts)):
        set_user_force(scene, states[c], objects.totals[c], objects.touched[c], held, dt)
    stop_together(scene, states)
    rendered = is_rendered(states[0])
    for c in range(max(1, scene.contacts)):
        state = states[c]
        state.contact_change = follow_touch(state, rendered and state.tunnel.wall_force > 0.0, rendered, dt)
        touches, totals = objects.touches[c], objects.totals[c]
        state.partners = follow_touches(touches, totals, objects.motions, scene.objects, c, rendered, dt)


@kernel
def _watch_stability(
    scene: SceneRecord, objects: ObjectWork, states: Table[StateRecord], period: float, dt: float
) -> None:
    """Stability margin, contact energy and oscillation of every point of contact, and their events."""
    for c in range(max(1, scene.contacts)):
        totals, touched = objects.totals[c], objects.touched[c]
        watch_margin(scene, states[c], totals, touched, period)
        watch_contact(scene, states[c], totals, touched, objects.margins, dt)
        watch_swing(states[c], totals, delay_ticks(scene, states[c], dt), dt)
    collect_events(scene, states)


@kernel
def _write_results(
    scene: SceneRecord, objects: ObjectWork, states: Table[StateRecord], dt: float, command: Vec, row: SampleRecord
) -> None:
    """Command for the device, and the outputs of the sample row."""
    write_command(scene, states, dt, command)
    states[0].bodies = sum_motions(objects.motion_words, scene.objects.bodies)
    write_outputs(scene.contacts, states, objects.totals, row)


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
    """Advance the loop by one tick.

    Args:
        scene: SCENE record, the parameters of this tick.
        rows: Tables of the haptic objects.
        objects: Working arrays of the objects, advanced by one tick.
        simulate: The objects' part of the tick, see rendering.haptic.objects.SIMULATE.
        fields: Force fields of the objects.
        kin: Kinematics functions of the device, in the order of contracts.loop.device_descriptor.
        states: STATE records, one for each point of contact, advanced by one tick.
        data: Data vector from the device's read function, shape [DATA_LENGTH].
        status: DeviceStatus of that read.
        stop_word: Not 0 while the stop key requests E_STOP.
        held: Late-tick class of this tick (safety.IN_TIME .. MISSED_STOP).
        period: Measured period [s]; dt in a loop that cannot be late.
        dt: Tick [s].
        command: Receives the command for the device's write function, shape [COMMAND_LENGTH].
        row: SAMPLE record, filled here except for the timing fields.
    """
    state = states[0]
    _begin_tick(scene, objects, states)
    write_inputs(data, status, stop_word, held, period, state, dt, row)
    _read_motion(kin, scene, states, data, status, dt)
    _find_virtual_forces(scene, rows, objects, simulate, fields, states, period, dt)
    note_arrival(kin, scene, states)
    step_safety(scene, states, status, stop_word, held, dt)
    stepped = state.safety
    _act_on_user(scene, objects, states, held, dt)
    follow_extremes(scene, states, dt)
    _watch_stability(scene, objects, states, period, dt)
    if scene.objects.curves > 0:
        leads = is_rendered(state) and person_leads(scene)
        step_reference(scene, rows.curves, state, leads, dt)
    control(kin, scene, states, held, dt)
    if state.safety != stepped:  # force or controller latched a stop
        state.state_changed = 1
    _write_results(scene, objects, states, dt, command, row)
    state.tick += 1
