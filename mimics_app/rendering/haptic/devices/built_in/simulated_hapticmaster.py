"""The simulated HapticMaster, with a simulated person."""

from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.haptic.devices.device_names import BuiltInDevice

__all__ = ["DEVICE"]

DEVICE = BuiltInDevice(
    __doc__,
    phrase("simulated patient"),
    "simulated_hapticmaster:build_simulated_hapticmaster",
    dynamics="dynamics:servo_dynamics",
)
