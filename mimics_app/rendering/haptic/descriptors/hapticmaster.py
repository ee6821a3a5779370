"""Descriptor of the HapticMaster (D2.1 4.2.1-4.2.4): joints radial, angle, vertical; one point of contact."""

from __future__ import annotations

from typing import Any

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.device_descriptor import (
    KINEMATICS,
    DeviceDescriptor,
    Joint,
    Kinematics,
    KinematicsStatus,
)
from mimics_app.rendering.haptic.kernels import kinematics

__all__ = ["HAPTICMASTER", "axis_offset"]


@typed_kernel(KINEMATICS)
def _forward(geometry: Vec, q: Vec, given: Vec, out: Vec) -> int:
    kinematics.forward(q, geometry[0], out)
    return KinematicsStatus.DONE


@typed_kernel(KINEMATICS)
def _jacobian(geometry: Vec, q: Vec, given: Vec, out: Vec) -> int:
    kinematics.jacobian(q, geometry[0], out[:9].reshape((3, 3)))
    return KinematicsStatus.DONE


@typed_kernel(KINEMATICS)
def _inverse(geometry: Vec, q: Vec, given: Vec, out: Vec) -> int:
    kinematics.inverse(given, geometry[0], out)
    return KinematicsStatus.DONE


@typed_kernel(KINEMATICS)
def _velocity(geometry: Vec, q: Vec, given: Vec, out: Vec) -> int:
    kinematics.apply_jacobian(q, geometry[0], given, out)
    return KinematicsStatus.DONE


@typed_kernel(KINEMATICS)
def _torque(geometry: Vec, q: Vec, given: Vec, out: Vec) -> int:
    kinematics.apply_jacobian_transposed(q, geometry[0], given, out)
    return KinematicsStatus.DONE


@typed_kernel(KINEMATICS)
def _rates(geometry: Vec, q: Vec, given: Vec, out: Vec) -> int:
    kinematics.apply_inverse_jacobian(q, geometry[0], given, out)
    return KinematicsStatus.DONE


@typed_kernel(KINEMATICS)
def _to_robot(geometry: Vec, q: Vec, given: Vec, out: Vec) -> int:
    kinematics.tool_to_robot(q, given, out)
    return KinematicsStatus.DONE


def axis_offset(robot: Any) -> float:
    """Return d1 of equation (1) [m]: `axis_offset` of a robot component, else stroke / 2 + offset."""
    return float(robot.stroke / 2.0 + robot.offset if robot.axis_offset is None else robot.axis_offset)


HAPTICMASTER = DeviceDescriptor(
    joints=(
        Joint("radial", "m", -0.18, 0.18, velocity=1.0, acceleration=50.0),
        Joint("angle", "rad", -0.5, 0.5, velocity=2.0, acceleration=150.0),
        Joint("vertical", "m", -0.20, 0.20, velocity=1.0, acceleration=50.0),
    ),
    contacts=("hand",),
    kinematics=Kinematics(_forward, _jacobian, _inverse, _velocity, _torque, _rates, _to_robot),
    geometry=lambda robot: (axis_offset(robot),),
    polar=True,
)
"""Ranges are the vendor's demonstration constants; 50 m/s^2 is from its data sheet, for the angle at r = 0.33 m."""
