"""Early check of a device's address, before compiled code is imported, which takes minutes the first time.

It finds out whether anything is there; the device itself is identified when it is built.
"""

from __future__ import annotations

import os
import socket
from collections.abc import Callable

from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.haptic.devices.address import (
    host_and_port,
    port_and_baud,
    split_device,
)

__all__ = ["CONNECT_S", "find_device", "no_hapticmaster", "no_port"]

CONNECT_S = 2.0
"""Time-out of a network connection [s]."""

_AT_ONCE_S = 0.2
"""Longest wait without an announcement [s]."""


def find_device(text: str, tell: Callable[[str], None]) -> None:
    """Refuse the address of a serial line or network device where nothing is; other devices are not checked.

    Args:
        text: NAME:ADDRESS as in `--device`.
        tell: Called with a line of text before a wait.

    Raises:
        DeviceError: No such serial line, no connection, or an invalid address.
    """
    device = split_device(text)
    if device.name == "serial":
        port, _ = port_and_baud(device.address)
        if os.path.isabs(port) and not os.path.exists(port):
            raise no_port(port, "nothing is there")
    elif device.name == "hapticmaster":
        host, number = host_and_port(device.address)
        _knock(host, number, tell)


def no_port(port: str, why: str) -> DeviceError:
    """Return the error of a serial line that cannot be opened."""
    return DeviceError(f"{port} cannot be opened: {why}", "mimics devices lists the serial ports")


def no_hapticmaster(host: str, port: int, why: OSError) -> DeviceError:
    """Return the error of a HapticMaster that cannot be connected."""
    return DeviceError(f"no HapticMaster at {host}:{port}: {why.strerror or why}", "switch it on, check the network")


def _knock(host: str, port: int, tell: Callable[[str], None]) -> None:
    """Connect and disconnect: a machine that is off refuses or does not answer."""
    try:
        socket.create_connection((host, port), timeout=_AT_ONCE_S).close()
    except TimeoutError:
        tell(f"waiting up to {CONNECT_S:g} s for the HapticMaster at {host}:{port}")
    except OSError as failure:
        raise no_hapticmaster(host, port, failure) from failure
    else:
        return
    try:
        socket.create_connection((host, port), timeout=CONNECT_S).close()
    except OSError as failure:
        raise no_hapticmaster(host, port, failure) from failure
