"""A robot on a serial line, by the protocol of docs/devices/serial_protocol.md."""

from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.haptic.devices.device_names import BuiltInDevice

__all__ = ["DEVICE"]

DEVICE = BuiltInDevice(
    __doc__,
    phrase("robot on a serial port"),
    "serial_port:build_serial",
    address="PORT[@BAUD]",
    dynamics="dynamics:serial_dynamics",
)
