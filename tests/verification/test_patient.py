"""The simulated person: minimum-jerk intent, presets in order, tremor, grasp, and a wall that is really met."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.haptic import EventKind, SafetyState
from mimics_app.contracts.loop.loop_ports import DATA_LENGTH, INBOX_ACTIVE, INBOX_LENGTH, INBOX_TRIAL
from mimics_app.rendering.haptic.devices.patients import PRESETS, impairment_of, lay_path, write_arm
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.kernels import arm
from mimics_app.rendering.haptic.kernels.noise import gauss, seed_noise, uniform
from mimics_app.world.components.robot import Patient, Robot
from tests.support.haptic_bench import patient_bench

SEEDS = (1, 2, 3)


def _travel(preset: str, seed: int) -> dict[str, float]:
    """Drive to the start, let the person go, until 98 % of the way or 60 s."""
    bench = patient_bench(preset, seed, samples=1 << 17)
    while bench.engine.snapshot().state != SafetyState.READY:
        bench.engine.advance(100)
    bench.publish(controller=Slot.PERSON, trial=1)
    bench.send(active=1, trial=1)
    start = bench.engine.ticks
    while bench.engine.snapshot().progress < 0.98 and bench.engine.ticks < start + 60_000:
        bench.engine.advance(100)
    samples = bench.samples()[start:]
    snapshot = bench.engine.snapshot()
    return {
        "time": samples.shape[0] / 1000.0,
        "error": float(np.sqrt(np.mean(samples["distance"] ** 2))),
        "contacts": float(np.count_nonzero(bench.engine.events()["kind"] == EventKind.CONTACT_BEGIN)),
        "progress": snapshot.progress,
        "state": snapshot.state,
    }


@pytest.fixture(scope="module")
def runs() -> dict[str, list[dict[str, float]]]:
    return {preset: [_travel(preset, seed) for seed in SEEDS] for preset in PRESETS}


def test_everybody_completes_and_touches_the_wall(runs):
    for preset, rows in runs.items():
        for row in rows:
            assert row["progress"] >= 0.98, preset
            assert row["state"] == SafetyState.ACTIVE, preset
            assert row["contacts"] >= 1, preset


@pytest.mark.parametrize("measure", ["time", "error", "contacts"])
def test_presets_are_in_order(runs, measure: str):
    healthy, moderate, severe = (np.mean([row[measure] for row in runs[preset]]) for preset in PRESETS)
    assert healthy < moderate < severe


def test_seeds_differ_and_repeat(runs):
    assert len({row["error"] for row in runs["healthy"]}) == len(SEEDS)
    assert _travel("healthy", 2) == runs["healthy"][1]


def _pull(seed: int, preset: str = "moderate", device: str = "simulated_hapticmaster") -> np.ndarray:
    """Force of the hand on the handle [N], robot frame, for 4 s of a device without noise that does not move."""
    way = np.array([[0.0, 0.0, 0.0], [0.15, 0.1, 0.0]])
    robot = Robot(device=device, sensor_noise=0.0, sensor_quantum=0.0)
    plugin = build_device(robot, Patient(preset=preset), way, seed)
    person = plugin.memory[-arm.ARM_LENGTH :]
    inbox, data, pulls = np.zeros(INBOX_LENGTH), np.zeros(DATA_LENGTH), np.zeros((4000, 3))
    inbox[INBOX_ACTIVE] = inbox[INBOX_TRIAL] = 1.0
    for tick in range(len(pulls)):
        plugin.read(plugin.memory, inbox, data, tick)
        pulls[tick] = person[arm.GRIP_FORCE : arm.GRIP_FORCE + 3]
    return pulls


@pytest.mark.parametrize("device", ["simulated_hapticmaster", "simulated_impedance"])
def test_the_seed_is_the_persons_and_not_only_the_sensors(device):
    """Without any noise of the robot: another seed is another person's run, the same one repeats it bit for bit."""
    one, again, other = _pull(1, device=device), _pull(1, device=device), _pull(2, device=device)
    assert one.tobytes() == again.tobytes()
    assert np.abs(one - other).max() > 0.5


def _shaken(preset: str, hz: float) -> complex:
    """Impedance of a relaxed hand [N s/m]: its force at the handle over the handle's velocity, at one pitch."""
    memory, ticks, dt = np.zeros(arm.ARM_LENGTH), 8000, 1e-4
    write_arm(memory, impairment_of(Patient(preset=preset)), np.zeros((0, 3)), intent=False)
    handle, turns = np.zeros(6), np.exp(2j * np.pi * hz * dt * np.arange(ticks))
    forces = np.zeros(ticks)
    for t, turn in enumerate(turns):
        handle[0], handle[3] = 1e-3 * turn.imag, 1e-3 * 2.0 * np.pi * hz * turn.real
        arm.step_arm(memory, handle, False, 0.0, np.zeros(3), 0.0, dt)
        forces[t] = memory[arm.GRIP_FORCE]
    late = slice(ticks // 2, None)  # whole turns, after what the start stirred up
    return complex(-2.0 * np.mean(forces[late] * turns[late].conj()) / (1e-3 * 2.0 * np.pi * hz))


@pytest.mark.parametrize("preset", PRESETS)
def test_a_hand_weighs_what_an_arm_weighs(preset):
    """Shaken at 5 Hz through its grip: Z = 1 / (1/Z_grip + 1/(i w m + b_relaxed)); the schema says 0.5 to 2.5 kg."""
    w = 2.0 * np.pi * 5.0
    through_grip = 50.0 + 4000.0 / (1j * w)
    shaken = 1.0 / (1.0 / _shaken(preset, 5.0) - 1.0 / through_grip)
    assert shaken.imag / w == pytest.approx(PRESETS[preset].arm_mass, rel=0.02)
    assert 0.5 <= shaken.imag / w <= 2.5


def test_minimum_jerk_profile():
    """Flash and Hogan: rest to rest, peak speed 1.875 of the mean, half way at half time."""
    u = np.linspace(0.0, 1.0, 10_001)
    way = np.array([arm.min_jerk(x) for x in u])
    speed = np.gradient(way, u)
    assert way[0] == 0.0 and way[-1] == 1.0 and arm.min_jerk(0.5) == 0.5
    assert speed.max() == pytest.approx(1.875, rel=1e-6) and speed[[0, -1]] == pytest.approx(0.0, abs=1e-3)
    assert arm.min_jerk(-1.0) == 0.0 and arm.min_jerk(2.0) == 1.0


def test_way_is_evenly_spaced_and_goes_a_little_beyond_the_end():
    corners = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.1, 0.2, 0.0]])
    way, step = lay_path(corners)
    assert np.allclose(np.linalg.norm(np.diff(way, axis=0), axis=1)[:120], step, rtol=1e-9)
    assert way[-1] == pytest.approx([0.1, 0.212, 0.0]) and np.all(way[0] == 0.0)
    assert lay_path(corners[:1])[0].shape == (0, 3)
    assert lay_path(corners[[0, 0, 0]])[0].shape == (0, 3), "a way that leads nowhere"
    assert np.array_equal(lay_path(np.repeat(corners, 2, axis=0))[0], way)


def test_component_values_go_over_the_preset():
    person = impairment_of(Patient(preset="severe", tremor=0.0, speed=0.15))
    assert (person.tremor, person.speed, person.reach) == (0.0, 0.15, PRESETS["severe"].reach)


def test_random_numbers_are_uniform_normal_and_depend_on_every_seed():
    memory = np.zeros(1)
    firsts = set()
    for seed in range(200):
        seed_noise(memory, 0, seed)
        firsts.add(uniform(memory, 0))
    assert len(firsts) == 200 and np.std(list(firsts)) == pytest.approx(np.sqrt(1 / 12), rel=0.2)
    draws = np.array([gauss(memory, 0) for _ in range(20_000)])
    assert abs(draws.mean()) < 5 / np.sqrt(20_000) and draws.std() == pytest.approx(1.0, rel=0.03)
    assert np.mean(draws**4) == pytest.approx(3.0, rel=0.1)


def _reach(preset: str, seed: int, target: tuple[float, float, float], load: float = 0.0, **changes: float):
    """A person without a path on a handle that follows at once; positions per tick [n, 3], grasp [n]."""
    memory = np.zeros(arm.ARM_LENGTH)
    seed_noise(memory, arm.GENERATOR, seed)
    write_arm(memory, impairment_of(Patient(preset=preset, tremor=0.0, **changes)), np.zeros((0, 3)), intent=True)
    handle, aim = np.zeros(6), np.array(target)
    ticks = 12_000
    positions, grasps = np.zeros((ticks, 3)), np.zeros(ticks)
    for t in range(ticks):
        close = 1.0 if 3000 <= t < 9000 else 0.0
        grasps[t] = arm.step_arm(memory, handle, True, 1.0, aim, close, 1e-3)
        # the handle is a mass of 3 kg that the hand pulls, with a weight on it
        force = memory[arm.GRIP_FORCE : arm.GRIP_FORCE + 3] + [0.0, 0.0, -load]
        handle[3:6] += 1e-3 * (force - 8.0 * handle[3:6]) / 3.0
        handle[0:3] += 1e-3 * handle[3:6]
        positions[t] = handle[0:3]
    return positions, grasps


@pytest.mark.parametrize("preset", PRESETS)
def test_a_target_is_reached_and_kept(preset):
    target = (0.06, -0.05, 0.03)
    positions, _ = _reach(preset, 1, target)
    error = np.linalg.norm(positions[-2000:] - target, axis=1)
    assert error.max() < max(0.006, 1.5 * PRESETS[preset].aim_error), preset


def test_the_more_impaired_take_longer():
    times = []
    for preset in PRESETS:
        positions, _ = _reach(preset, 2, (0.08, 0.08, 0.0))
        there = np.linalg.norm(positions - (0.08, 0.08, 0.0), axis=1) < 0.015
        times.append(int(np.argmax(there)))
    assert 0 < times[0] < times[1] < times[2]


def test_what_a_weight_pulls_the_hand_down_by_is_corrected_as_it_is_seen():
    """4 N on 350 N/m would hang 11 mm below the wish for ever."""
    positions, _ = _reach("healthy", 3, (0.0, 0.0, 0.05), load=4.0)
    assert abs(positions[-1, 2] - 0.05) < 0.005


def test_the_hand_closes_when_asked_within_half_a_second_and_opens_again():
    _, grasps = _reach("healthy", 4, (0.0, 0.0, 0.0))
    assert not grasps[:3000].any() and not grasps[9500:].any()
    assert grasps[3600:9000].mean() == pytest.approx(PRESETS["healthy"].grasp, rel=0.1)
    assert grasps[3250] < 0.6 * PRESETS["healthy"].grasp


def test_nobody_without_a_grip_presses():
    assert not _reach("healthy", 5, (0.0, 0.0, 0.0), grasp=0.0, grasp_variation=0.0)[1].any()
