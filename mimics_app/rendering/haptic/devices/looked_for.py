"""Whether there is anything at the address of a device, before compiled code is imported: minutes the first time.

What is at it is asked when the device is built.
"""

from __future__ import annotations

import os
import socket
from collections.abc import Callable

from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.haptic.devices.address import (
    DEFAULT_BAUD,
    HAPTICMASTER_PORT,
    host_and_port,
    port_and_baud,
    split_device,
)

__all__ = ["CONNECT_S", "look_for_device", "no_hapticmaster", "no_port"]

CONNECT_S = 2.0
"""How long a machine in the network may take to accept a connection [s]."""

_AT_ONCE_S = 0.2
"""A wait that is longer than this [s] is announced."""


def look_for_device(text: str, tell: Callable[[str], None]) -> None:
    """Refuse NAME:ADDRESS where nothing is; of other devices nothing can be said yet.

    Args:
        text: As `--device` has it.
        tell: Is called with a line before a wait.

    Raises:
        DeviceError: No such line, nothing accepts a connection there, or the address cannot be read.
    """
    device = split_device(text)
    if device.name == "serial":
        port, _ = port_and_baud(device.address, DEFAULT_BAUD)
        if os.path.isabs(port) and not os.path.exists(port):
            raise no_port(port, "nothing is there")
    elif device.name == "hapticmaster":
        host, number = host_and_port(device.address, HAPTICMASTER_PORT)
        _knock(host, number, tell)


def no_port(port: str, why: str) -> DeviceError:
    """The error of a serial line that cannot be opened."""
    return DeviceError(f"{port} cannot be opened: {why}", "mimics devices lists the serial ports")


def no_hapticmaster(host: str, port: int, why: object) -> DeviceError:
    """The error of a HapticMaster that is not there."""
    return DeviceError(f"no HapticMaster at {host}:{port}: {why}", "is it on, and in this network?")


def _knock(host: str, port: int, tell: Callable[[str], None]) -> None:
    """Connect and hang up: a machine that is off refuses, or says nothing."""
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
