"""Parameter blocks for the loop, from defaults and from the components of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import SCENE, AdmittanceForm, Controller

if TYPE_CHECKING:
    from mimics_app.world.components.robot import Admittance, Ball, Impedance, JointPd, Robot, Safety, WorldPd

__all__ = [
    "apply_admittance",
    "apply_ball",
    "apply_joint_pd",
    "apply_robot",
    "apply_safety",
    "apply_world_pd",
    "axis_offset",
    "default_scene",
    "impedance_values",
    "robot_from_world",
    "scene_from_components",
]

Block = NDArray[Any]
Vec = NDArray[np.float64]

_FORMS = {"seed": AdmittanceForm.SEED, "polar": AdmittanceForm.POLAR, "cartesian": AdmittanceForm.CARTESIAN}
_NS = 1_000_000_000


def default_scene() -> Block:
    """A block with sane limits, a free ball and no tunnel: HapticMaster, 3 kg, shape [1], sequence 1."""
    block = np.zeros(1, SCENE)
    record = block[0]
    record["sequence"] = 1
    record["controller"] = Controller.ADMITTANCE
    record["form"] = AdmittanceForm.CARTESIAN
    record["kp"] = 4.0
    record["kd"] = 0.1
    record["virtual_mass"] = 3.0
    record["virtual_damping"] = 5.0
    record["drive_stiffness"], record["drive_damping"], record["drive_force"] = 600.0, 20.0, 10.0
    record["max_acceleration"] = 20.0
    record["max_velocity"] = 0.8
    record["axis_offset"] = 0.46
    record["joint_min"] = (-0.18, -0.5, -0.20)
    record["joint_max"] = (0.18, 0.5, 0.20)
    record["R_world_from_robot"] = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
    record["ball_radius_min"] = 0.012
    record["ball_radius_max"] = 0.030
    record["grasp_force_full"] = 20.0
    record["force_limit"] = 60.0
    record["force_rate_limit"] = 2000.0
    record["velocity_limit"] = 1.5
    record["workspace_margin"] = 0.01
    record["ramp_time"] = 0.5
    record["ramp_force"] = 5.0
    record["power_limit"] = 60.0
    record["position_jump"] = 0.001
    record["energy_limit"] = 1.0
    record["cap"] = 1
    record["cap_margin"] = 0.2
    record["passivity"] = 1
    record["passivity_damping"] = 300.0
    record["tank_size"] = 5.0
    record["tank_refill"] = 1.0
    record["tank_return"] = 0.9
    record["late_hold_ns"] = 2_000_000
    record["late_damp_ns"] = 10_000_000
    record["late_stop_ns"] = 50_000_000
    record["missed_stop"] = 20
    record["stale_warn_ns"] = 3_000_000
    record["stale_stop_ns"] = 20_000_000
    record["tunnel"]["radius_scale"] = 1.0
    return block


def axis_offset(robot: Robot) -> float:
    """d1 of equation (1) [m]: as given, else stroke / 2 + offset."""
    return robot.stroke / 2.0 + robot.offset if robot.axis_offset is None else robot.axis_offset


def robot_from_world(robot: Robot, points_world: Vec) -> Vec:
    """Points of the world, shape [n, 3], in the robot frame [m]."""
    R = np.array(robot.robot_to_world.rotation)
    return np.ascontiguousarray((np.asarray(points_world) - np.array(robot.robot_to_world.translation)) @ R)


def apply_robot(block: Block, robot: Robot) -> None:
    """Kinematics, joint limits and place of the robot into block[0]."""
    record = block[0]
    record["axis_offset"] = axis_offset(robot)
    record["joint_min"] = robot.joint_min
    record["joint_max"] = robot.joint_max
    record["R_world_from_robot"] = robot.robot_to_world.rotation
    record["origin_world"] = robot.robot_to_world.translation


def apply_admittance(block: Block, admittance: Admittance) -> None:
    """Admittance control into block[0], and select it."""
    record = block[0]
    record["controller"] = Controller.ADMITTANCE
    record["form"] = _FORMS[admittance.form]
    record["virtual_mass"] = admittance.mass
    record["virtual_damping"] = admittance.damping
    record["max_acceleration"] = admittance.max_acceleration
    record["max_velocity"] = admittance.max_velocity


def impedance_values(impedance: Impedance) -> dict[str, object]:
    """SCENE fields of a device that is told forces, under impedance control."""
    return {
        "controller": int(Controller.IMPEDANCE),
        "force_driven": 1,
        "virtual_damping": impedance.damping,
        "device_damping": impedance.device_damping,
        "drive_stiffness": impedance.drive_stiffness,
        "drive_damping": impedance.drive_damping,
        "drive_force": impedance.drive_force,
    }


def apply_joint_pd(block: Block, joint_pd: JointPd, target_joints: Vec) -> None:
    """Joint PD towards target_joints (m, rad, m) into block[0], and select it."""
    record = block[0]
    record["controller"] = Controller.JOINT_PD
    record["kp"] = joint_pd.kp
    record["kd"] = joint_pd.kd
    record["target"] = target_joints


def apply_world_pd(block: Block, world_pd: WorldPd, target_world: Vec) -> None:
    """World PD towards target_world [m] into block[0], and select it; straight unless the form is SEED."""
    record = block[0]
    record["controller"] = Controller.WORLD_PD
    record["kp"] = world_pd.kp
    record["kd"] = world_pd.kd
    record["target"] = record["R_world_from_robot"].T @ (np.asarray(target_world) - record["origin_world"])


def apply_ball(block: Block, ball: Ball) -> None:
    """Sizes of the ball into block[0]."""
    record = block[0]
    record["ball_radius_min"] = ball.radius_min
    record["ball_radius_max"] = ball.radius_max
    record["grasp_force_full"] = ball.grasp_force_full


def apply_safety(block: Block, safety: Safety) -> None:
    """Limits and thresholds into block[0]."""
    record = block[0]
    record["force_limit"] = safety.force_limit
    record["force_rate_limit"] = safety.force_rate_limit
    record["velocity_limit"] = safety.velocity_limit
    record["workspace_margin"] = safety.workspace_margin
    record["ramp_time"] = safety.ramp_time_s
    record["ramp_force"] = safety.ramp_force
    record["late_hold_ns"] = round(safety.late_hold_s * _NS)
    record["late_damp_ns"] = round(safety.late_damp_s * _NS)
    record["late_stop_ns"] = round(safety.late_stop_s * _NS)
    record["missed_stop"] = safety.missed_stop
    record["stale_warn_ns"] = round(safety.stale_warn_s * _NS)
    record["stale_stop_ns"] = round(safety.stale_stop_s * _NS)
    record["arm_damping"] = safety.arm_damping
    record["power_limit"] = safety.power_limit
    record["position_jump"] = safety.position_jump
    record["energy_limit"] = safety.energy_limit
    record["cap"] = safety.stiffness_cap == "cap"
    record["cap_margin"] = safety.cap_margin
    record["passivity"] = safety.passivity
    record["passivity_damping"] = safety.passivity_damping
    record["tank_size"] = safety.tank_size
    record["tank_refill"] = safety.tank_refill
    record["tank_return"] = safety.tank_return


def scene_from_components(
    robot: Robot | None = None,
    admittance: Admittance | None = None,
    ball: Ball | None = None,
    safety: Safety | None = None,
) -> Block:
    """A block from the components of a scene; what is absent keeps its default. The tunnel fills its own record.

    Returns:
        SCENE record, shape [1], sequence 1, admittance selected. For a PD controller call `apply_joint_pd` or
        `apply_world_pd` on it and count `sequence` up; `apply_admittance` leads back.
    """
    block = default_scene()
    if robot is not None:
        apply_robot(block, robot)
    if admittance is not None:
        apply_admittance(block, admittance)
    if ball is not None:
        apply_ball(block, ball)
    if safety is not None:
        apply_safety(block, safety)
    return block
