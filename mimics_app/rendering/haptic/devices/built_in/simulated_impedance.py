"""A simulated light robot that takes forces, with a simulated person."""

from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.haptic.devices.device_names import BuiltInDevice

__all__ = ["DEVICE"]

DEVICE = BuiltInDevice(
    __doc__,
    phrase("simulated patient, impedance robot"),
    "simulated_impedance:build_simulated_impedance",
    dynamics="dynamics:force_dynamics",
)
