"""One simulated leg on a gait orthosis with drives at hip and knee; a simulated person moves the foot."""

from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.haptic.devices.device_names import BuiltInDevice

__all__ = ["DEVICE"]

DEVICE = BuiltInDevice(
    __doc__,
    phrase("simulated patient, one leg"),
    "simulated_leg:build_simulated_leg",
    descriptor="leg:LEG",
    dynamics="dynamics:leg_dynamics",
)
