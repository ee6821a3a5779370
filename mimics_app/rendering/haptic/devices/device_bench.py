"""Device bench: runs a device tick by tick without the haptic loop, for the conformance kit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numba import types
from numpy.typing import NDArray

from mimics_app.compiled.atomics import now_ns
from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    COMMAND_FORCE,
    COMMAND_LENGTH,
    COMMAND_STATE,
    COMMAND_TORQUE,
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DELAY,
    DATA_DQ,
    DATA_FORCE,
    DATA_GRASP,
    DATA_LENGTH,
    DATA_Q,
    INBOX_LENGTH,
    READ,
    WRITE,
    DevicePlugin,
)
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Read, Write

__all__ = ["DeviceBench", "OtherSide", "Track"]


_MATRIX = types.float64[:, ::1]


@typed_kernel(
    types.int64(
        types.FunctionType(READ),
        types.FunctionType(WRITE),
        types.float64[::1],
        types.float64[::1],
        types.float64[::1],
        _MATRIX,
        _MATRIX,
        types.int64[::1],
        types.int64,
    )
)
def _run_ticks(
    read: Read,
    write: Write,
    memory: Vec,
    inbox: Vec,
    data: Vec,
    commands: NDArray[np.float64],
    rows: NDArray[np.float64],
    timespec: NDArray[np.int64],
    first: int,
) -> int:
    """Call read and write once per row of commands, as the loop does.

    Args:
        read: Read function of the device.
        write: Write function of the device.
        memory: Memory of the device.
        inbox: Inbox vector, shape [INBOX_LENGTH].
        data: Data vector, shape [DATA_LENGTH].
        commands: Command vectors, shape [n, COMMAND_LENGTH].
        rows: Out: data, status, return value of write, and duration of both calls [ns]; shape [n, DATA_LENGTH + 3].
        timespec: Scratch, shape [2].
        first: Number of the first tick.

    Returns:
        Ticks done.
    """
    for k in range(commands.shape[0]):
        begun = now_ns(timespec)
        rows[k, DATA_LENGTH] = read(memory, inbox, data, first + k)
        rows[k, DATA_LENGTH + 1] = write(memory, commands[k], first + k)
        rows[k, DATA_LENGTH + 2] = now_ns(timespec) - begun
        for i in range(DATA_LENGTH):
            rows[k, i] = data[i]
    return commands.shape[0]


class OtherSide(Protocol):
    """Remote side of a device outside this process, advanced tick by tick, optionally with faults on command."""

    @property
    def can_fail(self) -> bool:
        """Whether `spoil` can inject faults."""

    def step(self) -> None:
        """Advance by one tick."""

    def spoil(self, what: str) -> None:
        """Apply an order such as "silence", "garbage 40", "drop 0.05", "unplug", "plug" (emulators.faults)."""


@dataclass(frozen=True, slots=True)
class Track:
    """Data of a device over some ticks.

    Attributes:
        data: Data vectors, shape [n, DATA_LENGTH].
        status: DeviceStatus of each read, shape [n].
        refused: Return value of each write, shape [n].
        spent_ns: Duration of read and write [ns], shape [n].
        first: Number of the first tick.
        joints: Number of joints of the device.
    """

    data: NDArray[np.float64]
    status: NDArray[np.int64]
    refused: NDArray[np.int64]
    spent_ns: NDArray[np.float64]
    first: int
    joints: int = 3

    @property
    def fresh(self) -> NDArray[np.float64]:
        """Rows with fresh data, shape [m, DATA_LENGTH]."""
        return self.data[self.status == 0]

    @property
    def q(self) -> NDArray[np.float64]:
        """Joints of the fresh rows [m or rad], shape [m, joints]."""
        return self.fresh[:, DATA_Q : DATA_Q + self.joints]

    @property
    def dq(self) -> NDArray[np.float64]:
        """Joint velocities of the fresh rows."""
        return self.fresh[:, DATA_DQ : DATA_DQ + self.joints]

    @property
    def force(self) -> NDArray[np.float64]:
        """Measured forces and torques of the fresh rows [N, N m]."""
        return self.fresh[:, DATA_FORCE:DATA_GRASP]

    @property
    def grasp(self) -> Vec:
        """Grasp force of the fresh rows [N]."""
        return self.fresh[:, DATA_GRASP]

    @property
    def buttons(self) -> Vec:
        """Buttons of the fresh rows."""
        return self.fresh[:, DATA_BUTTONS]

    @property
    def age(self) -> Vec:
        """Age of the fresh rows [s]."""
        return self.fresh[:, DATA_AGE]

    @property
    def delay(self) -> Vec:
        """Measured delay of the fresh rows [s]."""
        return self.fresh[:, DATA_DELAY]

    @property
    def ticks(self) -> NDArray[np.int64]:
        """Numbers of the ticks with fresh rows."""
        return self.first + np.flatnonzero(self.status == 0)


class DeviceBench:
    """A device on the bench.

    Args:
        plugin: The device.
        other_side: Its remote side; None for a device inside this process.
        configure: Builds the device again after it was cleaned up; None where nothing here can.
    """

    def __init__(
        self,
        plugin: DevicePlugin,
        other_side: OtherSide | None = None,
        configure: Callable[[], DevicePlugin] | None = None,
    ) -> None:
        self.plugin = plugin
        self.configure = configure
        self.descriptor = plugin.descriptor or HAPTICMASTER
        self.joints = len(self.descriptor.joints)
        self.other_side = other_side
        self.inbox = np.zeros(INBOX_LENGTH)
        self.tick = 0
        self._data = np.zeros(DATA_LENGTH)
        self._timespec = np.zeros(2, np.int64)

    def run(self, ticks: int, command: Vec | None = None) -> Track:
        """Run ticks under one command (None: enabled, at rest).

        Raises:
            DeviceError: The device's functions do not have the loop's signatures.
        """
        row = self.command() if command is None else command
        commands = np.ascontiguousarray(np.tile(row, (ticks, 1)))
        rows = np.zeros((ticks, DATA_LENGTH + 3))
        first = self.tick
        if self.other_side is None:
            self._run(commands, rows)
        else:
            for k in range(ticks):
                self._run(commands[k : k + 1], rows[k : k + 1])
                self.other_side.step()
        status, refused = rows[:, DATA_LENGTH].astype(np.int64), rows[:, DATA_LENGTH + 1].astype(np.int64)
        return Track(rows[:, :DATA_LENGTH], status, refused, rows[:, DATA_LENGTH + 2], first, self.joints)

    def spoil(self, what: str) -> None:
        """Inject a fault at the remote side."""
        if self.other_side is not None:
            self.other_side.spoil(what)

    @staticmethod
    def command(
        dq: tuple[float, ...] = (),
        force: tuple[float, ...] = (),
        torque: tuple[float, ...] = (),
        *,
        enabled: bool = True,
        state: SafetyState = SafetyState.HOMED,
    ) -> Vec:
        """Return a command vector: joint velocities [m/s, rad/s], force on the first point [N], torques [N, N m]."""
        vector = np.zeros(COMMAND_LENGTH)
        vector[COMMAND_DQ : COMMAND_DQ + len(dq)] = dq
        vector[COMMAND_FORCE : COMMAND_FORCE + len(force)] = force
        vector[COMMAND_TORQUE : COMMAND_TORQUE + len(torque)] = torque
        vector[COMMAND_ENABLED] = float(enabled)
        vector[COMMAND_STATE] = float(state)
        return vector

    def _run(self, commands: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
        plugin = self.plugin
        try:
            _run_ticks(
                plugin.read,
                plugin.write,
                plugin.memory,
                self.inbox,
                self._data,
                commands,
                rows,
                self._timespec,
                self.tick,
            )
        except TypeError as failure:
            raise DeviceError(f"read, write or memory do not have the loop's types: {failure}") from failure
        self.tick += commands.shape[0]
