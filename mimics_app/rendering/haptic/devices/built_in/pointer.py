"""The simulated robot moved by mouse, gamepad or keyboard."""

from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.haptic.devices.device_names import BuiltInDevice

__all__ = ["DEVICE"]

DEVICE = BuiltInDevice(
    __doc__,
    phrase("mouse, keys or gamepad"),
    "pointer:build_pointer",
    dynamics="dynamics:servo_dynamics",
)
