"""Simulates a recording again with the tick that made it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import SAMPLE, SCENE
from mimics_app.contracts.loop_ports import COMMAND_LENGTH, DATA_LENGTH
from mimics_app.contracts.object_rows import ObjectCapacities, Rows, count_rows, new_rows, slot_of
from mimics_app.rendering.haptic.kernels.state import new_state
from mimics_app.rendering.haptic.loop import replay_recorded
from mimics_app.rendering.haptic.no_objects import NO_FIELDS, no_objects
from mimics_app.rendering.haptic.objects import load_simulation, new_object_work

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.object_statics import ObjectStatics

__all__ = ["replay_ticks"]

Records = NDArray[Any]


def replay_ticks(
    inputs: Records,
    scenes: Mapping[int, Records],
    rows: Mapping[int, Rows] | None = None,
    statics: ObjectStatics | None = None,
    *,
    period_ns: int = 1_000_000,
) -> Records:
    """Simulate recorded inputs again; equal bit for bit except for the timing fields.

    Args:
        inputs: SAMPLE rows from tick 0 on, shape [n].
        scenes: SCENE record (a record, or an array of shape [1]) for each sequence number in the inputs.
        rows: The tables of objects beside them, by the same numbers; none where there are no objects.
        statics: What the objects were given once; None where they were given nothing.
        period_ns: Length of a tick [ns].

    Returns:
        SAMPLE rows, shape [n]; `lateness_ns` and `duration_ns` are 0.

    Raises:
        KeyError: An input names a sequence that is not in `scenes` (0, before the first block, is known), or objects
            are counted that are not in `rows`.
    """
    numbers = sorted({int(sequence) for sequence in np.unique(inputs["sequence"])})
    blocks = np.zeros(len(numbers), SCENE)
    for i, number in enumerate(numbers):
        if number != 0:
            blocks[i] = np.asarray(scenes[number]).reshape(-1)[0]
    capacities = _room_for(blocks, 1 if statics is None else max(1, len(statics.paths)))
    stack = new_rows(capacities, len(numbers))
    for i, number in enumerate(numbers):
        if any(count_rows(blocks[i]["objects"]).values()):
            slot_of(stack, i, (rows or {})[number], blocks[i]["objects"])
    which = np.searchsorted(np.array(numbers, np.int64), inputs["sequence"].astype(np.int64)).astype(np.int64)
    outputs = np.zeros(inputs.shape[0], SAMPLE)
    replay_recorded(
        blocks,
        stack,
        which,
        np.ascontiguousarray(inputs),
        new_state(),
        new_object_work(capacities) if statics is None else statics.work(capacities),
        load_simulation() if rows else no_objects,
        NO_FIELDS if statics is None else statics.functions(),
        np.zeros(DATA_LENGTH),
        np.zeros(COMMAND_LENGTH),
        period_ns * 1e-9,
        outputs,
    )
    return outputs


def _room_for(blocks: Records, paths: int) -> ObjectCapacities:
    """Capacities that hold every block's rows."""
    most = {name: max(1, int(blocks["objects"][name].max())) for name in Rows._fields}
    return ObjectCapacities(**most, paths=paths)
