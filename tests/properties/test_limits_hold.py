"""Every limit of the loop under an adversary: force, rate, power, commanded velocity, workspace, in one compiled loop.

In a tunnel, and among objects: every shape and effect, bodies that fly about, a force field that breaks.

The adversary knows the numbers: NaN, infinities, sizes up to the largest float, jumps, stuck sensors, signs that
alternate from tick to tick, lateness of every class. A law that breaks in one tick of a million fails the test.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from numba import from_dtype, types

from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.device_descriptor import KINEMATICS_SET
from mimics_app.contracts.loop.haptic import SAMPLE, SCENE
from mimics_app.contracts.loop.haptic_objects import EffectKind, ShapeKind
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_FORCE,
    COMMAND_LENGTH,
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DELAY,
    DATA_DQ,
    DATA_FORCE,
    DATA_GRASP,
    DATA_LENGTH,
    DATA_Q,
    FIELD,
    FIELDS,
)
from mimics_app.maths.vec import norm
from mimics_app.rendering.haptic.kernels.kinematics import apply_jacobian
from mimics_app.rendering.haptic.kernels.noise import seed_noise, uniform
from mimics_app.rendering.haptic.kernels.state import STATE
from mimics_app.rendering.haptic.loop_tick import SIMULATION, TICK, tick
from mimics_app.rendering.haptic.no_objects import NO_FIELDS, load_simulation, no_objects
from mimics_app.rendering.haptic.objects import OBJECT_WORK, ROWS
from mimics_app.rendering.haptic.scene_block import scene_from_components
from tests.support.body_play import Play
from tests.support.haptic_bench import KIN, add_forms, states_of, wavy
from tests.support.object_bench import FACING_UP
from tests.support.touch_play import KINDS, SOLIDS, add_point, new_touch_play

LAWS = (
    "everything sent is finite",
    "force within its limit",
    "force changes no faster than its limit, except towards zero",
    "power within its limit",
    "commanded speed within its limit",
    "no command leads out of the workspace",
    "too fast is stopped in the same tick",
    "outside the workspace is stopped in the same tick",
    "a jump is stopped in the same tick",
    "what is not finite is stopped in the same tick",
    "tank neither below empty nor above full",
    "a contact owes no more than its limit",
)

EDGES = (
    "force at its limit",
    "force changing as fast as it may",
    "power at its limit",
    "commanded speed at its limit",
    "braked at the border of the workspace",
    "tank too empty to pay",
    "tank full",
    "passivity controller at work",
    "contact capped",
)
"""What a law forbids to cross is met this often; a tick far from every limit shows nothing."""

HABITS = ("wander", "alternate", "stuck", "jump", "outside", "too fast", "not finite", "huge", "late")

PERSON = int(Slot.PERSON)
"""The slots behind hold the other two forms of admittance."""

_VECTOR = types.float64[::1]

BRAKE_TIME = 0.05
"""[s], of limiter.brake_at_limits: a joint nears its limit no faster than room / time."""


@kernel
def _change(force, last):
    """Distance of a force from the nearest one between zero and the last [N]: what no fall explains."""
    square = last[0] ** 2 + last[1] ** 2 + last[2] ** 2
    along = force[0] * last[0] + force[1] * last[1] + force[2] * last[2]
    kept = min(1.0, max(0.0, along / square)) if square > 0.0 else 0.0
    return math.sqrt(
        (force[0] - kept * last[0]) ** 2 + (force[1] - kept * last[1]) ** 2 + (force[2] - kept * last[2]) ** 2
    )


@kernel
def _poison(noise):
    kind = int(uniform(noise, 0) * 4.0)
    if kind == 0:
        return math.nan
    if kind == 1:
        return math.inf
    return -math.inf if kind == 2 else 1e300 * (uniform(noise, 0) - 0.5)


@kernel
def _change_parameters(noise, scene, tunnel):
    scene.sequence += 1
    scene.controller = PERSON if uniform(noise, 0) < 0.8 else int(uniform(noise, 0) * 4.0)
    form = int(uniform(noise, 0) * 3.0)
    if scene.controller == PERSON:
        scene.controller += form
    tunnel.stiffness = 10.0 ** (2.0 + 3.0 * uniform(noise, 0))
    tunnel.damping = 40.0 * uniform(noise, 0)
    tunnel.centring = 300.0 * uniform(noise, 0)
    tunnel.advance = 20.0 * uniform(noise, 0)
    scene.virtual_damping = 20.0 * uniform(noise, 0)
    scene.device_delay = 0.01 * uniform(noise, 0)
    for j in range(3):
        scene.joint_velocity[j] = 10.0 ** (2.0 * uniform(noise, 0) - 1.0)
        scene.joint_acceleration[j] = 10.0 ** (2.0 * uniform(noise, 0))
    scene.force_limit = 5.0 + 100.0 * uniform(noise, 0)
    scene.power_limit = 0.5 + 30.0 * uniform(noise, 0)
    scene.force_rate_limit = 10.0 ** (2.0 + 3.0 * uniform(noise, 0))
    scene.cap = int(uniform(noise, 0) * 2.0)
    scene.passivity = int(uniform(noise, 0) * 2.0)
    scene.tank_size = 10.0 ** (3.0 * uniform(noise, 0) - 3.0)
    scene.tank_refill = 0.1 * uniform(noise, 0)
    scene.energy_limit = 1.0 if uniform(noise, 0) < 0.2 else 1e6  # this device does not follow its virtual mass


@kernel
def _change_objects(noise, scene, tables):
    """Other places, surfaces and strengths; bodies are put back, for some were flung out of the world."""
    scene.objects.revision += 1
    for i in range(scene.objects.shapes):
        shape = tables.shapes[i]
        shape.stiffness = 10.0 ** (2.0 + 3.0 * uniform(noise, 0))
        shape.damping = 40.0 * uniform(noise, 0)
        shape.law = 1 if uniform(noise, 0) < 0.2 else 0
        shape.friction_dynamic = uniform(noise, 0)
        shape.friction_static = shape.friction_dynamic + uniform(noise, 0)
        shape.texture_height = 1e-3 * uniform(noise, 0) if uniform(noise, 0) < 0.3 else 0.0
        shape.enabled = 1 if uniform(noise, 0) < 0.9 else 0
        if shape.body < 0 and shape.kind > 0:
            for j in range(3):
                shape.position[j] = 0.2 * (uniform(noise, 0) - 0.5)
    for k in range(scene.objects.bodies):
        body = tables.bodies[k]
        body.spawn += 1
        body.mass = 10.0 ** (uniform(noise, 0) * 2.0 - 1.5)
        for j in range(3):
            body.position[j] = 0.2 * (uniform(noise, 0) - 0.5)
            body.velocity[j] = 2.0 * (uniform(noise, 0) - 0.5)
            body.omega[j] = 40.0 * (uniform(noise, 0) - 0.5)
    for k in range(scene.objects.effects):
        effect = tables.effects[k]
        effect.enabled = 1 if uniform(noise, 0) < 0.5 else 0
        effect.stiffness = 10.0 ** (1.0 + 3.0 * uniform(noise, 0))
        effect.damping = 40.0 * uniform(noise, 0)
        effect.force = 200.0 * uniform(noise, 0)
        effect.radius = 0.3 * uniform(noise, 0)


@typed_kernel(
    types.void(
        types.int64, types.int64, from_dtype(SCENE)[::1], ROWS, OBJECT_WORK, types.FunctionType(TICK), SIMULATION,
        FIELDS, KINEMATICS_SET, from_dtype(STATE)[::1], _VECTOR, _VECTOR, from_dtype(SAMPLE)[::1],
        types.int64[::1], types.int64[::1], types.int64[::1],
    )
)  # fmt: skip
def _attack(
    seed,
    ticks,
    scenes,
    tables,
    objects,
    tick,
    simulate,
    fields,
    kin,
    states,
    data,
    command,
    rows,
    broken,
    met,
    at,
):
    """`broken` counts violated laws, `met` habits that began while the force was on, `at` ticks at each edge."""
    noise = np.zeros(1)
    seed_noise(noise, 0, seed)
    tables, objects, states = borrowed(tables), borrowed(objects), borrowed(states)
    scene, state = scenes[0], states[0]
    last, q, dq, v, lean = np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3)
    habit, left = 0, 0
    for k in range(ticks):
        last_force = norm(state.f_user_world)
        last[:] = state.f_user_world
        was_acting = 2 <= state.safety <= 5
        was_placed = was_acting and state.placed == 1
        if objects.totals[0].touching > 0 and state.safety == 4:
            met[len(HABITS)] += 1
        if k % 500 == 0:
            _change_parameters(noise, scene, tables.tunnels[0])
            _change_objects(noise, scene, tables)
        if k % 3000 == 0:
            for i in range(3):
                lean[i] = 2.0 * uniform(noise, 0) - 1.0
        if state.safety >= 6 and uniform(noise, 0) < 0.3:
            scene.resets += 1
            scene.sequence += 1
        if left == 0:
            strikes = state.safety == 4 and state.ramp == 1.0 and uniform(noise, 0) < 0.3
            habit = 3 + int(uniform(noise, 0) * 6.0) if strikes else int(uniform(noise, 0) * 3.0)
            left = 1 if 3 <= habit < 8 else 1 + int(uniform(noise, 0) * 40.0)
            met[habit] += 1 if state.safety == 4 else 0
        left -= 1
        data[:] = 0.0  # what garbage a device left in places it has no joints for is gone with its next answer
        for i in range(3):
            if habit == 1:
                dq[i] = (1.0 if k % 2 == 0 else -1.0) * 0.6 * uniform(noise, 0)
            elif habit != 2:
                dq[i] += 0.1 * (uniform(noise, 0) - 0.5) - 0.05 * dq[i] - 0.1 * q[i] + 0.04 * lean[i]
            q[i] = min(0.185, max(-0.185, q[i] + (0.0 if habit == 2 else 1e-3 * dq[i])))
            data[DATA_Q + i] = q[i]
            data[DATA_DQ + i] = dq[i]
            data[DATA_FORCE + i] = 80.0 * lean[i] + 120.0 * (uniform(noise, 0) - 0.5) * (1.0 if habit != 1 else 10.0)
        data[DATA_GRASP] = 30.0 * uniform(noise, 0)
        data[DATA_BUTTONS], data[DATA_AGE], data[DATA_DELAY] = 0.0, 0.0, 0.0
        status, held, stopping = 0, 0, habit >= 3 and habit != 8
        if habit == 3:
            data[DATA_Q + 2] += 0.02 if q[2] < 0.0 else -0.02
        elif habit == 4:
            data[DATA_Q] = 0.1901 if q[0] > 0.0 else -0.1901
        elif habit == 5:
            data[DATA_DQ + 2] = 1.51
        elif habit == 6 or habit == 7:
            data[int(uniform(noise, 0) * data.shape[0])] = (
                _poison(noise) if habit == 6 else 1e9 * (1.0 + uniform(noise, 0))
            )
        elif habit == 8:
            held = 1 + int(uniform(noise, 0) * 2.0)
            data[DATA_AGE] = 0.004 * uniform(noise, 0)
            data[DATA_DELAY] = 0.02 * uniform(noise, 0)
        period = 1e-3 * (1.0 + uniform(noise, 0))
        tick(
            scene,
            tables,
            objects,
            simulate,
            fields,
            kin,
            states,
            data,
            status,
            0,
            held,
            period,
            1e-3,
            command,
            rows[0],
        )

        force = norm(state.f_user_world)
        acting = state.safety < 6
        total = (
            force
            + norm(command[COMMAND_DQ : COMMAND_DQ + 3])
            + norm(command[COMMAND_FORCE : COMMAND_FORCE + 3])
            + state.acting.tank
            + state.acting.credit
        )
        broken[0] += 0 if math.isfinite(total) else 1
        broken[1] += 1 if force > max(scene.force_limit, last_force if held == 1 else 0.0) * (1.0 + 1e-12) else 0
        change, rise = _change(state.f_user_world, last), scene.force_rate_limit * 1e-3
        broken[2] += 1 if change > rise * (1.0 + 1e-12) + 1e-13 * last_force else 0
        power = 0.0
        for i in range(3):
            power += state.f_user_world[i] * state.v_world[i]
        broken[3] += 1 if abs(power) > scene.power_limit * (1.0 + 1e-12) else 0
        if acting:
            apply_jacobian(state.q, scene.geometry[0], state.command, v)
            broken[4] += 1 if norm(v) > scene.max_velocity * (1.0 + 2e-12) else 0
            at[3] += 1 if norm(v) > scene.max_velocity * (1.0 - 1e-9) else 0
            for i in range(3):
                up = max(0.0, scene.joint_max[i] - state.q[i]) / BRAKE_TIME
                down = max(0.0, state.q[i] - scene.joint_min[i]) / BRAKE_TIME
                broken[5] += 0 if -down * (1.0 + 1e-12) <= state.command[i] <= up * (1.0 + 1e-12) else 1
                at[4] += 1 if state.command[i] == up != 0.0 or state.command[i] == -down != 0.0 else 0
        at[0] += 1 if force > scene.force_limit * (1.0 - 1e-9) else 0
        at[1] += 1 if change > rise * (1.0 - 1e-9) else 0
        at[2] += 1 if abs(power) > scene.power_limit * (1.0 - 1e-9) else 0
        at[5] += 1 if state.acting.tank_share < 1.0 else 0
        at[6] += 1 if state.acting.tank == scene.tank_size else 0
        at[7] += 1 if state.acting.passivity > 0.0 else 0
        at[8] += 1 if min(state.acting.wall_share, state.acting.shape_share) < 1.0 and force > 0.0 else 0
        if was_acting and acting and stopping:
            broken[9 if habit >= 6 else 8 if habit == 3 and was_placed else 7 if habit == 4 else 6] += (
                1 if habit != 3 or was_placed else 0
            )
        broken[10] += 0 if 0.0 <= state.acting.tank <= scene.tank_size else 1
        broken[11] += 1 if acting and scene.passivity == 1 and state.acting.credit < -scene.energy_limit - 1.0 else 0


@typed_kernel(FIELD)
def _breaks(parameters, p, v, t, out):
    """A force field that is not finite in every fifth centimetre."""
    far = 100.0 * (p[0] + p[1] + p[2])
    out[0] = math.nan if far - math.floor(far) < 0.2 else 3.0 * parameters[0] * p[0]
    out[1] = 1e5 * p[1]


def _objects() -> Play:
    """One of everything: fixed and flying shapes, every effect, one hand that may grip."""
    play = new_touch_play()
    for kind in KINDS:
        play.add_shape(kind, SOLIDS.get(kind, ()), position=(0.0, -0.12, 0.0), orientation=FACING_UP)
    for kind in (ShapeKind.SPHERE, ShapeKind.BOX, ShapeKind.CYLINDER, ShapeKind.CAPSULE):
        body = play.add_body(grip=1, crush_force=10.0, gravity=(0.0, -9.81, 0.0))
        play.add_shape(kind, SOLIDS[kind], body, exponent=1.5, texture_length=5e-3)
    play.rows.shapes["exponent"], play.rows.shapes["texture_length"] = 1.5, 5e-3
    for k, kind in enumerate(kind for kind in EffectKind if kind not in (EffectKind.PATH_SPRING, EffectKind.GUIDANCE)):
        effect = play.rows.effects[k]
        effect["kind"], effect["body"], effect["path"] = kind, k % 4 if k % 2 else -1, -1
        effect["direction"], effect["frequency"], effect["slip"] = (0.6, 0.8, 0.0), 80.0, 0.004
        play.counts[0]["effects"] = k + 1
    for offset in ((-0.02, 0.0, 0.0), (0.02, 0.0, 0.0)):
        add_point(play, offset, 0.008)
    return play


def _check(seed: int, ticks: int, among: bool = False) -> None:
    """No law is broken; each habit met a force that was on, each edge was reached, objects were touched."""
    scene = scene_from_components()
    scene[0]["ramp_force"], scene[0]["ramp_time"] = 1000.0, 0.02
    scene[0]["measured_force_limit"] = 1e9  # a hand that nothing stops
    add_forms(scene)
    broken, met = np.zeros(len(LAWS), np.int64), np.zeros(len(HABITS) + 1, np.int64)
    at = np.zeros(len(EDGES), np.int64)
    play = _objects() if among else new_touch_play()
    scene[0]["objects"] = play.counts[0]
    scene[0]["objects"]["tunnels"] = 1  # without pieces it holds nothing
    play.rows.tunnels[0]["radius_scale"] = 1.0
    if not among:
        wavy().fill(play.rows.tunnels[0])
    simulate, fields = (load_simulation(), (_breaks,) * len(NO_FIELDS)) if among else (no_objects, NO_FIELDS)
    room = (np.zeros(DATA_LENGTH), np.zeros(COMMAND_LENGTH), np.zeros(1, SAMPLE))
    plugins = (tick, simulate, fields, KIN)
    states = states_of(scene)
    _attack(seed, ticks, scene, play.rows, play.work, *plugins, states, *room, broken, met, at)
    assert dict(zip(LAWS, broken.tolist(), strict=True)) == dict.fromkeys(LAWS, 0)
    habits = dict(zip(HABITS, met.tolist()[:-1], strict=True))
    assert all(count >= 2e-4 * ticks for count in habits.values()), habits
    edges = dict(zip(EDGES, at.tolist(), strict=True))
    assert all(count >= 1e-3 * ticks for count in edges.values()), edges
    assert not among or met[-1] > 0.05 * ticks, met[-1]


@pytest.mark.requirement("R03")
def test_a_hundred_thousand_cases_break_no_limit():
    _check(11, 100_000)


def test_a_hundred_thousand_cases_among_objects_break_no_limit():
    _check(31, 100_000, among=True)


@pytest.mark.slow
@pytest.mark.parametrize("among", [False, True])
@pytest.mark.parametrize("seed", range(12, 17))
def test_a_million_cases_break_no_limit(seed: int, among: bool):
    _check(seed, 1_000_000, among)
