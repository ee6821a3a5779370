"""What acts on the user: virtual forces after stiffness cap, passivity controller, energy tank and limiter.

    contacts   tunnel wall and shapes that cannot move: no stiffer than stable, and never giving more than they took
    active     assistance, effects, what is held, shapes that can move: paid from the energy tank
    the rest   drag: takes energy only

`account` comes before the safety states, `act` after them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.haptic import Controller, SafetyState, TripCause
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.contact_limits import common_share, is_pressed
from mimics_app.rendering.haptic.kernels.limiter import limit_force, limit_held
from mimics_app.rendering.haptic.kernels.passivity_control import contact_scale, limited_credit, middle_velocity
from mimics_app.rendering.haptic.kernels.safety import HOLD, is_stopped, latch
from mimics_app.rendering.haptic.kernels.tank import payable_share, settle_account
from mimics_app.rendering.haptic.kernels.tunnels import share_in_touch
from mimics_app.rendering.haptic.kernels.vectors import fill, norm, rotate, rotate_back, scale

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import SceneRecord, StateRecord, Table, TotalsRecord, TouchedRecord

__all__ = ["ACTING", "FREE_TIME", "account", "act", "acting_contact", "device_delay", "own_damping"]


_LINE = 32
"""Ticks of delay that can be counted; what is longer is counted as this."""

ACTING = np.dtype(
    [
        ("known", "i8"),  # 1 once `position` means something
        ("position", "f8", (3,)),  # of the last tick, world [m]
        ("v", "f8", (3,)),  # of what the forces act on, world [m/s]: virtual mass or device
        ("displacement", "f8", (3,)),  # what it has gone since the last tick [m]
        ("contact", "f8", (3,)),  # share of the contacts in the force on the user, held since then, world [N]
        ("active", "f8", (3,)),  # share of the active forces in it [N]
        ("contacts", "f8", (_LINE, 3)),  # `contact` of the last ticks, by tick
        ("actives", "f8", (_LINE, 3)),  # `active` likewise
        ("credit", "f8"),  # what contacts may still give [J]; below 0 they owe
        ("free_ticks", "i8"),  # in a row without a contact
        ("tank", "f8"),  # [J]
        ("filled", "i8"),  # 1 once the tank was filled
        ("inflow", "f8"),  # into the tank [W]
        ("wall_share", "f8"),  # of the tunnel wall's stiffness that is rendered
        ("shape_share", "f8"),  # of the forces of touched shapes that is rendered
        ("both_share", "f8"),  # of wall and shapes alike while both are touched, as of the last tick; else 1
        ("touching", "i8"),  # 1 while a shape was touched in the last tick
        ("tank_share", "f8"),  # of the active forces that is paid
        ("passivity", "f8"),  # force that the passivity controller took away [N]
        ("least_share", "f8"),  # least stiffness share that was felt in a contact; 0: none yet
        ("least_tank", "f8"),  # least level of the tank [J]
        ("passivity_ticks", "i8"),  # ticks in which the passivity controller acted
    ],
    align=True,
)
"""Memory of what acts on one haptic point; zeros are a fresh one."""

FREE_TIME = 0.02
"""So long without a contact, its debts are forgiven [s]."""

_ACTIVE = int(SafetyState.ACTIVE)
_DEGRADED = int(SafetyState.DEGRADED)
_SAFE_STOP = int(SafetyState.SAFE_STOP)
_NOT_FINITE = int(TripCause.NOT_FINITE)

_STABLE_DAMPER = 0.5
"""A damper of this many masses a tick stops a mass in two ticks; from 2 on it would swing up."""


@kernel
def device_delay(scene: SceneRecord, state: StateRecord) -> float:
    """From a command to its motion [s]: what the device states or what it measures, whichever is longer."""
    return max(scene.device_delay, state.delay)


@kernel
def own_damping(scene: SceneRecord) -> float:
    """Damping that every contact can count on: virtual, the device's own, and the arm's [N s/m]."""
    return scene.virtual_damping + scene.device_damping + scene.arm_damping


@kernel
def _find_displacement(scene: SceneRecord, state: StateRecord, dt: float) -> None:
    """How far what the forces act on has gone since the last tick, exactly for a force held meanwhile.

    The virtual mass goes (v_{k-1} + v_k) T / 2 under a constant force, the device from one position to the next. A
    position that jumped is no displacement: it stops the loop on its own.
    """
    acting = state.acting
    admittance = scene.controller == Controller.ADMITTANCE
    if admittance:
        rotate(scene.R_world_from_robot, state.v_virtual, state.work_a)
    for i in range(3):
        if admittance:
            acting.displacement[i] = 0.5 * (acting.v[i] + state.work_a[i]) * dt
            acting.v[i] = state.work_a[i]
        else:
            gone = state.hip_world[i] - acting.position[i]
            acting.displacement[i] = gone if acting.known + state.jumped == 1 else 0.0
            acting.v[i] = state.v_world[i]
        acting.position[i] = state.hip_world[i]


@kernel
def delay_ticks(scene: SceneRecord, state: StateRecord, dt: float) -> int:
    """Ticks from a force to where it acts: the virtual mass takes it at once, a device after its delay."""
    if scene.force_driven == 0:
        return 0
    return min(_LINE - 2, int(device_delay(scene, state) / dt + 0.5))


@kernel
def _lay_down(state: StateRecord) -> None:
    """Remember this tick's shares of the force on the user for when they act."""
    acting = state.acting
    slot = state.tick % _LINE
    for i in range(3):
        acting.contacts[slot, i] = acting.contact[i]
        acting.actives[slot, i] = acting.active[i]


@kernel
def acting_contact(scene: SceneRecord, state: StateRecord, dt: float, f: Vec) -> None:
    """Share of the contacts f [N] in what acts from this tick on, world frame; after `act`."""
    late = delay_ticks(scene, state, dt)
    slot = (state.tick - late) % _LINE
    for i in range(3):
        f[i] = state.acting.contacts[slot, i] if state.tick >= late else 0.0


@kernel
def _under_way(scene: SceneRecord, state: StateRecord, dt: float) -> float:
    """Energy [J] that contact forces which were sent but do not act yet will give at the present velocity."""
    acting = state.acting
    energy = 0.0
    for late in range(1, min(delay_ticks(scene, state, dt), state.tick) + 1):
        slot = (state.tick - late) % _LINE
        for i in range(3):
            energy += acting.contacts[slot, i] * acting.v[i] * dt
    return energy


@kernel
def account(scene: SceneRecord, state: StateRecord, dt: float) -> None:
    """Count the exact work of the forces held since the last tick: credit of the contacts, and energy tank."""
    acting = state.acting
    if acting.filled == 0 and scene.sequence > 0:
        acting.filled = 1
        acting.tank = scene.tank_size
        acting.least_tank = scene.tank_size
    if acting.known == 0:
        acting.wall_share = 1.0
        acting.shape_share = 1.0
        acting.both_share = 1.0
    _find_displacement(scene, state, dt)
    acting.known = 1
    active = 0.0
    acted = state.tick - 1 - delay_ticks(scene, state, dt)
    if acted >= 0:
        slot = acted % _LINE
        for i in range(3):
            acting.credit -= acting.contacts[slot, i] * acting.displacement[i]
            active += acting.actives[slot, i] * acting.displacement[i]
    speed = norm(acting.v)
    acting.inflow = scene.tank_refill + scene.tank_return * scene.virtual_damping * speed * speed
    acting.tank = settle_account(acting.tank, active, acting.inflow, scene.tank_size, dt)
    acting.least_tank = min(acting.least_tank, acting.tank)


@kernel
def _cap_shapes(
    scene: SceneRecord, state: StateRecord, totals: TotalsRecord, touched: Table[TouchedRecord], period: float
) -> None:
    """Choose how much of the touched shapes is rendered; it may not rise while any is touched."""
    acting = state.acting
    share, is_touching = 1.0, totals.touching > 0
    if scene.cap == 1 and is_touching:
        lag = 0.5 * period + device_delay(scene, state)
        share = common_share(scene, state, totals, touched, own_damping(scene), lag)
    acting.both_share = share if is_touching and is_pressed(state) else 1.0
    acting.shape_share = share_in_touch(acting.shape_share, share, is_touching and acting.touching == 1)
    acting.touching = 1 if is_touching else 0


@kernel
def _sort(scene: SceneRecord, state: StateRecord, totals: TotalsRecord) -> None:
    """Raw contact and active forces into state.f_contact and state.f_active [N], shapes capped."""
    acting = state.acting
    movable = totals.touching > totals.static_touching
    for i in range(3):
        shapes = acting.shape_share * totals.shape_force[i]
        state.f_contact[i] = state.tunnel.wall_force * state.tunnel.normal_world[i]
        state.f_active[i] = state.tunnel.assist_world[i] + totals.effect_force[i] + totals.grip_force[i]
        if movable:
            state.f_active[i] += shapes
        else:
            state.f_contact[i] += shapes


@kernel
def _follow_credit(scene: SceneRecord, state: StateRecord, totals: TotalsRecord, dt: float) -> None:
    """No more credit than the springs can hold, and none and no debt after a while of free motion."""
    acting = state.acting
    touching = norm(state.f_contact) > 0.0
    acting.free_ticks = 0 if touching else acting.free_ticks + 1
    depth = state.tunnel.penetration
    stored = acting.wall_share * state.tunnel.stiffness * depth * depth
    if totals.touching > 0:
        stored += acting.shape_share * totals.stiffness * totals.depth * totals.depth
    acting.credit = limited_credit(acting.credit, stored)
    if acting.free_ticks * dt >= FREE_TIME:
        acting.credit = 0.0


@kernel
def _take_back(scene: SceneRecord, state: StateRecord, dt: float) -> float:
    """Passivity controller: the factor >= 0 on the contacts' force; it never makes them pull."""
    acting = state.acting
    acting.passivity = 0.0
    felt = state.safety == _ACTIVE or state.safety == _DEGRADED
    if scene.passivity == 0 or not felt:
        return 1.0
    most, v = scene.passivity_damping, acting.v
    if scene.controller == Controller.ADMITTANCE:
        most = min(most, _STABLE_DAMPER * scene.virtual_mass / dt)
        v = state.work_b
        for i in range(3):
            state.work_a[i] = state.f_contact[i] + state.f_active[i]
        middle_velocity(acting.v, state.work_a, state.f_meas_world, scene.virtual_mass, dt, v)
    credit = acting.credit - _under_way(scene, state, dt)
    factor = contact_scale(credit, state.f_contact, v, dt, most)
    acting.passivity = abs(1.0 - factor) * norm(state.f_contact)
    acting.passivity_ticks += 1 if acting.passivity > 0.0 else 0
    return factor


@kernel
def _pay(state: StateRecord) -> float:
    """Share of the active forces that the tank can pay at the present speed."""
    power = 0.0
    for i in range(3):
        power += state.f_active[i] * state.acting.v[i]
    return payable_share(state.acting.tank, power, state.acting.inflow)


@kernel
def _compose(
    scene: SceneRecord,
    state: StateRecord,
    totals: TotalsRecord,
    touched: Table[TouchedRecord],
    period: float,
    dt: float,
) -> None:
    """state.f_wanted: the virtual force less what cap, passivity controller and tank take away; its two shares."""
    acting = state.acting
    _cap_shapes(scene, state, totals, touched, period)
    _sort(scene, state, totals)
    _follow_credit(scene, state, totals, dt)
    factor = _take_back(scene, state, dt)
    acting.tank_share = _pay(state)
    viscosity = scene.virtual_damping if scene.controller == Controller.IMPEDANCE else 0.0
    for i in range(3):
        less = (1.0 - acting.shape_share) * totals.shape_force[i]
        less += (1.0 - factor) * state.f_contact[i] + (1.0 - acting.tank_share) * state.f_active[i]
        state.f_wanted[i] = state.f_virt_world[i] - less - viscosity * state.v_world[i]
        acting.contact[i] = factor * state.f_contact[i]
        acting.active[i] = acting.tank_share * state.f_active[i]


@kernel
def act(
    scene: SceneRecord,
    state: StateRecord,
    totals: TotalsRecord,
    touched: Table[TouchedRecord],
    held: int,
    period: float,
    dt: float,
) -> None:
    """Force the user feels: held in a late tick, zero in a stop state, else composed, limited and ramped.

    Args:
        scene: SCENE record.
        state: STATE record; f_user_world and f_user are set.
        totals: TOTALS record: what the objects do to the user.
        touched: TOUCHED records of its contacts.
        held: Late-tick class.
        period: Measured period [s].
        dt: Tick [s].
    """
    acting = state.acting
    f = state.f_user_world
    if held == HOLD and not is_stopped(state):
        factor = limit_held(state.v_world, scene.power_limit, f)
        scale(acting.contact, factor)
        scale(acting.active, factor)
    else:
        _compose(scene, state, totals, touched, period, dt)
        rise = scene.force_rate_limit * dt
        if is_stopped(state):
            fill(f, 0.0)
        elif not limit_force(state.f_wanted, state.ramp, scene.force_limit, rise, state.v_world, scene.power_limit, f):
            latch(state, _SAFE_STOP, _NOT_FINITE)
        wanted = norm(state.f_wanted)
        felt = norm(f) / wanted if wanted > 0.0 else 0.0
        scale(acting.contact, felt)
        scale(acting.active, felt)
    if is_stopped(state):
        acting.credit = 0.0
    _lay_down(state)
    rotate_back(scene.R_world_from_robot, f, state.f_user)
