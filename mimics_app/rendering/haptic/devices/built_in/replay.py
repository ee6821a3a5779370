"""The sensor data of a recording, as a device."""

from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.haptic.devices.device_names import BuiltInDevice

__all__ = ["DEVICE"]

DEVICE = BuiltInDevice(__doc__, phrase("recording"), "replay:build_replay")
