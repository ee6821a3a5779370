"""The tick: device data in, command out. Live, un-timed and replayed runs call this very function.

    data -> motion -> ball -> tunnel -> objects -> safety -> limiter -> stability -> controller -> command, sample row

Everything that a tick depends on is in its arguments: the device's data and status, the stop word, the late-tick class,
the measured period and the parameter block. All are recorded, so that a recording can be simulated again bit for bit.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import SafetyState, TripCause
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.drive import control, note_arrival
from mimics_app.rendering.haptic.kernels.limiter import limit_force
from mimics_app.rendering.haptic.kernels.objects.hand import write_hand
from mimics_app.rendering.haptic.kernels.objects.touches import follow_touch, follow_touches
from mimics_app.rendering.haptic.kernels.passivity import observe, reset_observer
from mimics_app.rendering.haptic.kernels.rows import write_command, write_inputs, write_objects, write_outputs
from mimics_app.rendering.haptic.kernels.safety import HOLD, is_stopped, latch, step_safety
from mimics_app.rendering.haptic.kernels.sensing import find_motion, size_ball, take_data
from mimics_app.rendering.haptic.kernels.stability import LARGEST_MARGIN, margin_of, stiffness_limit
from mimics_app.rendering.haptic.kernels.state import CONTACT_BEGAN
from mimics_app.rendering.haptic.kernels.tunnel import restart_tracking, tunnel_force
from mimics_app.rendering.haptic.kernels.vectors import copy, fill, norm, rotate_back

__all__ = ["tick"]

Vec = NDArray[np.float64]
Simulate = Callable[..., Any]
Fields = tuple[Callable[..., Any], ...]

_CALM_MARGIN = 0.05
"""A margin that fell below 0 must rise above this before it is told again."""

_ACTIVE = int(SafetyState.ACTIVE)
_DEGRADED = int(SafetyState.DEGRADED)
_SAFE_STOP = int(SafetyState.SAFE_STOP)
_NOT_FINITE = int(TripCause.NOT_FINITE)


@kernel
def _follow_contacts(objects: Any, counts: Any, state: Any, dt: float) -> None:
    """Begin and end of contacts with the tunnel's wall and with objects; only what the user can feel counts."""
    felt = state.safety == _ACTIVE or state.safety == _DEGRADED
    state.contact_change = follow_touch(state, felt and state.tunnel.wall_force > 0.0, felt, dt)
    began = follow_touches(objects, counts, felt, dt) + (1 if state.contact_change == CONTACT_BEGAN else 0)
    if began > 0:
        state.contacts += began
        state.contact_tick = state.tick


@kernel
def _limit(scene: Any, state: Any, held: int, dt: float) -> None:
    """Force the user feels: held in a late tick, zero in a stop state, else the limited and ramped virtual force."""
    if is_stopped(state):
        fill(state.f_user_world, 0.0)
    elif held != HOLD and not limit_force(
        state.f_virt_world, state.ramp, scene.force_limit, scene.force_rate_limit * dt, state.f_user_world
    ):
        latch(state, _SAFE_STOP, _NOT_FINITE)
    rotate_back(scene.R_world_from_robot, state.f_user_world, state.f_user)


@kernel
def _share_of_wall(state: Any, held: int) -> None:
    """The wall's part of the force the user feels: the limiter scales the whole, a held tick holds it too."""
    if held == HOLD and not is_stopped(state):
        return
    wanted = norm(state.f_virt_world)
    scale = state.tunnel.wall_force * norm(state.f_user_world) / wanted if wanted > 0.0 else 0.0
    for i in range(3):
        state.f_wall_world[i] = scale * state.tunnel.normal_world[i]


@kernel
def _watch_margin(scene: Any, state: Any, period: float) -> None:
    """Stability limit and margin of the wall for the measured period; tells when it is lost, and does not act."""
    tunnel = scene.tunnel
    damping = scene.virtual_damping + scene.arm_damping + tunnel.damping
    state.period = period
    state.stiffness_limit = stiffness_limit(damping, period, max(scene.device_delay, state.delay))
    stiffness = tunnel.stiffness + tunnel.centring if tunnel.pieces > 0 else 0.0
    state.margin = margin_of(state.stiffness_limit, stiffness)
    felt = state.safety == _ACTIVE or state.safety == _DEGRADED
    state.margin_lost = 1 if felt and state.margin < 0.0 and state.warned == 0 else 0
    if state.margin_lost == 1:
        state.warned = 1
    elif state.margin > _CALM_MARGIN:
        state.warned = 0


@kernel
def _watch_contact(state: Any) -> None:
    """Energy of the contact by the passivity observer, and the worst of all contacts."""
    observer = state.observer
    if state.contact_change == CONTACT_BEGAN:
        reset_observer(observer)
    observe(observer, state.hip_world, state.f_wall_world)
    state.least_energy = min(state.least_energy, observer.lowest)
    if state.in_contact == 0:
        return
    if state.touched == 0:
        state.touched = 1
        state.least_margin = LARGEST_MARGIN
        state.least_limit = state.stiffness_limit
    state.least_margin = min(state.least_margin, state.margin)
    state.least_limit = min(state.least_limit, state.stiffness_limit)


@kernel
def tick(
    scene: Any,
    rows: Any,
    objects: Any,
    simulate: Simulate,
    fields: Fields,
    state: Any,
    data: Vec,
    status: int,
    stop_word: int,
    held: int,
    period: float,
    dt: float,
    command: Vec,
    row: Any,
) -> None:
    """One tick.

    Args:
        scene: SCENE record, the parameters of this tick.
        rows: Tables of haptic objects beside it.
        objects: Working arrays of the objects, advanced by one tick.
        simulate: The objects' part of the tick, see rendering.haptic.objects.SIMULATE.
        fields: Force fields of the objects.
        state: STATE record, advanced by one tick.
        data: What the device's read gave, shape [DATA_LENGTH].
        status: DeviceStatus of that read.
        stop_word: Not 0 while the stop key asks for E_STOP.
        held: Late-tick class of this tick (safety.IN_TIME .. MISSED_STOP).
        period: Measured period [s]; dt where nothing can be late.
        dt: Tick [s].
        command: What the device's write takes, shape [COMMAND_LENGTH], filled here.
        row: SAMPLE record, filled here except for the timing fields.
    """
    state.tripped = 0
    state.parameters_taken = 1 if scene.sequence != state.sequence else 0
    state.sequence = scene.sequence
    if scene.trial != state.trial:
        state.trial = scene.trial
        restart_tracking(state.tunnel)
    write_inputs(data, status, stop_word, held, period, state, dt, row)

    take_data(scene, state, data, status, dt)
    find_motion(scene, state)
    size_ball(scene, state, dt)
    tunnel_force(scene.tunnel, state.hip_world, state.v_world, state.ball_radius, state.tunnel)
    copy(state.tunnel.force_world, state.f_virt_world)
    write_hand(state, dt, objects.hand)
    simulate(rows, objects, scene.objects, objects.hand, fields, dt, objects.force)
    state.objects_failed = objects.totals[0].status
    for i in range(3):
        state.f_virt_world[i] += objects.force[i]

    note_arrival(scene, state)
    step_safety(scene, state, status, stop_word, held, dt)
    before = state.safety
    _limit(scene, state, held, dt)
    _share_of_wall(state, held)
    _follow_contacts(objects, scene.objects, state, dt)
    _watch_margin(scene, state, period)
    _watch_contact(state)
    control(scene, state, held, dt)
    if state.safety != before:
        state.state_changed = 1
    write_command(state, command)
    write_outputs(state, row)
    write_objects(objects, scene.objects, row)
    state.tick += 1
