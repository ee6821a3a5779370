"""Emulated robots that exchange frames: on a pseudo-terminal or by UDP, with a simulated robot and person.

It advances in steps of 1 ms that the caller makes, so that tests are deterministic; `serve` of the command makes one
per millisecond. The number of bytes per step is limited by the baud rate that the program has set on the line.
"""

from __future__ import annotations

import os
import socket
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_ENABLED,
    COMMAND_LENGTH,
    DATA_LENGTH,
    INBOX_LENGTH,
    DevicePlugin,
)
from mimics_app.rendering.haptic.devices.emulators.faults import Faults
from mimics_app.rendering.haptic.devices.serial_frames import (
    ASK,
    COMMAND,
    COMMAND_PAYLOAD,
    END,
    INFO,
    INFO_PAYLOAD,
    LAST_SEQUENCE,
    LEG_COMMAND,
    LEG_COMMAND_PAYLOAD,
    LEG_PROTOCOL,
    LEG_STATE,
    LEG_STATE_PAYLOAD,
    LINE_LENGTH,
    PROTOCOL,
    SCREEN,
    SCREEN_PAYLOAD,
    STATE,
    STATE_PAYLOAD,
    accept_sequence,
    make_room,
    next_frame,
    reset_line,
    seal_frame,
    word_at,
)
from mimics_app.rendering.haptic.devices.serial_payloads import (
    FRAME_PLACES,
    PAYLOAD_PLACES,
    ROBOT_NOT_HOMED,
    ROBOT_READY,
    fetch_payload,
    pack_leg_state,
    pack_state,
    unpack_command,
    unpack_leg_command,
    unpack_screen,
)
from mimics_app.rendering.haptic.devices.serial_port import RobotInfo, info_payload

__all__ = ["LEG_FRAMES", "WATCHDOG", "Frames", "SerialRobotEmulator", "UdpRobotEmulator"]

WATCHDOG = 50
"""Watchdog: steps without a command after which the robot disables its drives."""


class Frames(NamedTuple):
    """Frames of a protocol as the robot's side uses them.

    Attributes:
        protocol: Version, sent in INFO.
        command: Kind of a command.
        command_payload: Length of its payload.
        unpack: Unpacks it: payload, command vector.
        state: Kind of a state.
        state_payload: Length of its payload.
        pack: Packs it: data vector, status, payload.
        watchdog: Steps without a command after which the robot disables its drives.
    """

    protocol: int
    command: int
    command_payload: int
    unpack: Callable[[Vec, Vec], None]
    state: int
    state_payload: int
    pack: Callable[[Vec, int, Vec], None]
    watchdog: int


_HANDLE_FRAMES = Frames(PROTOCOL, COMMAND, COMMAND_PAYLOAD, unpack_command, STATE, STATE_PAYLOAD, pack_state, WATCHDOG)

LEG_FRAMES = Frames(
    LEG_PROTOCOL, LEG_COMMAND, LEG_COMMAND_PAYLOAD, unpack_leg_command, LEG_STATE, LEG_STATE_PAYLOAD, pack_leg_state, 10
)
"""Of the gait orthosis, whose brakes close after 10 ms without a command: a leg swings far in 50."""

_BUFFER = 4096
_STEP_S = 1e-3
_UNSET_BAUD = 115200

_HERE = "127.0.0.1"
_DATAGRAM = 512
"""Longest datagram that is received [bytes]."""


@cache
def _speeds() -> dict[int, int]:
    """Return bits per second by termios speed constant."""
    import termios

    names = [name for name in dir(termios) if name.startswith("B") and name[1:].isdecimal()]
    return {getattr(termios, name): int(name[1:]) for name in names}


def _speed_of(terminal: int) -> int:
    """Return the bits per second set on a terminal, given either end."""
    import termios

    return max(300, _speeds().get(termios.tcgetattr(terminal)[5], _UNSET_BAUD))


class SerialRobotEmulator:
    """A robot on a pseudo-terminal.

    Attributes:
        faults: Present faults of the line.
        tick: Steps done.
        commands: Number of commands accepted.
        command: The newest command, shape [COMMAND_LENGTH].
        plugin: The simulated robot.

    Args:
        plugin: Simulated robot and person, at 1000 ticks per second.
        link: Symbolic link to the current terminal, which changes when the robot is plugged in again.
        seed: Seed of lost and random bytes.
        frames: Frames of its protocol.
    """

    def __init__(self, plugin: DevicePlugin, link: Path, seed: int = 0, frames: Frames = _HANDLE_FRAMES) -> None:
        self.frames = frames
        self.faults = Faults()
        self.tick = 0
        self.commands = 0
        self.command = np.zeros(COMMAND_LENGTH)
        self.plugin = plugin
        self._link = link
        self._random = np.random.default_rng(seed)
        self._info = RobotInfo(plugin.name[:16], plugin.delay, wants_screen=True)
        self._data, self._inbox = np.zeros(DATA_LENGTH), np.zeros(INBOX_LENGTH)
        self._line, self._screens = np.zeros(LINE_LENGTH), np.zeros(LINE_LENGTH)
        self._buffer = np.zeros(_BUFFER, np.uint8)
        self._payload, self._frame = np.zeros(PAYLOAD_PLACES), np.zeros(FRAME_PLACES)
        self._leaving = b""
        self._credit_in = self._credit_out = 0.0
        self._sequence = 0
        self._received_at = -frames.watchdog
        self._master = self._slave = -1
        self._plug()

    @property
    def address(self) -> str:
        """Address of the device `serial:`; of the gait orthosis with the kind of its line before it."""
        return f"serial:{self._link}" if self.frames.protocol == LEG_PROTOCOL else str(self._link)

    @property
    def data(self) -> np.ndarray:
        """Sensor data, shape [DATA_LENGTH]."""
        return self._data

    def step(self) -> None:
        """Advance by one millisecond: receive, move, send the state."""
        if self.faults.plugged != (self._master >= 0):
            self._plug() if self.faults.plugged else self._unplug()
        rate = self._bytes_per_step()
        if self._master >= 0:
            self._receive(rate)
        silent = self.tick - self._received_at > self.frames.watchdog
        if silent:
            self.command[:] = 0.0
        status = self.plugin.read(self.plugin.memory, self._inbox, self._data, self.tick)
        self.plugin.write(self.plugin.memory, self.command, self.tick)
        if self._master >= 0:
            self._send_state(rate, ROBOT_READY if status == 0 else ROBOT_NOT_HOMED)
        self.tick += 1

    def rehearse(self) -> None:
        """Run every code path once, so that nothing is compiled later in real time."""
        own = self.frames
        kinds = {own.command: own.command_payload, SCREEN: SCREEN_PAYLOAD, own.state: own.state_payload}
        for kind, length in kinds.items():
            frame = np.frombuffer(self._sealed(kind, 1, length), np.uint8)
            self._buffer[: len(frame)] = frame
            self._line[END] = len(frame)
            self._obey(next_frame(self._line, self._buffer))
            make_room(self._line, self._buffer)
        own.pack(self._data, ROBOT_READY, self._payload)
        for memory in (self._line, self._screens, self._inbox, self.command):
            memory[:] = 0.0
        self.commands, self._received_at = 0, -own.watchdog

    def greet(self) -> None:
        """Answer without motion, while a program starts."""
        if self._master >= 0:
            self._receive(float(_BUFFER))
            self._flush(float(_BUFFER))

    def close(self) -> None:
        """Close the terminal and remove the link."""
        self._unplug()
        self.plugin.close()

    def _plug(self) -> None:
        import tty

        self._master, self._slave = os.openpty()
        os.fchmod(self._slave, 0o600)  # by default its group may write to it
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self._link.unlink(missing_ok=True)
        self._link.symlink_to(os.ttyname(self._slave))
        reset_line(self._line)
        reset_line(self._screens)
        self._leaving = b""

    def _unplug(self) -> None:
        if self._master >= 0:
            os.close(self._master)
            os.close(self._slave)
            self._link.unlink(missing_ok=True)
            self._master = self._slave = -1

    def _bytes_per_step(self) -> float:
        """Return the bytes per step at the baud rate of the line."""
        if self._master < 0:
            return 0.0
        return _speed_of(self._master) / 10 * _STEP_S

    def _receive(self, rate: float) -> None:
        self._credit_in = min(self._credit_in + rate, max(rate, 1.0) + 1.0)
        start = make_room(self._line, self._buffer)
        count = min(int(self._credit_in), _BUFFER - start)
        got = b""
        with suppress(OSError):  # no bytes, or the other end is closed
            got = self._read(count)
        self._credit_in -= len(got)
        got = b"" if self.faults.deaf else got
        self._buffer[start : start + len(got)] = np.frombuffer(got, np.uint8)
        self._line[END] = start + len(got)
        while (frame := next_frame(self._line, self._buffer)) >= 0:
            self._obey(frame)

    def _obey(self, frame: int) -> None:
        kind, length, own = int(self._buffer[frame + 3]), int(self._buffer[frame + 2]), self.frames
        sequence = word_at(self._buffer, frame + 4)
        fetch_payload(self._buffer, frame, self._payload)
        ordered = kind == own.command and length == own.command_payload
        if ordered and accept_sequence(self._line, sequence, self.tick):
            own.unpack(self._payload, self.command)
            self._received_at = self.tick
            self.commands += 1
        elif kind == SCREEN and length == SCREEN_PAYLOAD and accept_sequence(self._screens, sequence, self.tick):
            unpack_screen(self._payload, self._inbox)
        elif kind == ASK:
            self._frame.view(np.uint8)[8 : 8 + INFO_PAYLOAD] = np.frombuffer(
                info_payload(self._info, own.protocol), np.uint8
            )
            self._leaving += self._sealed(INFO, 0, INFO_PAYLOAD)

    def _send_state(self, rate: float, status: int) -> None:
        if not self._leaving:  # sampled when the line is free, so that no state waits and ages
            self._sequence += 1
            self.frames.pack(self._data, status, self._frame[1 : 1 + PAYLOAD_PLACES])
            self._leaving = self._sealed(self.frames.state, self._sequence, self.frames.state_payload)
        self._flush(rate)

    def _sealed(self, kind: int, sequence: int, length: int) -> bytes:
        frame = self._frame.view(np.uint8)
        total = seal_frame(frame, kind, sequence, int(self._line[LAST_SEQUENCE]), length)
        return frame[:total].tobytes()

    def _flush(self, rate: float) -> None:
        self._credit_out += rate
        leaves, self._leaving = self._leaving[: int(self._credit_out)], self._leaving[int(self._credit_out) :]
        self._credit_out -= len(leaves)
        if not self._leaving:
            self._credit_out = min(self._credit_out, 1.0)
        with suppress(OSError):  # no reader: the bytes are lost, as on a wire
            self._write(self.faults.spoil(leaves, self._random))

    def _read(self, count: int) -> bytes:
        return os.read(self._master, count)

    def _write(self, sent: bytes) -> None:
        os.write(self._master, sent)

    @property
    def is_limp(self) -> bool:
        """Whether the drives are disabled."""
        return self.command[COMMAND_ENABLED] == 0.0


class UdpRobotEmulator(SerialRobotEmulator):
    """The same robot at a UDP port of this machine: it answers whoever sent the last datagram.

    Args:
        plugin: Simulated robot and person, at 1000 ticks per second.
        port: Port; 0: any free one.
        seed: Seed of lost and random bytes.
        frames: Frames of its protocol.
    """

    def __init__(self, plugin: DevicePlugin, port: int = 0, seed: int = 0, frames: Frames = _HANDLE_FRAMES) -> None:
        self._port = port
        self._socket: socket.socket | None = None
        self._client: tuple[str, int] | None = None
        super().__init__(plugin, Path(), seed, frames)

    @property
    def address(self) -> str:
        """udp:HOST:PORT."""
        return f"udp:{_HERE}:{self._port}"

    def _plug(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self._socket.bind((_HERE, self._port))
        self._port = self._socket.getsockname()[1]
        self._master, self._client = self._socket.fileno(), None
        reset_line(self._line)
        reset_line(self._screens)
        self._leaving = b""

    def _unplug(self) -> None:
        if self._socket is not None:
            self._socket.close()
        self._socket, self._master = None, -1

    def _bytes_per_step(self) -> float:
        return float(_BUFFER)

    def _read(self, count: int) -> bytes:
        """Return the datagrams that have come, in order, within `count` bytes."""
        got = b""
        with suppress(OSError):
            while self._socket is not None and len(got) + _DATAGRAM <= count:
                datagram, self._client = self._socket.recvfrom(_DATAGRAM)
                got += datagram
        return got

    def _write(self, sent: bytes) -> None:
        if self._socket is not None and self._client is not None and sent:
            self._socket.sendto(sent, self._client)
