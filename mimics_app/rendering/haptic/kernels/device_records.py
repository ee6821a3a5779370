"""What kernels of the device and its control read of the loop's records, as types: SCENE, STATE and their scratch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["ControlScene", "DeviceScene", "JointWork", "PointState", "PointStates"]

Vec = NDArray[np.float64]


class JointWork(Protocol):
    """A JOINT_WORK record; see kernels.joints."""

    points: Vec
    velocities: Vec
    jacobian: Vec
    matrix: Vec
    side: Vec
    place: Vec
    step: Vec
    wish: Vec
    reached: Vec
    forces: Vec


class DeviceScene(Protocol):
    """What a SCENE record says of the device; see contracts.haptic."""

    joints: int
    contacts: int
    geometry: Vec
    joint_inertia: Vec
    joint_min: Vec
    joint_max: Vec
    target: Vec
    kp: Vec
    kd: Vec


class ControlScene(DeviceScene, Protocol):
    """What it says of the controller besides."""

    controller: int
    form: int
    polar: int
    torques: int
    through_joints: int
    force_driven: int
    virtual_mass: float
    virtual_damping: float
    max_velocity: float
    max_acceleration: float
    joint_velocity: Vec
    joint_acceleration: Vec
    drive_stiffness: float
    drive_damping: float
    drive_force: float
    stale_warn_ns: int
    R_world_from_robot: Vec
    origin_world: Vec


class Observer(Protocol):
    """An OBSERVER record; see kernels.passivity."""

    energy: float


class PointState(Protocol):
    """A STATE record: of the first point of contact also what there is once for the device; see kernels.state."""

    tick: int
    safety: int
    cause: int
    ramp: float
    state_changed: int
    answered: int
    readable: int
    arrived: int
    stale: int
    stale_began: int
    age: float
    delay: float
    grasp: float
    buttons: int
    q: Vec
    dq: Vec
    dq_virtual: Vec
    command: Vec
    torque_meas: Vec
    torque_command: Vec
    f_meas: Vec
    f_meas_world: Vec
    f_user: Vec
    f_user_world: Vec
    f_virt_world: Vec
    f_command: Vec
    hip: Vec
    v: Vec
    hip_world: Vec
    v_world: Vec
    v_virtual: Vec
    reference: Vec
    joint_reference: Vec
    margin: float
    margin_lost: int
    told_margin: float
    stiffness_share: float
    told_share: float
    cap_began: int
    others_world: Vec
    others_v_world: Vec
    others_f_virt_world: Vec
    others_f_user_world: Vec
    others_depth: Vec
    others_margin: Vec
    others_share: Vec
    others_energy: Vec
    joint_work: JointWork
    observer: Observer
    work_a: Vec
    work_b: Vec


PointStates = Sequence[PointState]
"""One record for each point of contact."""
