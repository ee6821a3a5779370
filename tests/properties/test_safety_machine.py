"""The whole tick under random data, commands, stops and lateness: laws that hold after every one of a million ticks.

A walk that spends its ticks in a latched stop breaks no law and shows nothing, so what it reached is counted too: every
state, every transition, every cause of a stop, the force at its limit. Each law is also seen to fail, on a tick that
was spoilt for it.
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
from mimics_app.contracts.loop.device_life import LIFE_IN, LIFE_STEPS, DeviceLife
from mimics_app.contracts.loop.haptic import SAMPLE, SCENE, SafetyState, TripCause
from mimics_app.contracts.loop.loop_fields import MAX_JOINTS
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
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
    FIELDS,
)
from mimics_app.contracts.loop.object_rows import ObjectCapacities, new_rows
from mimics_app.maths.vec import norm
from mimics_app.rendering.haptic.kernels.noise import seed_noise, uniform
from mimics_app.rendering.haptic.kernels.state import STATE
from mimics_app.rendering.haptic.loop_tick import SIMULATION, TICK, tick
from mimics_app.rendering.haptic.no_objects import NO_FIELDS, no_objects
from mimics_app.rendering.haptic.objects import OBJECT_WORK, ROWS, new_object_work
from mimics_app.rendering.haptic.scene_block import scene_from_components
from tests.support.haptic_bench import KIN, add_forms, states_of, wavy

PERSON = int(Slot.PERSON)
"""The slots behind hold the other two forms of admittance."""

_VECTOR = types.float64[::1]

LAWS = (
    "force is finite",
    "command is finite",
    "pose is finite",
    "force within its limit",
    "force rises no faster than its limit",
    "no force in OFF, INIT, HOMED, READY",
    "no force in a latched stop",
    "command never grows in a latched stop",
    "a latched stop is left by a reset only",
    "a latched stop leads to INIT only",
    "NaN latches in its own tick",
    "stop word latches E_STOP in its own tick",
    "ACTIVE comes from READY or DEGRADED only",
    "ramp within [0, 1]",
    "disabled when latched",
)


OFF, INIT, HOMED, READY, ACTIVE, DEGRADED, SAFE_STOP, E_STOP = (int(state) for state in SafetyState)

TRANSITIONS = {
    OFF: {INIT, SAFE_STOP, E_STOP},
    INIT: {HOMED, SAFE_STOP, E_STOP},
    HOMED: {READY, SAFE_STOP, E_STOP},
    READY: {HOMED, ACTIVE, SAFE_STOP, E_STOP},
    ACTIVE: {HOMED, DEGRADED, SAFE_STOP, E_STOP},
    DEGRADED: {HOMED, ACTIVE, SAFE_STOP, E_STOP},
    SAFE_STOP: {INIT, E_STOP},
    E_STOP: {INIT},
}
"""Every way from one state to another; E_STOP -> SAFE_STOP besides, where a reset meets a new cause in its own tick."""

LIFE = 8000
"""Ticks from OFF to the next switching on."""

SPOILT = 5 * LIFE
"""Ticks of a walk that is spoilt: each law breaks 17 times or more."""

SHAKING = 800
"""Ticks for which a stiff wall, without cap and passivity control, feeds an oscillation of handle and hand."""
SHAKE, TURN = 3e-3, 0.25
"""Amplitude [m] and phase per tick [rad] of that oscillation: 40 Hz, 0.75 m/s."""
RESISTANCE = 30.0
"""Resistance of the hand that shakes [N s/m]: by it the virtual mass moves in phase with the wall's force."""


@kernel
def _chance(noise, share):
    return uniform(noise, 0) < share


@kernel
def _shake(tables, scene, on):
    """A wall that nothing bounds but the detector of oscillation, or the usual one."""
    scene.sequence += 1
    scene.cap = scene.passivity = 0 if on else 1
    tables.tunnels[0].damping = 0.0 if on else 25.0
    scene.force_rate_limit = 1e4 if on else 2e3
    if on:
        tables.tunnels[0].stiffness = 15000.0
        scene.force_limit = 200.0
        scene.energy_limit = 10.0
    else:
        scene.force_limit, scene.energy_limit = 60.0, 0.5


@kernel
def _spoil(law, scene, state, command, before, last_force, last_command, poisoned, stop):
    """Break one law, as a faulty tick would."""
    after = state.safety
    force = state.f_user_world
    if law == 0:
        force[0] = math.nan
    elif law == 1:
        command[COMMAND_DQ] = math.inf
    elif law == 2:
        state.hip_world[1] = math.nan
    elif law == 3:
        force[0] = 1.01 * scene.force_limit
    elif law == 4:
        force[0] = last_force + 1.01e-3 * scene.force_rate_limit
    elif (law == 5 and after < ACTIVE) or (law == 6 and after >= SAFE_STOP):
        force[2] = 1e-9
    elif law == 7 and after >= SAFE_STOP:
        state.command[1] = 1e-9 + 1.001 * last_command[1]
    elif law == 8 and before >= SAFE_STOP and after == before:
        state.safety = INIT
    elif law == 9 and before >= SAFE_STOP and after == INIT:
        state.safety = READY
    elif law == 10 and poisoned:
        state.safety = HOMED
    elif law == 11 and stop == 1:
        state.safety = SAFE_STOP
    elif law == 12 and before == HOMED and after == READY:
        state.safety = ACTIVE
    elif law == 13:
        state.ramp = 1.001
    elif law == 14 and after >= SAFE_STOP:
        command[COMMAND_ENABLED] = 1.0


@typed_kernel(
    types.void(
        types.int64, types.int64, types.int64, from_dtype(SCENE)[::1], ROWS, OBJECT_WORK, types.FunctionType(TICK),
        SIMULATION, FIELDS, KINEMATICS_SET, from_dtype(STATE)[::1], _VECTOR, _VECTOR,
        from_dtype(SAMPLE)[::1], types.int64[::1], types.int64[:, ::1],
    )
)  # fmt: skip
def _walk(
    seed,
    ticks,
    spoilt,
    scenes,
    tables,
    work,
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
):
    """A handle wandering through the workspace; now and then something goes wrong. `broken` counts violated laws.

    `spoilt`: the law that every hundredth tick breaks on purpose, or -1. `met`: transitions by state before and after
    in rows 0-7, causes of stops in row 8; in row 9 ticks with a force, at its limit, rising as fast as it may, in the
    soft start.
    """
    noise = np.zeros(1)
    seed_noise(noise, 0, seed)
    tables, work, states = borrowed(tables), borrowed(work), borrowed(states)
    scene = scenes[0]
    state = states[0]
    q = np.zeros(3)
    dq = np.zeros(3)
    lean = np.zeros(3)
    stuck = 0
    shaking = 0
    last_command = np.zeros(MAX_JOINTS)
    for k in range(ticks):
        age = k % LIFE
        if age == 0:  # switched on anew; the second state is as it was made
            states[0] = states[1]
            scene.sequence = 0
            scene.late_latches = 1 if _chance(noise, 0.8) else 0
            q[:] = 0.0
            dq[:] = 0.0
        before = state.safety
        resets_before = state.resets
        last_force = norm(state.f_user_world)
        last_command[:] = state.command
        # Starting and holding take few ticks of all: there something goes wrong the more often.
        haste = 50.0 if before < READY else 5.0 if before == DEGRADED else 2.0
        if _chance(noise, 0.002) and age > 20:
            scene.sequence += 1
            scene.controller = int(uniform(noise, 0) * 4.0) if _chance(noise, 0.3) else PERSON
            scene.target[0] = 0.3 if _chance(noise, 0.1) else 0.0  # where this handle is never driven to
            form = int(uniform(noise, 0) * 3.0)
            if scene.controller == PERSON:
                scene.controller += form
            tables.tunnels[0].stiffness = 4000.0 * uniform(noise, 0)
            scene.force_limit = 2.0 + 60.0 * uniform(noise, 0)
            scene.energy_limit = 0.01 + 0.5 * uniform(noise, 0)
        if (age > 20 and _chance(noise, 0.01)) or age == 40:
            scene.resets += 1
            scene.sequence += 1
        if before == ACTIVE and shaking == 0 and _chance(noise, 3e-4):
            shaking = SHAKING
            _shake(tables, scene, True)
        elif shaking > 0:
            shaking = shaking - 1 if before == ACTIVE or before == DEGRADED else 0
            if shaking == 0:
                _shake(tables, scene, False)
        if k % 1000 == 0:  # where the hand leans: now and then out of the workspace
            for i in range(3):
                lean[i] = (1.0 if _chance(noise, 0.02) else 0.1) * (uniform(noise, 0) - 0.5)
        data[:] = 0.0  # what garbage a device left in places it has no joints for is gone with its next answer
        for i in range(3):
            dq[i] += 0.1 * (uniform(noise, 0) - 0.5) - 0.05 * dq[i] - 0.05 * (q[i] - lean[i])
            q[i] += 1e-3 * dq[i] + (0.02 if _chance(noise, 3e-5) else 0.0)
            q[i] = min(0.2, max(-0.2, q[i]))
            data[DATA_Q + i] = q[i]
            data[DATA_DQ + i] = dq[i]
            data[DATA_FORCE + i] = 60.0 * (uniform(noise, 0) - 0.5)
        if shaking > 0:
            data[DATA_Q + 2] += SHAKE * math.sin(TURN * shaking)
            data[DATA_DQ + 2] -= SHAKE * TURN / 1e-3 * math.cos(TURN * shaking)
            data[DATA_FORCE + 2] = -RESISTANCE * data[DATA_DQ + 2]
        if _chance(noise, 5e-5):
            data[DATA_DQ + 2] = 2.0  # faster than any hand
        stuck = 30 if _chance(noise, 5e-5) else max(0, stuck - 1)
        if stuck > 0:
            data[DATA_FORCE + 1] = 300.0  # stronger than any hand
        data[DATA_GRASP] = 30.0 * uniform(noise, 0)
        data[DATA_BUTTONS] = 1.0 if _chance(noise, 2e-5 * haste) else 0.0
        data[DATA_AGE] = 0.025 * uniform(noise, 0) if _chance(noise, 0.001) else 0.0
        data[DATA_DELAY] = 0.01 * uniform(noise, 0) if _chance(noise, 0.5) else 0.0
        poisoned = _chance(noise, 1e-4 * haste)
        if poisoned:
            data[int(uniform(noise, 0) * data.shape[0])] = math.nan if _chance(noise, 0.5) else math.inf
        status = 0
        if not poisoned and _chance(noise, 0.8 if before == INIT else 0.01 if before >= SAFE_STOP else 0.001):
            status = 1 if _chance(noise, 0.9) else 2
        stop = 1 if _chance(noise, 5e-5 * haste) else 0
        held = 0
        if _chance(noise, 0.002):
            held = 1 + int(uniform(noise, 0) * (4.0 if _chance(noise, 0.1) else 2.0))
        tick(
            scene,
            tables,
            work,
            simulate,
            fields,
            kin,
            states,
            data,
            status,
            stop,
            held,
            1e-3,
            1e-3,
            command,
            rows[0],
        )
        if spoilt >= 0 and (k % 100 == 0 or spoilt >= 8):
            _spoil(spoilt, scene, state, command, before, last_force, last_command, poisoned, stop)

        force = norm(state.f_user_world)
        after = state.safety
        met[before, after] += 1
        if after >= SAFE_STOP and before != after:
            met[8, state.cause] += 1
        met[9, 0] += 1 if force > 0.0 else 0
        met[9, 1] += 1 if force > scene.force_limit * 0.999 else 0
        met[9, 2] += 1 if force > (last_force + scene.force_rate_limit * 1e-3) * 0.999 else 0
        met[9, 3] += 1 if 0.0 < state.ramp < 1.0 and force > 0.0 else 0
        broken[0] += 0 if math.isfinite(force) else 1
        broken[1] += 0 if math.isfinite(norm(state.command) + command[COMMAND_DQ] + command[COMMAND_FORCE]) else 1
        broken[2] += 0 if math.isfinite(norm(state.hip_world) + norm(state.v_world) + state.ball_radius) else 1
        broken[3] += 1 if force > max(scene.force_limit, last_force if held == 1 else 0.0) * (1.0 + 1e-12) else 0
        broken[4] += 1 if force > (last_force + scene.force_rate_limit * 1e-3) * (1.0 + 1e-12) else 0
        broken[5] += 1 if after < 4 and held != 1 and force != 0.0 else 0
        broken[6] += 1 if after >= 6 and force != 0.0 else 0
        if after >= 6:
            for i in range(3):
                broken[7] += 1 if abs(state.command[i]) > abs(last_command[i]) else 0
            broken[14] += 1 if command[COMMAND_ENABLED] != 0.0 else 0
        if before >= 6 and after < 6:
            broken[8] += 1 if state.resets == resets_before else 0
            broken[9] += 1 if after != 1 else 0
        broken[10] += 1 if poisoned and after < 6 else 0
        broken[11] += 1 if stop == 1 and after != 7 else 0
        broken[12] += 1 if after == 4 and not (3 <= before <= 5) else 0
        broken[13] += 0 if 0.0 <= state.ramp <= 1.0 else 1


def _run(seed: int, ticks: int, spoilt: int = -1) -> tuple[dict[str, int], np.ndarray]:
    """(times each law was broken, what was met: see `_walk`)."""
    scene = scene_from_components()
    add_forms(scene)
    rows = new_rows(ObjectCapacities())
    wavy().fill(rows.tunnels[0])
    rows.tunnels[0]["radius_scale"], rows.tunnels[0]["stiffness"], rows.tunnels[0]["damping"] = 1.0, 2000.0, 25.0
    scene[0]["objects"]["tunnels"] = 1
    scene[0]["ramp_force"] = 60.0
    scene[0]["ramp_time"] = 0.05
    scene[0]["drive_speed"] = 0.3  # the lag that stops a slower drive is rare in a walk at random
    broken, met = np.zeros(len(LAWS), np.int64), np.zeros((10, 16), np.int64)
    _walk(
        seed,
        ticks,
        spoilt,
        scene,
        rows,
        new_object_work(ObjectCapacities()),
        tick,
        no_objects,
        NO_FIELDS,
        KIN,
        states_of(scene),
        np.zeros(DATA_LENGTH),
        np.zeros(COMMAND_LENGTH),
        np.zeros(1, SAMPLE),
        broken,
        met,
    )
    return dict(zip(LAWS, broken.tolist(), strict=True)), met


def _check_reached(met: np.ndarray, ticks: int) -> None:
    """The walk went everywhere, and nowhere else."""
    crossings, causes = met[:8, :8], met[8]
    visits = crossings.sum(axis=0)
    for state in SafetyState:
        assert visits[state] >= 1e-3 * ticks, f"{state.name}: {visits.tolist()}"
        ways = {int(after) for after in np.flatnonzero(crossings[state]) if after != state}
        if state is SafetyState.E_STOP:
            ways.discard(SAFE_STOP)
        assert ways == TRANSITIONS[state], f"from {state.name} to {ways}"
        for after in ways:
            assert crossings[state, after] >= 5e-6 * ticks, f"{state.name} -> {SafetyState(after).name}"
    assert visits[ACTIVE] >= 0.3 * ticks, visits.tolist()
    for cause in set(TripCause) - {TripCause.NONE, TripCause.CONTROLLER}:  # the one of this walk asks for no stop
        assert causes[cause] >= 1e-5 * ticks, f"{cause.name}: {causes.tolist()}"
    assert (met[9, :4] >= [0.05 * ticks, 20, 20, 100]).all(), met[9, :4].tolist()


def test_every_transition_is_a_step_of_the_devices_life_or_none_and_a_stop_takes_its_power():
    steps = {(life, after) for (life, _), after in LIFE_STEPS.items()}
    for before, afters in TRANSITIONS.items():
        for after in afters:
            lives = LIFE_IN[SafetyState(before)], LIFE_IN[SafetyState(after)]
            assert lives in steps or lives[0] is lives[1]
            assert lives[1] is DeviceLife.INACTIVE or after not in (SAFE_STOP, E_STOP)


def test_a_million_ticks_break_no_law_and_go_everywhere():
    broken, met = _run(1, 1_000_000)
    assert broken == dict.fromkeys(LAWS, 0)
    _check_reached(met, 1_000_000)


@pytest.mark.parametrize("law", LAWS)
def test_each_law_is_seen_to_break_in_a_spoilt_tick(law: str):
    broken, _ = _run(1, SPOILT, LAWS.index(law))
    assert broken[law] >= 5


def test_a_stop_key_that_does_not_latch_is_caught():
    """E_STOP left on its own, as soon as the key is up."""
    broken, _ = _run(1, SPOILT, LAWS.index("a latched stop is left by a reset only"))
    assert broken["a latched stop is left by a reset only"] > 20


@pytest.mark.slow
def test_twenty_million_ticks_break_no_law_and_go_everywhere():
    reached = np.zeros((10, 16), np.int64)
    for seed in range(2, 22):
        broken, met = _run(seed, 1_000_000)
        assert broken == dict.fromkeys(LAWS, 0), seed
        reached += met
    _check_reached(reached, 20_000_000)
