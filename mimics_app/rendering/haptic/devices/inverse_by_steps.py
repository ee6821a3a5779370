"""Iterative inverse kinematics of a device without a closed form, callable from Python; imported on demand."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numba import from_dtype, types

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.controller_port import CONTROL_WORK
from mimics_app.contracts.loop.device_descriptor import KINEMATICS_SET, Kin
from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.rendering.haptic.kernels.joints import joints_of

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ControlWorkRecord, SceneRecord, Table

__all__ = ["inverse_by_steps"]


_VECTOR = types.float64[::1]


@typed_kernel(types.int64(KINEMATICS_SET, from_dtype(SCENE)[::1], _VECTOR, from_dtype(CONTROL_WORK)[::1], _VECTOR))
def inverse_by_steps(kin: Kin, scenes: Table[SceneRecord], x: Vec, works: Table[ControlWorkRecord], q: Vec) -> int:
    """`kernels.joints.joints_of` for SCENE and CONTROL_WORK records of shape [1]; compiled once for all devices."""
    return joints_of(kin, scenes[0], x, works[0], q)
