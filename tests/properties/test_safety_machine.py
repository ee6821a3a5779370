"""The whole tick under random data, commands, stops and lateness: laws that hold after every one of a million ticks."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.contracts.haptic import SAMPLE
from mimics_app.contracts.kernel import kernel
from mimics_app.contracts.loop_ports import COMMAND_LENGTH, DATA_LENGTH
from mimics_app.contracts.object_rows import ObjectCapacities, new_rows
from mimics_app.rendering.haptic.kernels.noise import seed_noise, uniform
from mimics_app.rendering.haptic.kernels.state import new_state
from mimics_app.rendering.haptic.kernels.tick import tick
from mimics_app.rendering.haptic.kernels.vectors import norm
from mimics_app.rendering.haptic.no_objects import NO_FIELDS, no_objects
from mimics_app.rendering.haptic.objects import new_object_work
from mimics_app.rendering.haptic.scene_block import scene_from_components
from tests.support.haptic_bench import wavy

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


@kernel
def _chance(noise, share):
    return uniform(noise, 0) < share


@kernel
def _walk(seed, ticks, scenes, rows_of_objects, objects, states, data, command, rows, broken, visits):
    """A handle wandering through the workspace; now and then something goes wrong. `broken` counts violated laws."""
    noise = np.zeros(1)
    seed_noise(noise, 0, seed)
    scene = scenes[0]
    state = states[0]
    q = np.zeros(3)
    dq = np.zeros(3)
    last_command = np.zeros(3)
    for _ in range(ticks):
        before = state.safety
        resets_before = state.resets
        last_force = norm(state.f_user_world)
        last_command[:] = state.command
        if _chance(noise, 0.002):
            scene.sequence += 1
            scene.controller = int(uniform(noise, 0) * 4.0) if _chance(noise, 0.3) else 3
            scene.form = int(uniform(noise, 0) * 3.0)
            scene.tunnel.stiffness = 4000.0 * uniform(noise, 0)
        if _chance(noise, 0.01):
            scene.resets += 1
            scene.sequence += 1
        for i in range(3):
            dq[i] += 0.1 * (uniform(noise, 0) - 0.5) - 0.05 * dq[i] - 0.05 * q[i]
            q[i] += 1e-3 * dq[i] * (40.0 if _chance(noise, 2e-5) else 1.0)
            q[i] = min(0.2, max(-0.2, q[i]))
            data[i] = q[i]
            data[3 + i] = dq[i]
            data[6 + i] = 60.0 * (uniform(noise, 0) - 0.5)
        data[9] = 30.0 * uniform(noise, 0)
        data[10] = 1.0 if _chance(noise, 2e-5) else 0.0
        data[11] = 0.025 * uniform(noise, 0) if _chance(noise, 0.001) else 0.0
        poisoned = _chance(noise, 1e-4)
        if poisoned:
            data[int(uniform(noise, 0) * data.shape[0])] = math.nan if _chance(noise, 0.5) else math.inf
        status = 0
        if not poisoned and _chance(noise, 0.001):
            status = 1 if _chance(noise, 0.9) else 2
        stop = 1 if _chance(noise, 5e-5) else 0
        held = 0
        if _chance(noise, 0.002):
            held = 1 + int(uniform(noise, 0) * (4.0 if _chance(noise, 0.05) else 2.0))
        tick(
            scene,
            rows_of_objects,
            objects,
            no_objects,
            NO_FIELDS,
            state,
            data,
            status,
            stop,
            held,
            1e-3,
            1e-3,
            command,
            rows[0],
        )

        force = norm(state.f_user_world)
        after = state.safety
        visits[after] += 1
        broken[0] += 0 if math.isfinite(force) else 1
        broken[1] += 0 if math.isfinite(norm(state.command) + command[0] + command[3]) else 1
        broken[2] += 0 if math.isfinite(norm(state.hip_world) + norm(state.v_world) + state.ball_radius) else 1
        broken[3] += 1 if force > scene.force_limit * (1.0 + 1e-12) else 0
        broken[4] += 1 if force > (last_force + scene.force_rate_limit * 1e-3) * (1.0 + 1e-12) else 0
        broken[5] += 1 if after < 4 and held != 1 and force != 0.0 else 0
        broken[6] += 1 if after >= 6 and force != 0.0 else 0
        if after >= 6:
            for i in range(3):
                broken[7] += 1 if abs(state.command[i]) > abs(last_command[i]) else 0
            broken[14] += 1 if command[6] != 0.0 else 0
        if before >= 6 and after < 6:
            broken[8] += 1 if state.resets == resets_before else 0
            broken[9] += 1 if after > 2 else 0
        broken[10] += 1 if poisoned and after < 6 else 0
        broken[11] += 1 if stop == 1 and after != 7 else 0
        broken[12] += 1 if after == 4 and not (3 <= before <= 5) else 0
        broken[13] += 0 if 0.0 <= state.ramp <= 1.0 else 1


def _run(seed: int, ticks: int) -> tuple[dict[str, int], np.ndarray]:
    scene = scene_from_components()
    wavy().fill(scene[0]["tunnel"])
    scene[0]["tunnel"]["stiffness"], scene[0]["tunnel"]["damping"] = 2000.0, 25.0
    scene[0]["ramp_force"] = 30.0
    scene[0]["ramp_time"] = 0.05
    broken, visits = np.zeros(len(LAWS), np.int64), np.zeros(8, np.int64)
    _walk(
        seed,
        ticks,
        scene,
        new_rows(ObjectCapacities()),
        new_object_work(ObjectCapacities()),
        new_state(),
        np.zeros(DATA_LENGTH),
        np.zeros(COMMAND_LENGTH),
        np.zeros(1, SAMPLE),
        broken,
        visits,
    )
    return dict(zip(LAWS, broken.tolist(), strict=True)), visits


def test_a_million_ticks_break_no_law():
    broken, visits = _run(1, 1_000_000)
    assert broken == dict.fromkeys(LAWS, 0)
    assert np.all(visits[1:] > 50), visits  # every state was really visited


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 22))
def test_twenty_million_ticks_break_no_law(seed: int):
    broken, _ = _run(seed, 1_000_000)
    assert broken == dict.fromkeys(LAWS, 0)
