"""The gait orthosis Lokomat, simulated, with a simulated person."""

from mimics_app.rendering.haptic.devices.device_names import BuiltInDevice

__all__ = ["DEVICE"]

DEVICE = BuiltInDevice(
    __doc__,
    "simulated patient in a gait orthosis",
    "simulated_lokomat:build_simulated_lokomat",
    address="sim",
    descriptor="lokomat:LOKOMAT",
    optional=True,
)
