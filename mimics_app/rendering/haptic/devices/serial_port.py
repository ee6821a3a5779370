"""Connection to a robot that exchanges frames, on a serial line or by UDP: the main thread's side."""

from __future__ import annotations

import errno
import os
import select
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.devices import serial_robot
from mimics_app.rendering.haptic.devices.address import port_and_baud
from mimics_app.rendering.haptic.devices.device_search import no_port
from mimics_app.rendering.haptic.devices.link import LinkSupervisor
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.serial_frames import (
    ASK,
    BITS_PER_BYTE,
    HEADER,
    INFO,
    INFO_PAYLOAD,
    LEG_PROTOCOL,
    LINE_LENGTH,
    MAX_PAYLOAD,
    OVERHEAD,
    PROTOCOL,
    next_frame,
    seal_frame,
)

__all__ = ["FrameLine", "RobotInfo", "build_serial", "info_payload", "link_robot", "serial_line"]

_PATIENCE_NS = 1_500_000_000
"""Time-out of the identification [ns]."""

_ASK_AGAIN_NS = 200_000_000
"""Time between two identification requests [ns]."""

_WANTS_SCREEN = 1
"""Bit of the flags of an INFO frame."""


@dataclass(frozen=True, slots=True)
class RobotInfo:
    """Identification of a robot.

    Attributes:
        name: Up to 16 ASCII characters.
        delay: Delay from the arrival of a command to its motion [s].
        wants_screen: True for a simulated person on the robot, who needs SCREEN frames.
    """

    name: str
    delay: float
    wants_screen: bool


class FrameLine(NamedTuple):
    """Line on which frames are exchanged.

    Attributes:
        name: Of its other end in messages.
        bytes_per_second: Its capacity.
        open: Opens it; returns an object with a non-blocking descriptor, `fileno`, and `close`.
    """

    name: str
    bytes_per_second: float
    open: Callable[[], Any]


def info_payload(info: RobotInfo, protocol: int = PROTOCOL) -> bytes:
    """Return the payload of an INFO frame: protocol, flags, delay [us] (u16), rate [Hz] (u16), name."""
    head = bytes([protocol, _WANTS_SCREEN if info.wants_screen else 0])
    delay = round(info.delay * 1e6).to_bytes(2, "little")
    return head + delay + (1000).to_bytes(2, "little") + info.name.encode("ascii")[:16].ljust(16, b"\0")


def _parse_info(payload: bytes, protocol: int) -> RobotInfo:
    """Parse the payload of an INFO frame.

    Raises:
        DeviceError: The robot has another version of the protocol.
    """
    if payload[0] != protocol:
        what = f"the robot has protocol {payload[0]}, this device {protocol}"
        raise DeviceError(what, "update one of them, or name the device that the robot is")
    name = payload[6:22].rstrip(b"\0").decode("ascii", "replace")
    return RobotInfo(name, int.from_bytes(payload[2:4], "little") * 1e-6, bool(payload[1] & _WANTS_SCREEN))


def build_serial(request: DeviceRequest) -> DevicePlugin:
    """Build the device of a robot on a serial line, which must answer.

    Raises:
        DeviceError: No such port, or no robot of this protocol answers.
    """
    memory, supervisor = link_robot(serial_line(request.address), request.rate)
    return DevicePlugin(
        "serial",
        serial_robot.read_serial,
        serial_robot.write_serial,
        memory,
        supervisor.close,
        delay=float(memory[serial_robot.OWN_DELAY]),
        real_time=True,
        trouble=supervisor.trouble,
    )


def serial_line(address: str) -> FrameLine:
    """Return the line of PORT[@BAUD].

    Raises:
        DeviceError: No port, or a speed that is not a positive integer.
    """
    port, baud = port_and_baud(address)
    return FrameLine(port, baud / BITS_PER_BYTE, lambda: _open_port(port, baud))


def link_robot(line: FrameLine, rate: int, protocol: int = PROTOCOL) -> tuple[Vec, LinkSupervisor]:
    """Open a line to a robot, which must answer.

    Args:
        line: The line.
        rate: Ticks per second.
        protocol: Version that the robot must have; LEG_PROTOCOL makes commands and states those of the gait orthosis.

    Returns:
        Memory of `read_serial` and `write_serial`, and what reopens the line.

    Raises:
        DeviceError: The line cannot be opened, or no robot of this protocol answers.
    """
    memory = np.zeros(serial_robot.SERIAL_LENGTH)
    memory[serial_robot.TICK] = 1.0 / rate
    memory[serial_robot.BYTES_PER_TICK] = line.bytes_per_second / rate
    memory[serial_robot.LEGS] = float(protocol == LEG_PROTOCOL)

    def open_line() -> tuple[int, Callable[[], None]]:
        opened = line.open()
        try:
            info = _greet(opened.fileno(), line.name, protocol)
        except DeviceError:
            opened.close()
            raise
        memory[serial_robot.OWN_DELAY] = info.delay
        memory[serial_robot.SCREEN_WANTED] = float(info.wants_screen)
        return opened.fileno(), opened.close

    return memory, LinkSupervisor(memory, open_line, f"the robot at {line.name}")


_REASONS = {errno.ENOENT: "nothing is there", errno.EAGAIN: "another program uses it"}
"""Why a line cannot be opened, by the number of the error."""


def _open_port(port: str, baud: int) -> Any:
    """Open the line, raw and non-blocking."""
    import serial

    try:
        line = serial.Serial(port, baud, timeout=0, exclusive=True)
    except (OSError, ValueError) as failure:  # SerialException is an OSError
        raise no_port(port, _REASONS.get(getattr(failure, "errno", None) or 0, str(failure))) from failure
    os.set_blocking(line.fileno(), False)
    return line


def _greet(fd: int, port: str, protocol: int) -> RobotInfo:
    """Request the identification until an INFO frame comes."""
    clock = MonotonicClock()
    question, line = np.zeros(OVERHEAD, np.uint8), np.zeros(LINE_LENGTH)
    end = clock.now_ns() + _PATIENCE_NS
    asked = 0
    received = b""
    try:
        while clock.now_ns() < end:
            if clock.now_ns() - asked > _ASK_AGAIN_NS:
                asked = clock.now_ns()
                length = seal_frame(question, ASK, 0, 0, 0)
                os.write(fd, question[:length].tobytes())
            readable, _, _ = select.select([fd], [], [], 0.02)
            received = (received + os.read(fd, 4096))[-4096:] if readable else received
            if (payload := _find_info(received, line)) is not None:
                return _parse_info(payload, protocol)
    except OSError as failure:
        raise DeviceError(f"{port} is gone: {failure.strerror}") from failure
    raise DeviceError(f"no robot answers at {port}", "switch it on, and check the address, of a line also its @BAUD")


def _find_info(received: bytes, line: np.ndarray[Any, Any]) -> bytes | None:
    """Return the payload of the first INFO frame among the bytes."""
    buffer = np.frombuffer(received, np.uint8).copy()
    line[:] = 0.0
    line[1] = len(received)
    while len(received) >= OVERHEAD and (frame := next_frame(line, buffer)) >= 0:
        if buffer[frame + 3] == INFO and INFO_PAYLOAD <= buffer[frame + 2] <= MAX_PAYLOAD:
            return buffer[frame + HEADER : frame + HEADER + int(buffer[frame + 2])].tobytes()
    return None
