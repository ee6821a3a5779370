"""Serial ports of this machine with a device at them."""

from __future__ import annotations

__all__ = ["list_serial_ports"]


def list_serial_ports() -> list[dict[str, str]]:
    """Return name ("port"), description ("about") and hardware id ("id") of each port, by name."""
    from serial.tools import list_ports

    ports = sorted(list_ports.comports(), key=lambda port: str(port.device))
    return [
        {"port": str(port.device), "about": port.description or "", "id": port.hwid or ""}
        for port in ports
        if port.hwid not in (None, "n/a")  # a serial port of the board with nothing plugged in
    ]
