"""Kernels of a device's kinematics from Python, compiled once for all devices; records are arrays of shape [1]."""

from __future__ import annotations

from numba import from_dtype, types

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.controller_port import CONTROL_INPUT, CONTROL_WORK
from mimics_app.contracts.loop.device_descriptor import KINEMATICS_SET
from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.rendering.haptic.control.joint_admittance import admit_joints
from mimics_app.rendering.haptic.kernels import joints

_V = types.float64[::1]
_SCENE, _WORK = from_dtype(SCENE)[::1], from_dtype(CONTROL_WORK)[::1]


@typed_kernel(types.void(KINEMATICS_SET, _SCENE, _V, _V))
def points_of(kin, scenes, q, x):
    joints.points_of(kin, scenes[0], q, x)


@typed_kernel(types.void(KINEMATICS_SET, _SCENE, _V, _V, _WORK, _V))
def velocities_of(kin, scenes, q, dq, works, v):
    joints.velocities_of(kin, scenes[0], q, dq, works[0], v)


@typed_kernel(types.void(KINEMATICS_SET, _SCENE, _V, _V, _WORK, _V))
def torques_of(kin, scenes, q, f, works, tau):
    joints.torques_of(kin, scenes[0], q, f, works[0], tau)


@typed_kernel(types.int64(KINEMATICS_SET, _SCENE, _V, _V, _WORK, _V))
def rates_of(kin, scenes, q, v, works, dq):
    return joints.rates_of(kin, scenes[0], q, v, works[0], dq)


@typed_kernel(
    types.void(
        KINEMATICS_SET, from_dtype(CONTROL_INPUT)[::1], _WORK, _V, types.int64, types.float64[:, ::1],
    )
)  # fmt: skip
def glide(kin, inputs, works, dq, ticks, path):
    """A device that follows at once what admittance in its joints says; where its first point is."""
    now, work = inputs[0], works[0]
    for k in range(ticks):
        admit_joints(kin, now, work, dq)
        for j in range(8):
            now.q[j] += now.dt * dq[j]
        joints.points_of(kin, now, now.q, work.points)
        for i in range(3):
            path[k, i] = work.points[i]
