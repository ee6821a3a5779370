"""Cost of a tick by the number of points of contact, each pressed into a box of its own.

The device has two straight joints for each point, along x and along z, and follows their velocities; a constant force
presses every point on the top of its box. Devices of one, two and four points are measured in turn, in processor
time, so that a busy machine changes no ratio.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import process_seconds
from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.device_descriptor import KINEMATICS, DeviceDescriptor, Joint, Kinematics
from mimics_app.contracts.loop.haptic import INBOX, SAMPLE
from mimics_app.contracts.loop.haptic_objects import OBJECT_COUNTS, STATIC, ShapeKind
from mimics_app.contracts.loop.loop_fields import point_rows
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    DATA_DQ,
    DATA_FORCE,
    DATA_Q,
    READ,
    WRITE,
    DevicePlugin,
)
from mimics_app.contracts.loop.object_rows import ObjectCapacities, new_rows
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.session_memory import Capacities, SessionMemory
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.rendering.haptic.objects import new_object_work
from mimics_app.rendering.haptic.scene_block import scene_from_components
from mimics_app.world.components.robot import Robot

__all__ = ["PointsRow", "measure_points"]

_NAMES = ("thumb", "index", "middle", "palm")
_COUNTS = (1, 2, 4)
_APART = 0.1
"""Distance of the rails, and of the boxes [m]."""
_EDGE, _FORCE = 0.06, 2.0
"""Edge of a box [m]; force on each point [N]."""
_STIFFNESS, _DAMPING = 800.0, 8.0
_TICKS, _ROUNDS = 2000, 12
_WARM_UP = 9
"""Rounds before the first that counts: the points come to rest, and all memory of the ring is used once."""
_DT = 1e-3
_STATES = 4
"""Numbers in the memory of the device for each point: places and velocities of its two joints."""


@typed_kernel(KINEMATICS)
def _place_points(geometry: F8, q: F8, given: F8, out: F8) -> int:
    n = int(geometry[0])
    for c in range(n):
        out[3 * c], out[3 * c + 1], out[3 * c + 2] = q[2 * c], _APART * c, q[2 * c + 1]
    return 0


@typed_kernel(KINEMATICS)
def _by_joint(geometry: F8, q: F8, given: F8, out: F8) -> int:
    n = int(geometry[0])
    for i in range(3 * n * 2 * n):
        out[i] = 0.0
    for c in range(n):
        out[(3 * c) * 2 * n + 2 * c] = 1.0
        out[(3 * c + 2) * 2 * n + 2 * c + 1] = 1.0
    return 0


@typed_kernel(READ)
def _read(memory: F8, inbox: F8, data: F8, tick: int) -> int:
    n = (memory.shape[0] // _STATES) * 2
    for j in range(n):
        memory[j] += _DT * memory[n + j]
        data[DATA_Q + j], data[DATA_DQ + j] = memory[j], memory[n + j]
    for c in range(n // 2):
        data[DATA_FORCE + 3 * c + 2] = -_FORCE
    return 0


@typed_kernel(WRITE)
def _write(memory: F8, command: F8, tick: int) -> int:
    n = (memory.shape[0] // _STATES) * 2
    for j in range(n):
        memory[n + j] = command[COMMAND_DQ + j] if command[COMMAND_ENABLED] != 0.0 else 0.0
    return 0


@dataclass(frozen=True)
class PointsRow:
    """Cost of a tick.

    Attributes:
        n: Number of points of contact.
        us: Processor time of a tick [us], the median of the rounds.
        of_one_point: Cost relative to that of one point, the median of the rounds.
    """

    n: int
    us: float
    of_one_point: float


class _Rails:
    """A loop with a device of `n` points, at rest on their boxes."""

    def __init__(self, n: int) -> None:
        rail = Joint("rail", "m", -0.3, 0.3, 1.0, 20.0, inertia=1.0)
        descriptor = DeviceDescriptor(
            (rail,) * (2 * n), _NAMES[:n], Kinematics(_place_points, _by_joint), lambda _: (float(n),)
        )
        plugin = DevicePlugin("rails", _read, _write, np.zeros(_STATES * n), simulated=True, descriptor=descriptor)
        room = ObjectCapacities(shapes=n)
        self._memory = SessionMemory(Capacities(objects=room, extent=descriptor.extent))
        self._engine = HapticEngine(self._memory, plugin, objects=new_object_work(room))
        block, rows = scene_from_components(Robot(), descriptor=descriptor), new_rows(room)
        R, origin = block[0]["R_world_from_robot"], block[0]["origin_world"]
        for c in range(n):
            shape = rows.shapes[c]
            shape["enabled"], shape["kind"], shape["body"], shape["exponent"] = 1, ShapeKind.BOX, STATIC, 1.0
            shape["orientation"][3], shape["size"] = 1.0, (_EDGE,) * 3
            shape["stiffness"], shape["damping"] = _STIFFNESS, _DAMPING
            shape["position"] = R @ np.array([0.0, _APART * c, -0.5 * _EDGE - 0.005]) + origin
            rows.points[c]["enabled"], rows.points[c]["contact"] = 1, c
        counts = np.zeros(1, OBJECT_COUNTS)
        counts["shapes"], counts["points"] = n, n
        block["objects"], block["controller"] = counts, Slot.PERSON
        self._engine.publish(block, rows)
        inbox = np.zeros(1, INBOX)
        inbox["active"] = 1
        self._engine.send(inbox)
        self._rows: NDArray[np.void] = np.zeros(len(self._memory.samples), SAMPLE)
        self._count = 0

    def run_us(self) -> float:
        """Run ticks; return the processor time of one [us]."""
        started = process_seconds()
        self._engine.advance(_TICKS)
        us = (process_seconds() - started) * 1e6 / _TICKS
        self._count = ring.drain(self._memory.sample_words, self._memory.samples, self._rows)
        self._engine.events()
        return us

    @property
    def pressed(self) -> int:
        """Number of points that pressed on something in every one of the last ticks."""
        samples = self._rows[: self._count]
        n = int(self._memory.capacities.extent.contacts)
        return sum(bool((point_rows(samples, c)["touching"] > 0.0).all()) for c in range(n))


def measure_points() -> list[PointsRow]:
    """Return the cost of a tick with one, two and four points of contact, measured in turn.

    Raises:
        RuntimeError: A point does not touch its box, so that its contact would not be measured.
    """
    rails = {n: _Rails(n) for n in _COUNTS}
    for each in rails.values():
        for _ in range(_WARM_UP):
            each.run_us()
    rounds = [{n: each.run_us() for n, each in rails.items()} for _ in range(_ROUNDS)]
    for n, each in rails.items():
        if each.pressed != n:
            raise RuntimeError(f"{each.pressed} of {n} points of contact touch their boxes")
    return [
        PointsRow(
            n,
            float(np.median([each[n] for each in rounds])),
            float(np.median([each[n] / each[1] for each in rounds])),
        )
        for n in _COUNTS
    ]
