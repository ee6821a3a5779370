"""Impedance control on a light robot that takes forces: what it renders, what it may not, and where it is driven."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.loop.loop_ports import DATA_GRASP, READ, DevicePlugin
from mimics_app.contracts.shared_memory.command_ring import request_stop
from mimics_app.rendering.haptic.descriptors.leg import LEG
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.devices.simulated_impedance import write_force
from mimics_app.rendering.haptic.kernels import light_robot
from mimics_app.rendering.haptic.kernels.drive import draw_along
from mimics_app.rendering.haptic.kernels.light_robot import HANDLE, LENGTH, command_force, step_light_robot
from mimics_app.rendering.haptic.scene_block import impedance_values, kinematic_values
from mimics_app.world.components.robot import Impedance, Patient, Robot
from tests.support.felt_energy import fastest_change
from tests.support.haptic_bench import Bench, bench_of, script, scripted, wavy

T = 1e-3
MASS, DELAY = 0.2, 1
PUSH = LENGTH


def _robot(push: int = 0) -> np.ndarray:
    """Memory of a light robot without friction, encoders of 1 nm, and room for a constant push."""
    plugin = build_device(Robot(device="simulated_impedance", delay_ticks=DELAY))
    memory = np.zeros(LENGTH + push)
    memory[:LENGTH] = plugin.memory[:LENGTH]
    memory[light_robot.DAMPING], memory[light_robot.ENCODER], memory[light_robot.MOTOR_FORCE] = 0.0, 1e-9, 1e3
    return memory


@typed_kernel(READ)
def read_pushed_light(memory, inbox, data, tick):
    if tick > 0:
        step_light_robot(memory[:LENGTH], memory[PUSH : PUSH + 3])
    data[DATA_GRASP] = 20.0
    light_robot.sense_position(memory[:LENGTH], data)
    return 0


def _taking_forces(bench: Bench, **values: float) -> Bench:
    bench.publish(**impedance_values(bench.scene, Impedance(damping=0.0)), **values)
    return bench


@pytest.mark.parametrize("friction", [0.0, 0.7])
def test_free_robot_obeys_the_closed_form(friction: float):
    memory = _robot()
    memory[light_robot.DAMPING], memory[light_robot.DELAY] = friction, 0
    for _ in range(100):
        command_force(memory, np.array([0.3, 0.0, -0.1]), True)
        step_light_robot(memory, np.array([0.1, 0.0, 0.0]))
    t, force = 0.1, np.array([0.4, 0.0, -0.1])
    if friction == 0.0:
        v, x = force / MASS * t, 0.5 * force / MASS * t**2
    else:
        decay = np.exp(-friction * t / MASS)
        v = force / friction * (1.0 - decay)
        x = force / friction * (t - MASS / friction * (1.0 - decay))
    assert memory[HANDLE + 3 : HANDLE + 6] == pytest.approx(v, rel=1e-9, abs=1e-15)
    assert memory[HANDLE : HANDLE + 3] == pytest.approx(x, rel=1e-9, abs=1e-15)


def test_motors_end_somewhere_and_so_does_the_arm():
    memory = _robot()
    memory[light_robot.MOTOR_FORCE], memory[light_robot.DELAY] = 2.0, 0
    command_force(memory, np.array([0.0, 0.0, 100.0]), True)
    step_light_robot(memory, np.zeros(3))
    assert memory[HANDLE + 5] == pytest.approx(2.0 / MASS * T)
    for _ in range(3000):
        step_light_robot(memory, np.array([0.0, 0.0, 5.0]))
    assert memory[HANDLE + 2] == pytest.approx(memory[light_robot.JOINT_MAX + 2]) and memory[HANDLE + 5] == 0.0


def _tap(passivity: int, stiffness: float = 2000.0, steps: int = 60, speed: float = 0.1) -> np.ndarray:
    """A scripted hand that enters the wall at constant speed and leaves as fast, on a device that takes forces."""
    stroke = np.concatenate([np.arange(steps + 1), np.arange(steps - 1, -1, -1)]) * speed * T
    room = 0.04 - 0.012
    height = np.concatenate([np.zeros(1500), np.linspace(0.0, room, 400), room + stroke, np.full(40, 0.9 * room)])
    height[-40:] = np.linspace(room, 0.9 * room, 40)
    rows = script(len(height))
    rows[:, 2], rows[1:, 5] = height, np.diff(height) / T
    bench = scripted(rows)
    still = {"tunnel__damping": 0.0, "tunnel__drag": 0.0, "tunnel__drag_growth": 0.0, "cap": 0, "passivity": passivity}
    ball = {"ball_radius_max": 0.012, "ball_radius_min": 0.012, "force_rate_limit": 1e9, "passivity_damping": 1e3}
    _taking_forces(bench, tunnel__stiffness=stiffness, **still, **ball)
    return bench.advance(len(height))


def test_a_tap_draws_k_t_v_d_without_the_controller_and_nothing_with_it():
    off, on = _tap(0), _tap(1)
    depth = off["penetration"].max()
    assert off["energy"][-1] == pytest.approx(-2000.0 * T * 0.1 * depth, rel=1e-6)
    assert on["energy"].min() >= -1e-12 and on["passivity"].max() > 0.0
    assert np.array_equal(on["f_command"][:, 2], on["f_user_world"][:, 1])  # what is felt is what is sent


def test_the_force_is_sent_and_nothing_else():
    rows = _tap(1)
    assert (rows["command"] == 0.0).all() and (rows["v_virtual"] == 0.0).all()
    assert rows["state"].max() == SafetyState.ACTIVE


def test_viscosity_is_rendered_and_felt_within_the_limits():
    rows = script(900)
    rows[:, 5] = 0.2
    bench = scripted(rows, straight=None)
    bench.publish(**impedance_values(bench.scene, Impedance(damping=3.0)))
    assert bench.advance(900)["f_user_world"][-1] == pytest.approx([0.0, -0.6, 0.0])


def _pushed(times: float, cap: int, passivity: int) -> np.ndarray:
    """A push of 4 N by nobody's hand into a wall of so many times its limit."""
    memory = _robot(3)
    bench = bench_of(
        DevicePlugin("pushed light", read_pushed_light, write_force, memory, delay=DELAY * T, follows="force")
    )
    damping = 4.0
    limit = damping / (0.5 * T + DELAY * T)
    wall = {"tunnel__stiffness": times * limit, "tunnel__damping": damping, "tunnel__drag": 0.0}
    free = {"velocity_limit": 10.0, "power_limit": 1e6, "energy_limit": 1e6, "position_jump": 1.0}
    _taking_forces(bench, **wall, **free, cap=cap, passivity=passivity)
    bench.advance(900)
    memory[PUSH + 2] = 4.0
    return bench.advance(3000)


def _swings(rows: np.ndarray) -> tuple[float, float]:
    """In the first second of the push and in the last [m]."""
    height = rows["hip_world"][:, 1]
    return float(np.ptp(height[200:1000])), float(np.ptp(height[2000:]))


def test_the_cap_lets_the_light_robot_come_to_rest():
    early, late = _swings(_pushed(2.5, 1, 0))
    assert late < 0.5 * early < 0.02


def test_the_controller_makes_of_joules_millijoules():
    """Without it the wall flings the robot about until its speed stops the loop; a tick of delay leaves a hundredth."""
    wild, tame = _pushed(2.5, 0, 0), _pushed(2.5, 0, 1)
    assert wild["state"][-1] == SafetyState.SAFE_STOP and wild["credit"].min() < -1.0
    assert (tame["state"] == SafetyState.ACTIVE).all() and (tame["passivity"] > 0.0).any()
    assert tame["credit"].min() > 0.02 * wild["credit"].min()


def test_stop_key_takes_the_force_off_the_device_within_two_ticks():
    memory = _robot(3)
    bench = bench_of(DevicePlugin("light", read_pushed_light, write_force, memory, follows="force"))
    _taking_forces(bench)
    bench.advance(900)
    memory[PUSH + 2] = 4.0
    assert np.linalg.norm(bench.advance(600)["f_command"][-1]) > 1.0
    request_stop(bench.memory)
    rows = bench.advance(10)
    assert (rows["f_command"][2:] == 0.0).all() and rows["state"][-1] == SafetyState.E_STOP


@pytest.mark.parametrize(("drive", "limit", "rate"), [(200.0, 15.0, 2000.0), (200.0, 60.0, 300.0), (5.0, 60.0, 2000.0)])
def test_a_drive_to_the_start_keeps_the_limits_of_the_force_on_the_person(drive: float, limit: float, rate: float):
    """Force, its change and its power, although the drive itself may be stronger."""
    bench = bench_of(build_device(Robot(device="simulated_impedance"), Patient(intent=False), seed=3), straight=None)
    values = impedance_values(bench.scene, Impedance(drive_stiffness=2e4, drive_damping=200.0, drive_force=drive))
    bench.publish(**values | {"controller": Slot.START, "target": (0.1, 0.08, -0.08)})
    bench.publish(force_limit=limit, force_rate_limit=rate, power_limit=3.0, drive_speed=0.25)
    rows = bench.advance(1500)
    sent, size = rows["f_command"], np.linalg.norm(rows["f_command"], axis=1)
    assert size.max() <= min(drive, limit) * (1.0 + 1e-12)
    assert fastest_change({"f_user_world": sent}) <= rate * T * (1.0 + 1e-9)
    R = bench.scene[0]["R_world_from_robot"]
    assert np.abs(np.sum(sent * (rows["v_world"] @ R), axis=1)).max() <= 3.0 * (1.0 + 1e-9)
    assert size.max() > 0.5 * min(drive, limit, 10.0) and rows["state"].max() >= SafetyState.HOMED


@pytest.mark.parametrize(("limit", "rate"), [(12.0, 2000.0), (60.0, 150.0)])
def test_a_torque_drive_to_the_start_keeps_the_limits_at_the_foot(limit: float, rate: float):
    """Of each joint's torque over its lever arm to the foot, by the Jacobian; the drive alone would push with 200 N."""
    robot = Robot(device="simulated_leg", settings={"mode": "torque"})
    bench = bench_of(build_device(robot, Patient(intent=False), seed=3), straight=None)
    values = impedance_values(bench.scene, Impedance(drive_stiffness=2e4, drive_damping=200.0, drive_force=200.0))
    values |= kinematic_values(robot, LEG) | {"controller": Slot.HOLD, "target": (0.45, 0.9)}
    bench.publish(**values)
    bench.publish(force_limit=limit, force_rate_limit=rate)
    rows = bench.advance(1500)
    torques, J = rows["torque_command"][:, :2], np.zeros(96)
    levers = np.zeros((len(rows), 2))
    for k, q in enumerate(rows["q"]):
        LEG.kinematics.jacobian(LEG.geometry_of(robot), q, q, J)
        levers[k] = np.linalg.norm(J[:6].reshape(3, 2), axis=0)
    forces = torques / levers
    size = np.linalg.norm(forces, axis=1)
    assert size.max() <= limit * (1.0 + 1e-9)
    fallen = np.clip(torques[1:], np.minimum(torques[:-1], 0.0), np.maximum(torques[:-1], 0.0))
    assert (np.abs(torques[1:] - fallen) / levers[1:]).max() <= rate * T * (1.0 + 1e-9)
    assert size.max() > 0.5 * min(limit, 20.0), "the drive pushes"


def test_a_reference_waits_for_a_device_that_cannot_follow():
    reference, f = np.zeros(3), np.zeros(3)
    for _ in range(1000):
        draw_along(np.zeros(3), np.zeros(3), np.array([0.1, 0.0, 0.0]), 600.0, 20.0, 10.0, T, reference, f)
    assert reference[0] == pytest.approx(10.0 / 600.0) and np.linalg.norm(f) <= 10.0 * (1 + 1e-12)


def test_the_simulated_person_goes_through_the_tunnel_on_it():
    """Driven to the start by forces, handed over, led through; no wall is stiffer than stable."""
    curve = wavy()
    way = curve.point(np.linspace(0.0, len(curve.pieces), 200))
    plugin = build_device(Robot(device="simulated_impedance"), Patient(), way, 2)
    bench = bench_of(plugin, straight=None)
    curve.fill(bench.tunnel)
    bench.scene[0]["ball_radius_min"], bench.scene[0]["ball_radius_max"] = 0.008, 0.016
    R, origin = bench.scene[0]["R_world_from_robot"], bench.scene[0]["origin_world"]
    values = impedance_values(bench.scene, Impedance(damping=2.0)) | {"controller": int(Slot.START)}
    bench.publish(target=R.T @ (curve.point(0.0)[0] - origin), **values)
    home = bench.advance(4000)
    assert home["state"][-1] == SafetyState.READY
    assert np.linalg.norm(home["f_command"], axis=1).max() <= 10.0 * (1 + 1e-12)
    bench.publish(controller=int(Slot.PERSON), trial=1)
    bench.send(active=1, trial=1)
    rows = bench.advance(9000)
    assert rows["progress"].max() > 0.97 and set(rows["state"].astype(int)) <= {2, 3, 4}
    touching = rows["penetration"] > 0.0
    assert touching.any() and rows["margin"][touching].min() > 0.0
