"""Loop over a recording: the tick of the live loop with the recorded inputs of the device."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import from_dtype, types
from numpy.typing import NDArray

from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.device_descriptor import KINEMATICS_SET, Kin
from mimics_app.contracts.loop.haptic import (
    NANOSECOND,
    SAMPLE,
    SCENE,
)
from mimics_app.contracts.loop.loop_ports import FIELDS
from mimics_app.contracts.loop.object_rows import Rows
from mimics_app.rendering.haptic.channels import CHANNELS, WORK, Channels, Work
from mimics_app.rendering.haptic.kernels.rows import read_inputs
from mimics_app.rendering.haptic.loop_tick import SIMULATION, TICK, rows_of
from mimics_app.rendering.haptic.objects import ROW_STACK
from mimics_app.rendering.haptic.publish import publish_events, publish_state
from mimics_app.rendering.haptic.struck import publish_forces

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        Fields,
        SampleRecord,
        SceneRecord,
        Simulate,
        Table,
        Tick,
    )

__all__ = ["replay_recorded"]


@typed_kernel(
    types.int64(
        CHANNELS,
        WORK,
        from_dtype(SCENE)[::1],
        ROW_STACK,
        types.int64[::1],
        from_dtype(SAMPLE)[::1],
        types.FunctionType(TICK),
        SIMULATION,
        FIELDS,
        KINEMATICS_SET,
        types.int64,
        from_dtype(SAMPLE)[::1],
    )
)
def replay_recorded(
    channels: Channels,
    work: Work,
    scenes: Table[SceneRecord],
    stack: Rows,
    which: NDArray[np.int64],
    inputs: Table[SampleRecord],
    tick: Tick,
    simulate: Simulate,
    fields: Fields,
    kin: Kin,
    period_ns: int,
    outputs: Table[SampleRecord],
) -> int:
    """Run the tick over recorded inputs and publish its events, forces of contacts and its newest state.

    Args:
        channels: Arrays of the replay's own session memory, the target of what is published.
        work: Arrays of the loop, advanced.
        scenes: SCENE blocks, shape [m].
        stack: Tables of objects of each block, shape [m, capacity].
        which: Index of each tick's block, shape [n].
        inputs: SAMPLE rows, shape [n]; only their input fields are used.
        tick: `loop_tick.tick`.
        simulate: The objects' part of the tick.
        fields: Force fields of the objects.
        kin: Kinematics functions of the device.
        period_ns: Tick [ns].
        outputs: SAMPLE rows out, shape [n]; timing fields are zero.

    Returns:
        Ticks done.
    """
    channels, work, stack = borrowed(channels), borrowed(work), borrowed(stack)
    state, data = work.state[0], work.data
    for k in range(inputs.shape[0]):
        row = inputs[k]
        read_inputs(row, data)
        out = outputs[k]
        status = int(row.status)
        stop_word, held = int(row.stop_word), int(row.held)
        scene, rows = scenes[which[k]], borrowed(rows_of(stack, which[k]))
        tick(
            scene,
            rows,
            work.objects,
            simulate,
            fields,
            kin,
            work.state,
            data,
            status,
            stop_word,
            held,
            row.period_s,
            period_ns * NANOSECOND,
            work.command,
            out,
        )
        t_ns = (state.tick - 1) * period_ns
        publish_state(channels, work, scene, t_ns)
        publish_events(channels, work, rows, scene, t_ns)
        publish_forces(channels, work, scene, t_ns)
        out.lateness_ns = 0.0
        out.duration_ns = 0.0
    return inputs.shape[0]
