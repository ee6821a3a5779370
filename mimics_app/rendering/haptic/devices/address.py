"""What follows a device's name, as in `serial:/dev/ttyUSB0@921600`. The one place where it is read."""

from __future__ import annotations

from dataclasses import dataclass

from mimics_app.contracts.errors import DeviceError

__all__ = ["DEFAULT_BAUD", "HAPTICMASTER_PORT", "DeviceAddress", "host_and_port", "port_and_baud", "split_device"]


DEFAULT_BAUD = 921600
"""Speed of a robot's serial line [baud]."""

HAPTICMASTER_PORT = 7654
"""TCP port that a HapticMaster listens at."""


@dataclass(frozen=True, slots=True)
class DeviceAddress:
    """A device as `robot.device` and `--device` name it.

    Attributes:
        name: Of the device; what stands before the first colon.
        address: Where it is; "" when nothing was said.
    """

    name: str
    address: str

    def __str__(self) -> str:
        return f"{self.name}:{self.address}" if self.address else self.name


def split_device(text: str) -> DeviceAddress:
    """NAME or NAME:ADDRESS; the address may hold more colons."""
    name, _, address = text.partition(":")
    return DeviceAddress(name.strip(), address.strip())


def port_and_baud(address: str, default: int) -> tuple[str, int]:
    """PORT[@BAUD] of a serial line.

    Raises:
        DeviceError: No port, or a speed that is no positive whole number.
    """
    port, _, speed = address.rpartition("@") if "@" in address else (address, "", str(default))
    if not port or not speed.isdecimal() or int(speed) == 0:
        raise DeviceError(f'"{address}" is no serial line', "write serial:PORT or serial:PORT@BAUD")
    return port, int(speed)


def host_and_port(address: str, default: int) -> tuple[str, int]:
    """HOST[:PORT] of a network device; an IPv6 host stands in brackets.

    Raises:
        DeviceError: No host, or a port that is no whole number from 1 to 65535.
    """
    bracketed = address.startswith("[") and "]" in address
    host, rest = (address[1 : address.index("]")], address[address.index("]") + 1 :]) if bracketed else (address, "")
    if not bracketed:
        host, colon, tail = address.partition(":")
        rest = colon + tail
    port = rest.removeprefix(":") if rest else str(default)
    if not host or not port.isdecimal() or not 1 <= int(port) <= 65535:
        raise DeviceError(f'"{address}" is no network address', "write hapticmaster:HOST or hapticmaster:HOST:PORT")
    return host, int(port)
