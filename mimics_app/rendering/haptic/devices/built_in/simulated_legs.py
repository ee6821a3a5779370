"""Two simulated legs on a gait orthosis with four drives; a simulated person moves both feet."""

from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.haptic.devices.device_names import BuiltInDevice

__all__ = ["DEVICE"]

DEVICE = BuiltInDevice(
    __doc__,
    phrase("simulated patient, both legs"),
    "simulated_leg:build_simulated_leg",
    descriptor="leg:LEGS",
    dynamics="dynamics:leg_dynamics",
)
