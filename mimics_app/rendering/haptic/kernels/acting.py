"""Force on the user: virtual forces after stiffness cap, passivity controller, energy tank and limiter.

    contacts   tunnel wall and static shapes: no stiffer than stable, and never giving more energy than they took
    active     assistance, effects, held bodies, movable shapes: paid from the energy tank, which they fill as well
    the rest   drag and viscosity: what they take is lost; what they would give, by a delay, the tank pays

Every part of the force on the user is in one of these accounts: the rest is what the others leave of the whole.

`update_energy` runs before the safety state machine, `set_user_force` after it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.haptic import SafetyState, TripCause
from mimics_app.maths.vec import copy, dot, fill, norm, rotate, rotate_back, scale
from mimics_app.rendering.haptic.kernels.closed_region import contact_share
from mimics_app.rendering.haptic.kernels.contact_limits import common_share, is_pressed
from mimics_app.rendering.haptic.kernels.controller_slot import moves_mass
from mimics_app.rendering.haptic.kernels.limiter import limit_force, limit_held
from mimics_app.rendering.haptic.kernels.oscillation import begin_swing
from mimics_app.rendering.haptic.kernels.passivity_control import contact_scale, middle_velocity, stored_share
from mimics_app.rendering.haptic.kernels.safety import HOLD, is_rendered, is_stopped, latch
from mimics_app.rendering.haptic.kernels.tunnels import share_in_touch

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import SceneRecord, StateRecord, Table, TotalsRecord, TouchedRecord

__all__ = [
    "ACTING",
    "FREE_TIME",
    "acting_contact",
    "delay_ticks",
    "device_delay",
    "drop_force",
    "payable_share",
    "set_user_force",
    "tank_level",
    "update_energy",
]


_LINE = 32
"""Length of the delay line of sent forces [ticks]; longer device delays are clamped to it."""

ACTING = np.dtype(
    [
        ("known", "i8"),  # 1 once `position` is valid
        ("position", "f8", (3,)),  # of the last tick, world [m]
        ("v", "f8", (3,)),  # of virtual mass or device, whichever the forces act on, world [m/s]
        ("displacement", "f8", (3,)),  # of the same since the last tick [m]
        ("contact", "f8", (3,)),  # contacts' share of the force on the user, held since the last tick, world [N]
        ("active", "f8", (3,)),  # active forces' share of it [N]
        ("rest", "f8", (3,)),  # what is neither [N]
        ("limited", "f8", (2,)),  # shares of the last and of the wanted force in this tick's, by the limiter
        ("contacts", "f8", (_LINE, 3)),  # delay line of `contact`, by tick
        ("actives", "f8", (_LINE, 3)),  # delay line of `active`
        ("rests", "f8", (_LINE, 3)),  # delay line of `rest`
        ("credit", "f8"),  # energy contacts may still give [J]; below 0: debt
        ("ramp", "f8"),  # soft-start factor of the last tick
        ("free_ticks", "i8"),  # in a row without a contact
        ("tank", "f8"),  # level [J]
        ("filled", "i8"),  # 1 once the tank was filled
        ("inflow", "f8"),  # into the tank [W]
        ("wall_share", "f8"),  # rendered share of the tunnel wall's stiffness
        ("shape_share", "f8"),  # rendered share of the forces of touched shapes
        ("effect_share", "f8"),  # rendered share of the forces of effects and of a held body
        ("both_share", "f8"),  # common share of wall and shapes in the last tick while both were touched, else 1
        ("touching", "i8"),  # 1: a shape was touched in the last tick
        ("tank_share", "f8"),  # share of the active forces that the tank pays
        ("rendered_share", "f8"),  # share of the wanted force that limiter and detector of oscillation left
        ("at_limit", "i8"),  # 1 from a force at force_limit until one below half of it
        ("passivity", "f8"),  # magnitude removed by the passivity controller [N]
        ("least_share", "f8"),  # smallest stiffness share felt in a contact; 0: none yet
        ("least_tank", "f8"),  # lowest level of the tank [J]
        ("passivity_ticks", "i8"),  # ticks in which the passivity controller acted
    ],
    align=True,
)
"""Energy accounts and rendered shares of one point of contact; zeros are the initial state."""

FREE_TIME = 0.02
"""Time without contact after which credit and debt are cleared [s]."""


_STABLE_DAMPER = 0.5
"""Largest damper of the passivity controller [virtual masses per tick]; from 2 on it would oscillate."""


_AT_LIMIT = 1.0 - 1e-9
"""Share of its limit from which a force is at it [-]: three components are rounded."""

_EMPTYING_TIME = 0.1
"""Shortest time in which active forces may empty the tank [s], so that they fade instead of breaking off."""


@kernel
def tank_level(level: float, given: float, inflow: float, size: float, dt: float) -> float:
    """Level of the tank [J] after a tick.

    Args:
        level: Level before the tick [J].
        given: Work of the active forces on the user [J]; below 0: work of the user on them.
        inflow: Refill [W].
        size: Capacity [J].
        dt: Tick [s].
    """
    return min(size, max(0.0, level - given + inflow * dt))


@kernel
def payable_share(level: float, power: float, inflow: float) -> float:
    """Share 0-1 of the active forces that can be paid, where all of them would give `power` [W] to the user.

    Available are the refill and the level within the emptying time; forces that absorb power are free.
    """
    allowed = inflow + level / _EMPTYING_TIME
    return allowed / power if power > allowed else 1.0


@kernel
def device_delay(scene: SceneRecord, state: StateRecord) -> float:
    """Delay from a command to its motion [s]: the stated or the measured one, whichever is longer."""
    return max(scene.device_delay, state.delay)


@kernel
def _find_displacement(scene: SceneRecord, state: StateRecord, dt: float) -> None:
    """Set displacement and velocity of virtual mass or device since the last tick, exact for a held force.

    The virtual mass moves by (v_{k-1} + v_k) T / 2 under a constant force, the device from one position to the next. A
    jump of the position is no displacement: it stops the loop on its own.
    """
    acting = state.acting
    admittance = moves_mass(scene)
    if admittance:
        rotate(scene.R_world_from_robot, state.v_virtual, state.work_a)
    for i in range(3):
        if admittance:
            acting.displacement[i] = 0.5 * (acting.v[i] + state.work_a[i]) * dt
            acting.v[i] = state.work_a[i]
        else:
            moved = state.hip_world[i] - acting.position[i]
            acting.displacement[i] = moved if acting.known == 1 and state.jumped == 0 else 0.0
            acting.v[i] = state.v_world[i]
        acting.position[i] = state.hip_world[i]


@kernel
def delay_ticks(scene: SceneRecord, state: StateRecord, dt: float) -> int:
    """Ticks until a force acts: none on the virtual mass, the device's delay on a force-driven device."""
    if scene.force_driven == 0:
        return 0
    return min(_LINE - 2, int(device_delay(scene, state) / dt + 0.5))


@kernel
def _store_shares(state: StateRecord) -> None:
    """Write this tick's shares of the force on the user to the delay line."""
    acting = state.acting
    slot = state.tick % _LINE
    copy(acting.contact, acting.contacts[slot])
    copy(acting.active, acting.actives[slot])
    copy(acting.rest, acting.rests[slot])


@kernel
def drop_force(state: StateRecord) -> None:
    """Take the whole force off the user in this tick, after it was set: from the accounts and the delay line too."""
    acting = state.acting
    fill(state.f_user_world, 0.0)
    fill(state.f_user, 0.0)
    fill(acting.limited, 0.0)
    fill(acting.contact, 0.0)
    fill(acting.active, 0.0)
    fill(acting.rest, 0.0)
    acting.rendered_share = 0.0
    acting.credit = 0.0
    _store_shares(state)


@kernel
def acting_contact(scene: SceneRecord, state: StateRecord, dt: float, f: Vec) -> None:
    """Write to f the contacts' share of the force that acts from now on, world [N]; after `set_user_force`."""
    late = delay_ticks(scene, state, dt)
    slot = (state.tick - late) % _LINE
    for i in range(3):
        f[i] = state.acting.contacts[slot, i] if state.tick >= late else 0.0


@kernel
def _energy_in_flight(scene: SceneRecord, state: StateRecord, dt: float) -> float:
    """Energy [J] that contact forces sent but still in the delay line will give at the present velocity."""
    acting = state.acting
    energy = 0.0
    for late in range(1, min(delay_ticks(scene, state, dt), state.tick) + 1):
        slot = (state.tick - late) % _LINE
        for i in range(3):
            energy += acting.contacts[slot, i] * acting.v[i] * dt
    return energy


@kernel
def update_energy(scene: SceneRecord, state: StateRecord, dt: float) -> None:
    """Book the exact work of the forces held since the last tick to the contacts' credit and the energy tank."""
    acting = state.acting
    if acting.filled == 0 and scene.sequence > 0:
        acting.filled = 1
        acting.tank = scene.tank_size
        acting.least_tank = scene.tank_size
    if acting.known == 0:
        acting.wall_share = 1.0
        acting.shape_share = 1.0
        acting.effect_share = 1.0
        acting.both_share = 1.0
    _find_displacement(scene, state, dt)
    acting.known = 1
    active, rest = 0.0, 0.0
    acted = state.tick - 1 - delay_ticks(scene, state, dt)
    if acted >= 0:
        slot = acted % _LINE
        for i in range(3):
            acting.credit -= acting.contacts[slot, i] * acting.displacement[i]
            active += acting.actives[slot, i] * acting.displacement[i]
            rest += acting.rests[slot, i] * acting.displacement[i]
    speed = norm(acting.v)
    acting.inflow = scene.tank_refill + scene.tank_return * scene.virtual_damping * speed * speed
    acting.tank = tank_level(acting.tank, active + max(0.0, rest), acting.inflow, scene.tank_size, dt)
    acting.least_tank = min(acting.least_tank, acting.tank)


@kernel
def _cap_effects(scene: SceneRecord, state: StateRecord, totals: TotalsRecord) -> None:
    """Set the rendered share of effects and held bodies; it does not rise while one of them holds."""
    acting = state.acting
    k, b, share = totals.even_stiffness, totals.even_damping, 1.0
    if scene.cap == 1 and (k != 0.0 or b != 0.0):
        share = contact_share(state.region, k, b, scene.cap_margin)
    acting.effect_share = share_in_touch(acting.effect_share, share, k > 0.0 or b > 0.0)


@kernel
def _cap_shapes(scene: SceneRecord, state: StateRecord, totals: TotalsRecord, touched: Table[TouchedRecord]) -> None:
    """Set the rendered share of the touched shapes; it does not rise while any is touched."""
    acting = state.acting
    share, is_touching = 1.0, totals.touching > 0
    if scene.cap == 1 and is_touching:
        share = common_share(scene, state, totals, touched)
    acting.both_share = share if is_touching and is_pressed(state) else 1.0
    acting.shape_share = share_in_touch(acting.shape_share, share, is_touching and acting.touching == 1)
    acting.touching = 1 if is_touching else 0


@kernel
def _split_forces(state: StateRecord, totals: TotalsRecord) -> None:
    """Set state.f_contact, f_active and f_rest [N], shapes and effects at their capped shares."""
    acting = state.acting
    movable = totals.touching > totals.static_touching
    for i in range(3):
        shapes = acting.shape_share * totals.shape_force[i]
        state.f_contact[i] = state.tunnel.wall_force * state.tunnel.normal_world[i]
        effects = totals.effect_force[i] + totals.grip_force[i]
        state.f_active[i] = state.tunnel.assist_world[i] + acting.effect_share * effects
        state.f_rest[i] = state.f_virt_world[i] - totals.shape_force[i] - state.f_contact[i] - effects
        state.f_rest[i] -= state.tunnel.assist_world[i] + state.region.viscosity * state.v_world[i]
        if movable:
            state.f_active[i] += shapes
        else:
            state.f_contact[i] += shapes


@kernel
def _limit_credit(state: StateRecord, totals: TotalsRecord, dt: float) -> None:
    """Limit the credit to the energy of the springs; clear credit and debt after FREE_TIME of free motion."""
    acting = state.acting
    touching = norm(state.f_contact) > 0.0
    acting.free_ticks = 0 if touching else acting.free_ticks + 1
    depth = state.tunnel.penetration
    stored = acting.wall_share * state.tunnel.stiffness * depth * depth
    if totals.touching > 0:
        stored += acting.shape_share * totals.stiffness * totals.depth * totals.depth
    acting.credit += 0.5 * stored * max(0.0, state.ramp - acting.ramp)  # the soft start stiffens what is pressed
    acting.ramp = state.ramp
    acting.credit = min(acting.credit, stored)  # lost energy is no credit: it would hide energy generated later
    if acting.free_ticks * dt >= FREE_TIME:
        acting.credit = 0.0


@kernel
def _stored_share(state: StateRecord, totals: TotalsRecord, energy: float, v: Vec, dt: float) -> float:
    """Share 0-1 of the contacts' force whose springs could have stored their energy [J].

    The springs are soft while the force comes up and while it is calmed; several count as one at the largest depth.
    """
    acting, f = state.acting, state.f_contact
    spring, depth = acting.wall_share * state.tunnel.stiffness * state.tunnel.penetration, state.tunnel.penetration
    if totals.touching > 0:
        spring += acting.shape_share * totals.stiffness * totals.depth
        depth = max(depth, totals.depth)
    size, share = norm(f), state.ramp * state.swing.calm
    step = dot(f, v) * dt / size
    return stored_share(energy, share * spring, share * size, depth, step)


@kernel
def _passivity_factor(scene: SceneRecord, state: StateRecord, totals: TotalsRecord, dt: float) -> float:
    """Factor 0-1 of the passivity controller on the contacts' force."""
    acting = state.acting
    acting.passivity = 0.0
    size = norm(state.f_contact)
    if scene.passivity == 0 or not is_rendered(state) or size == 0.0:
        return 1.0
    most, v = scene.passivity_damping, acting.v
    if moves_mass(scene):
        most = min(most, _STABLE_DAMPER * scene.virtual_mass / dt)
        v = state.work_b
        for i in range(3):
            state.work_a[i] = state.f_contact[i] + state.f_active[i]
        middle_velocity(acting.v, state.work_a, state.f_meas_world, scene.virtual_mass, dt, v)
    credit = acting.credit - _energy_in_flight(scene, state, dt)
    factor = min(_stored_share(state, totals, credit, v, dt), contact_scale(credit, state.f_contact, v, dt, most))
    acting.passivity = max(0.0, min(size, scene.force_limit) - factor * size)
    acting.passivity_ticks += 1 if acting.passivity > 0.0 else 0
    return factor


@kernel
def _pay(state: StateRecord) -> None:
    """Scale the active forces, and dampers that would give energy, to what the tank can pay at the present velocity."""
    acting = state.acting
    active, rest = 0.0, 0.0
    for i in range(3):
        active += state.f_active[i] * acting.v[i]
        rest += state.f_rest[i] * acting.v[i]
    acting.tank_share = payable_share(acting.tank, active + max(0.0, rest), acting.inflow)
    scale(state.f_active, acting.tank_share)
    if rest > 0.0:
        scale(state.f_rest, acting.tank_share)


@kernel
def _compose(
    scene: SceneRecord,
    state: StateRecord,
    totals: TotalsRecord,
    touched: Table[TouchedRecord],
    dt: float,
) -> None:
    """Set state.f_wanted, the sum of the accounts after cap, passivity controller and tank."""
    _cap_effects(scene, state, totals)
    _cap_shapes(scene, state, totals, touched)
    _split_forces(state, totals)
    _limit_credit(state, totals, dt)
    scale(state.f_contact, _passivity_factor(scene, state, totals, dt))
    _pay(state)
    scale(state.f_contact, state.swing.calm)
    scale(state.f_active, state.swing.calm)
    scale(state.f_rest, state.swing.calm)
    for i in range(3):
        state.f_wanted[i] = state.f_contact[i] + state.f_active[i] + state.f_rest[i]


@kernel
def _book(state: StateRecord) -> None:
    """Divide the force on the user among the accounts, by the limiter's shares of the last and of the wanted force."""
    acting = state.acting
    kept, new = acting.limited[0], acting.limited[1]
    scale(acting.contact, kept)
    scale(acting.active, kept)
    scale(acting.rest, kept)
    if new > 0.0:  # else the wanted force may not be finite
        for i in range(3):
            acting.contact[i] += new * state.f_contact[i]
            acting.active[i] += new * state.f_active[i]
            acting.rest[i] += new * state.f_rest[i]


@kernel
def _note_limit(scene: SceneRecord, state: StateRecord) -> None:
    """Note whether the force is at `force_limit`, cut there; again only once it was below half of it."""
    force = norm(state.f_user_world)
    cut = state.ramp * norm(state.f_wanted) > scene.force_limit
    reached = is_rendered(state) and cut and force >= _AT_LIMIT * scene.force_limit
    state.limit_began = 1 if reached and state.acting.at_limit == 0 else 0
    if reached:
        state.acting.at_limit = 1
    elif force < 0.5 * scene.force_limit:
        state.acting.at_limit = 0


@kernel
def set_user_force(
    scene: SceneRecord,
    state: StateRecord,
    totals: TotalsRecord,
    touched: Table[TouchedRecord],
    held: int,
    dt: float,
) -> None:
    """Set the force on the user: held in a late tick, zero in a stop state, else composed, limited and ramped.

    Args:
        scene: SCENE record.
        state: STATE record; f_user_world and f_user are set.
        totals: TOTALS record of this point of contact.
        touched: TOUCHED records of its contacts.
        held: Late-tick class.
        dt: Tick [s].
    """
    acting = state.acting
    f = state.f_user_world
    begin_swing(state.swing)
    acting.limited[0], acting.limited[1] = 0.0, 0.0
    if held == HOLD and not is_stopped(state):
        acting.limited[0] = limit_held(state.v_world, scene.power_limit, f)
    else:
        _compose(scene, state, totals, touched, dt)
        rise, most = scene.force_rate_limit * dt, scene.force_limit
        if is_stopped(state):
            fill(f, 0.0)
        elif not limit_force(
            state.f_wanted, state.ramp, most, rise, state.v_world, scene.power_limit, f, acting.limited
        ):
            latch(state, SafetyState.SAFE_STOP, TripCause.NOT_FINITE)
        acting.rendered_share = acting.limited[1] * state.swing.calm
    _note_limit(scene, state)
    _book(state)
    if is_stopped(state):
        acting.credit = 0.0
    _store_shares(state)
    rotate_back(scene.R_world_from_robot, f, state.f_user)
