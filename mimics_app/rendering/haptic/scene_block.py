"""Parameter blocks for the loop, from the components of a scene and from nothing else.

A scene without a component has that component's own defaults. Reports read the limits back from the block that ran.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import SCENE, AdmittanceForm, Controller
from mimics_app.world.components.robot import Admittance, Ball, Impedance, JointPd, Robot, Safety, WorldPd

__all__ = [
    "apply_admittance",
    "apply_ball",
    "apply_joint_pd",
    "apply_robot",
    "apply_safety",
    "apply_world_pd",
    "axis_offset",
    "impedance_values",
    "robot_from_world",
    "safety_of",
    "scene_from_components",
]

Block = NDArray[Any]
Vec = NDArray[np.float64]

_FORMS = {
    "auto": AdmittanceForm.CARTESIAN,  # without a plan: the one without false force
    "seed": AdmittanceForm.SEED,
    "polar": AdmittanceForm.POLAR,
    "cartesian": AdmittanceForm.CARTESIAN,
}
_NS = 1_000_000_000
_CAP = {"cap": 1, "warn": 0}

_SECONDS = {"ramp_time": "ramp_time_s"}
_NANOSECONDS = {
    "late_hold_ns": "late_hold_s",
    "late_damp_ns": "late_damp_s",
    "late_stop_ns": "late_stop_s",
    "stale_warn_ns": "stale_warn_s",
    "stale_stop_ns": "stale_stop_s",
}
"""Limits whose name in `Safety` differs, by their name in the block."""


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
        **_drive_values(impedance),
    }


def apply_joint_pd(block: Block, joint_pd: JointPd, target_joints: Vec) -> None:
    """Joint PD towards target_joints (m, rad, m) into block[0], and select it."""
    record = block[0]
    record["controller"] = Controller.JOINT_PD
    _apply_gains(block, joint_pd)
    record["target"] = target_joints


def apply_world_pd(block: Block, world_pd: WorldPd, target_world: Vec) -> None:
    """World PD towards target_world [m] into block[0], and select it; straight unless the form is SEED."""
    record = block[0]
    record["controller"] = Controller.WORLD_PD
    _apply_gains(block, world_pd)
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
    for name in Safety.__struct_fields__:
        if name in (SCENE.names or ()):
            record[name] = getattr(safety, name)
    for field, name in _SECONDS.items():
        record[field] = getattr(safety, name)
    for field, name in _NANOSECONDS.items():
        record[field] = round(getattr(safety, name) * _NS)
    record["cap"] = _CAP[safety.stiffness_cap]


def safety_of(block: Block) -> Safety:
    """The limits and thresholds of block[0] as the component that asks for them: what a report states."""
    record = block[0]
    values: dict[str, object] = {
        name: record[name].item() for name in Safety.__struct_fields__ if name in (SCENE.names or ())
    }
    values |= {name: record[field].item() for field, name in _SECONDS.items()}
    values |= {name: record[field].item() / _NS for field, name in _NANOSECONDS.items()}
    values["stiffness_cap"] = next(word for word, number in _CAP.items() if number == record["cap"])
    return msgspec.convert(values, Safety, strict=False)


def _apply_gains(block: Block, gains: JointPd | WorldPd) -> None:
    """Gains of a PD controller into block[0]; which one runs is not touched."""
    block[0]["kp"], block[0]["kd"] = gains.kp, gains.kd


def _apply_drive(block: Block, impedance: Impedance) -> None:
    """What draws a force driven device to a target into block[0]."""
    record = block[0]
    for name, value in _drive_values(impedance).items():
        record[name] = value


def _drive_values(impedance: Impedance) -> Mapping[str, object]:
    return {name: getattr(impedance, name) for name in ("drive_stiffness", "drive_damping", "drive_force")}


def scene_from_components(
    robot: Robot | None = None,
    admittance: Admittance | None = None,
    ball: Ball | None = None,
    safety: Safety | None = None,
    gains: JointPd | WorldPd | None = None,
) -> Block:
    """A block from the components of a scene; one that is absent has its own defaults.

    Tunnels and objects are rows beside the record (`scene_objects`); the device fills in what `device_fit` knows of it.
    Until then a device counts as a real one whose late ticks latch.

    Returns:
        SCENE record, shape [1], sequence 1, admittance selected. For a PD controller call `apply_joint_pd`
        or `apply_world_pd` on it and count `sequence` up; `apply_admittance` leads back.
    """
    block = np.zeros(1, SCENE)
    block["sequence"] = 1
    block["late_latches"] = 1
    apply_robot(block, robot or Robot())
    _apply_gains(block, gains or JointPd())
    _apply_drive(block, Impedance())
    apply_admittance(block, admittance or Admittance())
    apply_ball(block, ball or Ball())
    apply_safety(block, safety or Safety())
    return block
