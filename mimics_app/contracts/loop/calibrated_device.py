"""A device that can be calibrated while it is inactive, step by step."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from mimics_app.contracts.loop.loop_ports import DevicePlugin

__all__ = ["CalibratedDevice", "calibration_steps"]


def _no_steps() -> dict[str, Callable[[], None]]:
    return {}


@dataclass(frozen=True, slots=True)
class CalibratedDevice(DevicePlugin):
    """A device with steps of calibration.

    Attributes:
        steps: What begins each step, by its name; main thread only, and only while the device is inactive
            (contracts/loop/device_life.py). It returns at once; until the step is done `read` gives no fresh data.
    """

    steps: Mapping[str, Callable[[], None]] = field(default_factory=_no_steps)


def calibration_steps(plugin: DevicePlugin) -> Mapping[str, Callable[[], None]]:
    """Return the steps of calibration of a device; empty where it has none."""
    return plugin.steps if isinstance(plugin, CalibratedDevice) else {}
