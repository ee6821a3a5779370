"""The gait orthosis Lokomat by its address: simulated, a recording, on a serial line, or by UDP.

lokomat[:sim]              the simulated one
lokomat:log:RUN            the sensor data of a recording
lokomat:serial:PORT[@BAUD] frames on a serial line (docs/devices/lokomat_protocol.md)
lokomat:udp:HOST:PORT      the same frames, one a datagram
"""

from __future__ import annotations

import socket
from dataclasses import replace

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.devices import serial_robot
from mimics_app.rendering.haptic.devices.address import host_and_port
from mimics_app.rendering.haptic.devices.dynamics import LOKOMAT_NAME, lokomat_dynamics
from mimics_app.rendering.haptic.devices.replay import build_replay
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.serial_frames import LEG_PROTOCOL
from mimics_app.rendering.haptic.devices.serial_port import FrameLine, link_robot, serial_line
from mimics_app.rendering.haptic.devices.simulated_lokomat import build_simulated_lokomat

__all__ = ["build_lokomat"]

_FORMS = "lokomat, lokomat:sim, lokomat:log:RUN, lokomat:serial:PORT[@BAUD] or lokomat:udp:HOST:PORT"

_UDP_BYTES_PER_SECOND = 12.5e6
"""Capacity counted on between two machines [bytes/s]: 100 Mbit/s."""


class _Datagrams:
    """A UDP socket to one other end; what others send is not received."""

    def __init__(self, host: str, port: int) -> None:
        try:
            family, kind, protocol, _, where = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
            self._socket = socket.socket(family, kind, protocol)
            self._socket.setblocking(False)
            self._socket.connect(where)
        except OSError as failure:
            raise DeviceError(f"{host}:{port} cannot be reached: {failure.strerror or failure}") from failure

    def fileno(self) -> int:
        return self._socket.fileno()

    def close(self) -> None:
        self._socket.close()


def _udp_line(address: str) -> FrameLine:
    host, port = host_and_port(address)
    return FrameLine(f"{host}:{port}", _UDP_BYTES_PER_SECOND, lambda: _Datagrams(host, port))


def build_lokomat(request: DeviceRequest) -> DevicePlugin:
    """Build the gait orthosis of an address.

    Raises:
        DeviceError: An unknown form of address, a recording that is not given, or nothing that answers.
    """
    kind, _, rest = request.address.partition(":")
    if kind in ("", "sim") and not rest:
        return build_simulated_lokomat(request)
    if kind == "log" and rest:
        return replace(build_replay(request), name=LOKOMAT_NAME)
    if kind == "serial" and rest:
        return _linked(request, serial_line(rest))
    if kind == "udp" and rest.rpartition(":")[0]:
        return _linked(request, _udp_line(rest))
    raise DeviceError(f'the Lokomat has no address "{request.address}"', f"write {_FORMS}")


def _linked(request: DeviceRequest, line: FrameLine) -> DevicePlugin:
    """Return the device of an orthosis at the other end of a line."""
    memory, supervisor = link_robot(line, request.rate, LEG_PROTOCOL)
    own = lokomat_dynamics(request.robot, request.rate)
    return DevicePlugin(
        LOKOMAT_NAME,
        serial_robot.read_serial,
        serial_robot.write_serial,
        memory,
        supervisor.close,
        delay=float(memory[serial_robot.OWN_DELAY]),
        filtering=own["filtering"],
        mass=own["mass"],
        follows="torque",
        real_time=True,
        trouble=supervisor.trouble,
    )
