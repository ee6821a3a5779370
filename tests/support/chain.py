"""A device of the greatest shape there is: a planar chain of eight turning joints that touches at every second link.

Only its points and its Jacobian are given: the loop works out the rest.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.device_descriptor import KINEMATICS, DeviceDescriptor, Joint, Kinematics
from mimics_app.contracts.loop.loop_ports import DATA_LENGTH, READ

LINK = 0.1


@typed_kernel(KINEMATICS)
def chain_points(geometry, q, given, out):
    x, z, angle = 0.0, 0.0, 0.0
    for j in range(8):
        angle += q[j]
        x += geometry[0] * math.cos(angle)
        z += geometry[0] * math.sin(angle)
        if j % 2 == 1:
            out[3 * (j // 2)], out[3 * (j // 2) + 1], out[3 * (j // 2) + 2] = x, 0.0, z
    return 0


@typed_kernel(KINEMATICS)
def chain_jacobian(geometry, q, given, out):
    for i in range(12 * 8):
        out[i] = 0.0
    for c in range(4):
        for j in range(2 * c + 2):
            angle = 0.0
            for k in range(2 * c + 2):
                angle += q[k]
                if k >= j:
                    out[(3 * c) * 8 + j] -= geometry[0] * math.sin(angle)
                    out[(3 * c + 2) * 8 + j] += geometry[0] * math.cos(angle)
    return 0


CHAIN = DeviceDescriptor(
    joints=tuple(Joint(f"joint {j}", "rad", -1.5, 1.5, 3.0, 50.0, inertia=0.05) for j in range(8)),
    contacts=("hand", "fingers", "tool", "left foot"),
    kinematics=Kinematics(chain_points, chain_jacobian),
    geometry=lambda robot: (LINK,),
    torques=True,
)


@typed_kernel(READ)
def read_rows(memory, inbox, data, tick):
    """Data vectors one behind the other, the last one for ever."""
    row = min(tick, memory.shape[0] // DATA_LENGTH - 1) * DATA_LENGTH
    for i in range(DATA_LENGTH):
        data[i] = memory[row + i]
    return 0


def data_rows(ticks: int) -> np.ndarray:
    """Rows for `read_rows`, all zero."""
    return np.zeros((ticks, DATA_LENGTH))
