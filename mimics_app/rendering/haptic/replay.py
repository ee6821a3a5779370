"""Replay: simulation of recorded inputs with the tick of the live loop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Records, Words
from mimics_app.contracts.loop.contact_force import CONTACT_FORCE
from mimics_app.contracts.loop.controller_slots import names_in
from mimics_app.contracts.loop.device_descriptor import Kinematics
from mimics_app.contracts.loop.haptic import EVENT, SAMPLE, SCENE
from mimics_app.contracts.loop.loop_fields import HapticSnapshot
from mimics_app.contracts.loop.object_rows import ObjectCapacities, Rows, count_rows, has_objects, new_rows, slot_of
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.session_memory import Capacities, SessionMemory
from mimics_app.rendering.haptic.channels import channels_of, new_work, newest_snapshot
from mimics_app.rendering.haptic.controllers.registry import controllers_of, set_controllers
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.loop_tick import tick
from mimics_app.rendering.haptic.no_objects import NO_FIELDS, load_simulation, no_objects
from mimics_app.rendering.haptic.objects import new_object_work
from mimics_app.rendering.haptic.replay_loop import replay_recorded

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.object_statics import ObjectStatics

__all__ = ["Replayed", "replay_run"]


_TICKS_AT_ONCE = 500
_EVENTS = 1 << 16
"""Capacity of the event ring: a power of two, and more than any scene makes in _TICKS_AT_ONCE ticks; that of the
forces holds `FOLLOWED_AT_ONCE` a tick."""


@dataclass(frozen=True, slots=True)
class Replayed:
    """Result of a replay.

    Attributes:
        samples: Samples of the dtype of the inputs, shape [n], with timing fields 0.
        events: EVENT records, shape [m], in order.
        snapshots: Newest snapshot after each requested tick, by tick.
        forces: CONTACT_FORCE records of the followed contacts, shape [k], in order; tick 0 is at time 0.
    """

    samples: Records
    events: Records
    snapshots: dict[int, HapticSnapshot] = field(default_factory=dict)
    forces: Records = field(default_factory=lambda: np.zeros(0, CONTACT_FORCE))


def replay_run(
    inputs: Records,
    scenes: Mapping[int, Records],
    rows: Mapping[int, Rows] | None = None,
    statics: ObjectStatics | None = None,
    *,
    kinematics: Kinematics = HAPTICMASTER.kinematics,
    period_ns: int = 1_000_000,
    seen: Sequence[int] = (),
) -> Replayed:
    """Simulate recorded inputs again; the result is bit-equal except for the timing fields.

    Args:
        inputs: Samples of the device (`loop_fields.sample_dtype`) from tick 0 on, shape [n].
        scenes: SCENE record (a record, or an array of shape [1]) by sequence number.
        rows: Tables of objects by sequence number; None where there are no objects.
        statics: Meshes, paths and force fields of the objects; None where there are none.
        kinematics: Kinematics functions of the recorded device.
        period_ns: Tick [ns].
        seen: Ticks after which a snapshot is kept; those beyond the inputs are ignored.

    Raises:
        KeyError: An input has a sequence that is not in `scenes` (0, before the first block, is known), or `rows` lacks
            objects that a block counts.
        ValueError: The blocks have different controllers in one slot.
        UsageError: A controller is not installed.
    """
    numbers = sorted({int(sequence) for sequence in np.unique(inputs["sequence"])})
    blocks = _blocks_of(scenes, numbers)
    capacities = _room_for(blocks, 1 if statics is None else max(1, len(statics.paths)))
    stack = _stack_of(rows or {}, numbers, blocks, capacities)
    which = np.searchsorted(np.array(numbers, np.int64), inputs["sequence"].astype(np.int64)).astype(np.int64)
    memory = SessionMemory(Capacities(capacities, samples=1, events=_EVENTS, lateness_bins=1))
    channels = channels_of(memory)
    controllers = controllers_of(_names_of(blocks))
    work = new_work(new_object_work(capacities) if statics is None else statics.work(capacities))
    set_controllers(work.state, controllers)
    simulate = load_simulation() if any(has_objects(block["objects"]) for block in blocks) else no_objects
    fields = NO_FIELDS if statics is None else statics.functions()
    kin = tuple(kinematics)
    outputs = np.zeros(inputs.shape[0], inputs.dtype)
    events: list[Records] = []
    forces: list[Records] = []
    taken, taken_forces = np.zeros(_EVENTS, EVENT), np.zeros(len(memory.audio_forces), CONTACT_FORCE)
    snapshots: dict[int, HapticSnapshot] = {}
    looked = {tick for tick in seen if 0 <= tick < len(inputs)}
    for part in _parts(len(inputs), looked):
        recorded = _whole(inputs[part])
        replayed = np.zeros(len(recorded), SAMPLE)
        replay_recorded(
            channels,
            work,
            blocks,
            stack,
            which[part],
            recorded,
            tick,
            simulate,
            fields,
            kin,
            period_ns,
            replayed,
        )
        outputs[part] = _like(replayed, inputs.dtype)
        events.append(_drained(memory.recorder_event_words, memory.recorder_events, taken))
        forces.append(_drained(memory.audio_force_words, memory.audio_forces, taken_forces))
        if part.stop - 1 in looked:
            device = blocks[-1]
            snapshots[part.stop - 1] = newest_snapshot(memory, int(device["joints"]), int(device["contacts"]))
    return Replayed(
        outputs,
        np.concatenate([taken[:0], *events]),
        snapshots,
        np.concatenate([taken_forces[:0], *forces]),
    )


def _whole(samples: Records) -> Records:
    """Return samples of a device as SAMPLE records, of MAX_CONTACTS points; those that it does not have are zero."""
    whole = np.zeros(len(samples), SAMPLE)
    own = samples.dtype.itemsize // 8
    whole.view(np.float64).reshape(len(samples), -1)[:, :own] = _numbers(samples)
    return whole


def _like(whole: Records, dtype: np.dtype[Any]) -> Records:
    """Return SAMPLE records as samples with fewer points of contact."""
    kept = np.ascontiguousarray(_numbers(whole)[:, : dtype.itemsize // 8])
    return kept.view(dtype).reshape(-1)


def _numbers(samples: Records) -> NDArray[np.float64]:
    """Return samples [n] as float64 rows."""
    return np.ascontiguousarray(samples).view(np.float64).reshape(len(samples), samples.dtype.itemsize // 8)


def _blocks_of(scenes: Mapping[int, Records], numbers: Sequence[int]) -> Records:
    """Return the SCENE blocks of sequence numbers in order; zeros for 0, before the first block."""
    blocks = np.zeros(len(numbers), SCENE)
    for i, number in enumerate(numbers):
        if number != 0:
            blocks[i] = np.asarray(scenes[number]).reshape(-1)[0]
    return blocks


def _names_of(blocks: Records) -> list[str]:
    """Return the names of the controllers by slot."""
    names = []
    for slot, found in enumerate(zip(*(names_in(block["controller_names"]) for block in blocks), strict=True)):
        known = set(found) - {""}
        if len(known) > 1:
            raise ValueError(f"slot {slot} has the controllers {', '.join(sorted(known))}; a session keeps one in each")
        names.append(known.pop() if known else "")
    return names


def _stack_of(rows: Mapping[int, Rows], numbers: Sequence[int], blocks: Records, capacities: ObjectCapacities) -> Rows:
    """Return the tables of objects of each block."""
    stack = new_rows(capacities, len(numbers))
    for i, number in enumerate(numbers):
        if any(count_rows(blocks[i]["objects"]).values()):
            slot_of(stack, i, rows[number], blocks[i]["objects"])
    return stack


def _parts(ticks: int, looked: set[int]) -> list[slice]:
    """Split the ticks into chunks that end after each observed tick and whose events fit the ring."""
    ends = sorted({*range(_TICKS_AT_ONCE, ticks, _TICKS_AT_ONCE), *(tick + 1 for tick in looked), ticks} - {0})
    return [slice(start, end) for start, end in zip([0, *ends], ends, strict=False)]


def _drained(words: Words, records: Records, block: Records) -> Records:
    """Return what a ring holds, taken through the scratch array `block`, which holds a full ring."""
    return block[: ring.drain(words, records, block)].copy()


def _room_for(blocks: Records, paths: int) -> ObjectCapacities:
    """Return capacities that hold the rows of every block."""
    most = {name: max(1, int(blocks["objects"][name].max())) for name in Rows._fields}
    return ObjectCapacities(**most, paths=paths)
