"""Parser of device addresses such as `serial:/dev/ttyUSB0@921600`."""

from __future__ import annotations

from dataclasses import dataclass

from mimics_app.contracts.errors import DeviceError

__all__ = ["DeviceAddress", "host_and_port", "port_and_baud", "split_device"]


_DEFAULT_BAUD = 921600
"""Default speed of a robot's serial line [baud]."""

_HAPTICMASTER_PORT = 7654
"""Default TCP port of a HapticMaster."""


@dataclass(frozen=True, slots=True)
class DeviceAddress:
    """Device in `robot.device` and `--device`.

    Attributes:
        name: Name of the device, before the first colon.
        address: Address of the device, "" if not given.
    """

    name: str
    address: str

    def __str__(self) -> str:
        return f"{self.name}:{self.address}" if self.address else self.name


def split_device(text: str) -> DeviceAddress:
    """Parse NAME or NAME:ADDRESS; the address may contain colons."""
    name, _, address = text.partition(":")
    return DeviceAddress(name.strip(), address.strip())


def port_and_baud(address: str) -> tuple[str, int]:
    """Parse PORT[@BAUD] of a serial line.

    Raises:
        DeviceError: No port, or a speed that is not a positive integer.
    """
    port, _, speed = address.rpartition("@") if "@" in address else (address, "", str(_DEFAULT_BAUD))
    if not port or not speed.isdecimal() or int(speed) == 0:
        raise DeviceError(f'"{address}" is not a serial line', "write serial:PORT or serial:PORT@BAUD")
    return port, int(speed)


def host_and_port(address: str) -> tuple[str, int]:
    """Parse HOST[:PORT] of a network device; an IPv6 host is in brackets.

    Raises:
        DeviceError: No host, or a port that is not an integer from 1 to 65535.
    """
    bracketed = address.startswith("[") and "]" in address
    host, rest = (address[1 : address.index("]")], address[address.index("]") + 1 :]) if bracketed else (address, "")
    if not bracketed:
        host, colon, tail = address.partition(":")
        rest = colon + tail
    port = rest.removeprefix(":") if rest else str(_HAPTICMASTER_PORT)
    if not host or not port.isdecimal() or not 1 <= int(port) <= 65535:
        raise DeviceError(f'"{address}" is not a network address', "write hapticmaster:HOST or hapticmaster:HOST:PORT")
    return host, int(port)
