"""The simulated HapticMaster, with a simulated person."""

from mimics_app.rendering.haptic.devices.device_names import BuiltInDevice

__all__ = ["DEVICE"]

DEVICE = BuiltInDevice(
    __doc__,
    "simulated patient",
    "simulated_hapticmaster:build_simulated_hapticmaster",
    dynamics="dynamics:servo_dynamics",
)
