"""Parameter blocks for the loop from the components of a scene.

A missing component has its defaults. Reports read the limits back from the block that ran.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import msgspec
import numpy as np

from mimics_app.contracts.arrays import Records, Vec
from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.loop.controller_slots import Slot, name_bytes
from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor
from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.contracts.loop.loop_fields import MAX_JOINTS
from mimics_app.contracts.loop.loop_ports import LIGHTEST_DEVICE, DevicePlugin
from mimics_app.rendering.haptic.controllers.parameter_vector import Values, parameter_vector
from mimics_app.rendering.haptic.controllers.registry import find_controller
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.descriptors.joint_limits import joint_limits
from mimics_app.world.components.robot import Admittance, Ball, Impedance, JointPd, Robot, Safety, WorldPd

__all__ = [
    "apply_robot",
    "apply_safety",
    "controller_values",
    "dynamics_of",
    "impedance_values",
    "kinematic_values",
    "robot_from_world",
    "safety_of",
    "scene_from_components",
]


_UNPLANNED = "cartesian"
"""Form of admittance without a plan: the one without errors of the coupling terms."""

_CAP = {"cap": 1, "warn": 0}

_SECONDS = {"ramp_time": "ramp_time_s"}
_NANOSECONDS = {
    "late_hold_ns": "late_hold_s",
    "late_damp_ns": "late_damp_s",
    "late_stop_ns": "late_stop_s",
    "stale_warn_ns": "stale_warn_s",
    "stale_stop_ns": "stale_stop_s",
}
"""Limits with another name in `Safety` and in nanoseconds in the block, by their name in the block."""


def robot_from_world(robot: Robot, points_world: Vec) -> Vec:
    """Return points of the world, shape [n, 3], in the robot frame [m]."""
    R = np.array(robot.robot_to_world.rotation)
    return np.ascontiguousarray((np.asarray(points_world) - np.array(robot.robot_to_world.translation)) @ R)


def _joint_vector(values: Sequence[float], fill: float = 0.0) -> Vec:
    """Return the values of a device's joints padded with `fill`, shape [MAX_JOINTS]."""
    return np.concatenate([np.asarray(values, np.float64), np.full(MAX_JOINTS - len(values), fill)])


def kinematic_values(
    robot: Robot, descriptor: DeviceDescriptor = HAPTICMASTER, admittance: Admittance | None = None
) -> dict[str, object]:
    """Return the SCENE fields of the device: joints and their limits, points of contact, geometry.

    Velocity and acceleration of a joint have the smaller of the limits of the robot and of admittance control.
    """
    limits = joint_limits(robot, descriptor)
    velocity, acceleration = _joint_vector(limits.velocity), _joint_vector(limits.acceleration)
    if admittance is not None:
        velocity = _least(velocity, admittance.max_joint_velocity)
        acceleration = _least(acceleration, admittance.max_joint_acceleration)
    return {
        "joints": len(descriptor.joints),
        "contacts": len(descriptor.contacts),
        "torques": int(descriptor.torques),
        "polar": int(descriptor.polar),
        "geometry": descriptor.geometry_of(robot),
        "joint_inertia": _joint_vector([joint.inertia for joint in descriptor.joints]),
        "joint_min": _joint_vector(limits.lowest),
        "joint_max": _joint_vector(limits.highest),
        "joint_velocity": velocity,
        "joint_acceleration": acceleration,
    }


def _least(limits: Vec, most: Sequence[float] | None) -> Vec:
    """Return the smaller of the limits and a controller's, whose last number holds for all further joints."""
    return limits if most is None else np.minimum(limits, _joint_vector(most, most[-1]))


def apply_robot(
    block: Records, robot: Robot, descriptor: DeviceDescriptor = HAPTICMASTER, admittance: Admittance | None = None
) -> None:
    """Write kinematics, joint limits and pose of the robot into block[0]."""
    record = block[0]
    for name, value in kinematic_values(robot, descriptor, admittance).items():
        record[name] = value
    record["R_world_from_robot"] = robot.robot_to_world.rotation
    record["origin_world"] = robot.robot_to_world.translation


def controller_values(block: Records, slot: int, name: str, values: Values | None = None) -> dict[str, object]:
    """Return the SCENE fields of the controllers, those of a block with another controller in one slot.

    Args:
        block: SCENE record, shape [1].
        slot: Slot, or a number behind them.
        name: Name of the controller.
        values: Its parameters by name; those missing have their default.

    Raises:
        UsageError: No such controller or parameter, or a value is outside its range.
    """
    plugin = find_controller(name)
    new = {
        "controller_names": name_bytes(name),
        "leads": plugin.leads,
        "commands": plugin.commands,
        "targets": plugin.target,
        "each_joint": plugin.each_joint,
        "controller_parameters": parameter_vector(plugin, values or {}),
    }
    fields: dict[str, object] = {}
    for field, value in new.items():
        slots = block[0][field].copy()
        slots[slot] = value
        fields[field] = slots
    return fields


def _set_controller(block: Records, slot: int, name: str, values: Values | None = None) -> None:
    """Write a controller and its parameters into a slot of block[0], see `controller_values`."""
    record = block[0]
    for field, value in controller_values(block, slot, name, values).items():
        record[field] = value


def _admittance_controller(admittance: Admittance, descriptor: DeviceDescriptor) -> str:
    """Return the name of the admittance controller of a device."""
    if not descriptor.polar:
        return "admittance_joints"
    return f"admittance_{_UNPLANNED if admittance.form == 'auto' else admittance.form}"


def _apply_admittance(block: Records, admittance: Admittance, descriptor: DeviceDescriptor) -> None:
    """Write the parameters of admittance control into block[0], and select it."""
    record = block[0]
    _set_controller(block, Slot.PERSON, _admittance_controller(admittance, descriptor))
    record["controller"] = Slot.PERSON
    record["virtual_mass"] = admittance.mass
    record["virtual_damping"] = admittance.damping
    record["max_acceleration"] = admittance.max_acceleration
    record["max_velocity"] = admittance.max_velocity


def impedance_values(block: Records, impedance: Impedance) -> dict[str, object]:
    """Return the SCENE fields of impedance control, for a device that takes forces, beside those of block[0]."""
    return {
        **controller_values(block, Slot.PERSON, "impedance"),
        "controller": int(Slot.PERSON),
        "force_driven": 1,
        "virtual_damping": impedance.damping,
        "device_damping": impedance.device_damping,
        **_drive_values(impedance),
    }


def dynamics_of(plugin: DevicePlugin) -> dict[str, float]:
    """Return the SCENE fields of a device's dynamics, for the stability limit."""
    takes_forces = plugin.follows in ("force", "torque")
    return {
        "device_delay": plugin.delay,
        "device_lag": min(plugin.lag, plugin.delay),
        "device_filter": plugin.filtering,
        "device_quantum": plugin.quantum,
        "device_mass": plugin.mass or LIGHTEST_DEVICE if takes_forces else 0.0,
    }


def _apply_ball(block: Records, ball: Ball) -> None:
    """Write the sizes of the ball into block[0]."""
    record = block[0]
    record["ball_radius_min"] = ball.radius_min
    record["ball_radius_max"] = ball.radius_max
    record["grasp_force_full"] = ball.grasp_force_full


def apply_safety(block: Records, safety: Safety) -> None:
    """Write limits and thresholds into block[0]."""
    record = block[0]
    for name in Safety.__struct_fields__:
        if name in (SCENE.names or ()):
            record[name] = getattr(safety, name)
    for field, name in _SECONDS.items():
        record[field] = getattr(safety, name)
    for field, name in _NANOSECONDS.items():
        record[field] = round(getattr(safety, name) * SECOND_NS)
    record["cap"] = _CAP[safety.stiffness_cap]


def safety_of(block: Records) -> Safety:
    """Return the limits and thresholds of block[0] as a component, for reports."""
    record = block[0]
    values: dict[str, object] = {
        name: record[name].item() for name in Safety.__struct_fields__ if name in (SCENE.names or ())
    }
    values |= {name: record[field].item() for field, name in _SECONDS.items()}
    values |= {name: record[field].item() / SECOND_NS for field, name in _NANOSECONDS.items()}
    values["stiffness_cap"] = next(word for word, number in _CAP.items() if number == record["cap"])
    return msgspec.convert(values, Safety, strict=False)


def _apply_gains(block: Records, gains: JointPd | WorldPd) -> None:
    """Write the controllers that hold the robot and drive it to a start into block[0]; none is selected."""
    values = {"kp": gains.kp, "kd": gains.kd}
    _set_controller(block, Slot.HOLD, "joint_pd", values)
    _set_controller(block, Slot.START, f"world_pd_{gains.form}" if isinstance(gains, WorldPd) else "joint_pd", values)
    block[0]["drive_rate"] = max(_joint_vector(gains.kp, gains.kp[-1])[:3])


def _apply_drive(block: Records, impedance: Impedance) -> None:
    """Write the spring, damper and force limit that draw a force driven device to a target into block[0]."""
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
    descriptor: DeviceDescriptor = HAPTICMASTER,
) -> Records:
    """Return a block from the components of a scene; a missing one has its defaults.

    Tunnels and objects are rows beside the record (`scene_objects`); `device_fit` adds the fields of the open device.
    Until then the device counts as a real one, whose late ticks latch a stop.

    Returns:
        SCENE record, shape [1], sequence 1, admittance selected.
    """
    block = np.zeros(1, SCENE)
    block["sequence"] = 1
    block["late_latches"] = 1
    apply_robot(block, robot or Robot(), descriptor, admittance)
    _apply_gains(block, gains or WorldPd())
    _apply_drive(block, Impedance())
    _apply_admittance(block, admittance or Admittance(), descriptor)
    _apply_ball(block, ball or Ball())
    apply_safety(block, safety or Safety())
    return block
