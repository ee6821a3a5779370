"""A HapticMaster on the network, by its command interface."""

from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.haptic.devices.device_names import BuiltInDevice

__all__ = ["DEVICE"]

DEVICE = BuiltInDevice(
    __doc__,
    phrase("HapticMaster in the network"),
    "hapticmaster_port:build_hapticmaster",
    address="HOST[:PORT]",
    dynamics="dynamics:undelayed_dynamics",
)
