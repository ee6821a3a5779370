"""Checks of a device's descriptor: consistent kinematics, and data of its own joints only."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.device_descriptor import KinematicsStatus
from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS, MAX_JOINTS
from mimics_app.contracts.loop.loop_ports import DATA_DQ, DATA_FORCE, DATA_Q, DATA_TORQUE
from mimics_app.rendering.haptic.descriptors.joint_limits import joint_limits
from mimics_app.rendering.haptic.devices.conformance_finding import NotApplicable, must
from mimics_app.rendering.haptic.scene_block import apply_robot

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.devices.device_bench import DeviceBench
    from mimics_app.world.components.robot import Robot

__all__ = ["KINEMATICS_CHECKS"]


_POSES = 40
_STEP = 1e-6
_SLOPE = 1e-6
"""Error bound of a central difference over _STEP, for a Jacobian of order 1 m."""

_EXACT = 1e-9
_BACK = 1e-6
"""Error bound of the points of an inverse [m]."""


class _Poses:
    """Kinematics of the device on the bench at random poses inside its limits."""

    def __init__(self, bench: DeviceBench, robot: Robot) -> None:
        self.joints, self.rows = bench.joints, 3 * len(bench.descriptor.contacts)
        self.kin = bench.descriptor.kinematics
        block = np.zeros(1, SCENE)
        apply_robot(block, robot, bench.descriptor)
        self.geometry = block[0]["geometry"].copy()
        limits = joint_limits(robot, bench.descriptor)
        rng = np.random.default_rng(1)
        self.poses = [self.padded(q) for q in rng.uniform(limits.lowest, limits.highest, (_POSES, self.joints))]
        self.rates = [self.padded(dq) for dq in rng.uniform(-1.0, 1.0, (_POSES, self.joints))]
        self.forces = rng.uniform(-50.0, 50.0, (_POSES, 3 * MAX_CONTACTS))

    @staticmethod
    def padded(values: Vec) -> Vec:
        return np.concatenate([values, np.zeros(MAX_JOINTS - len(values))])

    def points(self, q: Vec) -> Vec:
        x = np.zeros(3 * MAX_CONTACTS)
        self.kin.forward(self.geometry, q, q, x)
        return x[: self.rows]

    def jacobian(self, q: Vec) -> Vec:
        J = np.zeros(3 * MAX_CONTACTS * MAX_JOINTS)
        self.kin.jacobian(self.geometry, q, q, J)
        return J[: self.rows * self.joints].reshape(self.rows, self.joints)

    def closed(self, function: Callable[..., int], q: Vec, given: Vec) -> tuple[int, Vec]:
        out = np.zeros(3 * MAX_CONTACTS)
        return int(function(self.geometry, q, given, out)), out


def _has_finite_points(bench: DeviceBench, robot: Robot) -> None:
    poses = _Poses(bench, robot)
    must(all(np.isfinite(poses.points(q)).all() for q in poses.poses), "a point of contact is not finite")


def _has_the_jacobian_of_its_points(bench: DeviceBench, robot: Robot) -> None:
    poses = _Poses(bench, robot)
    for q, dq in zip(poses.poses, poses.rates, strict=True):
        slope = (poses.points(q + _STEP * dq) - poses.points(q - _STEP * dq)) / (2.0 * _STEP)
        off = float(np.abs(poses.jacobian(q) @ dq[: poses.joints] - slope).max())
        must(off < _SLOPE, f"its Jacobian is off by {off:.2g} m per unit from the slope of its points")


def _has_closed_forms_of_its_jacobian(bench: DeviceBench, robot: Robot) -> None:
    poses = _Poses(bench, robot)
    for q, dq, f in zip(poses.poses, poses.rates, poses.forces, strict=True):
        J = poses.jacobian(q)
        status, v = poses.closed(poses.kin.velocity, q, dq)
        right = status == KinematicsStatus.NOT_GIVEN or np.allclose(
            v[: poses.rows], J @ dq[: poses.joints], atol=_EXACT
        )
        must(bool(right), "velocity is not J dq")
        status, tau = poses.closed(poses.kin.torque, q, f)
        wanted = J.T @ f[: poses.rows]
        right = status == KinematicsStatus.NOT_GIVEN or np.allclose(tau[: poses.joints], wanted, atol=_EXACT)
        must(bool(right), "torque is not J^T f")


def _finds_back_where_its_points_are(bench: DeviceBench, robot: Robot) -> None:
    poses = _Poses(bench, robot)
    for q in poses.poses:
        x = np.zeros(3 * MAX_CONTACTS)
        x[: poses.rows] = poses.points(q)
        found = q.copy()
        status = int(poses.kin.inverse(poses.geometry, q, x, found))
        if status == KinematicsStatus.NOT_GIVEN:
            raise NotApplicable("its inverse is computed from its Jacobian")
        off = float(np.abs(poses.points(found) - x[: poses.rows]).max())
        must(status == KinematicsStatus.DONE and off < _BACK, f"its inverse misses a place it can reach by {off:.2g} m")


def _fills_its_own_joints_only(bench: DeviceBench, robot: Robot) -> None:
    fresh = bench.run(50).fresh
    behind = np.hstack(
        [
            fresh[:, DATA_Q + bench.joints : DATA_DQ],
            fresh[:, DATA_DQ + bench.joints : DATA_FORCE],
            fresh[:, DATA_FORCE + 3 * len(bench.descriptor.contacts) : DATA_TORQUE],
            fresh[:, DATA_TORQUE + (bench.joints if bench.descriptor.torques else 0) : DATA_TORQUE + MAX_JOINTS],
        ]
    )
    must(not behind.any(), "it fills places of joints or points of contact that it does not have")


KINEMATICS_CHECKS: tuple[Callable[[DeviceBench, Robot], None], ...] = (
    _has_finite_points,
    _has_the_jacobian_of_its_points,
    _has_closed_forms_of_its_jacobian,
    _finds_back_where_its_points_are,
    _fills_its_own_joints_only,
)
"""The checks, in order."""
