"""Runs the conformance kit against a device by name: `mimics devices check NAME[:ADDRESS]`."""

from __future__ import annotations

import sys
from pathlib import Path

from mimics_app.contracts.clock import TICK_NS, MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.recording.run import Run
from mimics_app.rendering.haptic.devices.conformance import Finding, check_device
from mimics_app.rendering.haptic.devices.device_names import recording_of
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.world.components.robot import Patient, Robot

__all__ = ["check_by_name"]


class _WallTime:
    """Clock of a real device for the conformance kit: a tick takes 1 ms, and faults cannot be injected."""

    can_fail = False

    def __init__(self) -> None:
        self._clock = MonotonicClock()
        self._due = self._clock.now_ns()

    def step(self) -> None:
        """Wait for the next tick; after a pause the schedule restarts."""
        self._due = max(self._due + TICK_NS, self._clock.now_ns() - TICK_NS)
        self._clock.sleep_until_ns(self._due)

    def spoil(self, what: str) -> None:
        """Refuse: see `can_fail`."""
        raise DeviceError(f'a real device cannot be made to "{what}"')


def check_by_name(device: str, recording: Path | None) -> list[Finding]:
    """Build a device as a scene would, run the conformance kit, and close it.

    Args:
        device: NAME or NAME:ADDRESS.
        recording: Run folder for the replay device.

    Raises:
        DeviceError: The device is not available.
    """
    robot = Robot(device=device)
    folder = recording or recording_of(device)
    samples = None if folder is None else Run.open(folder).haptic

    def configure() -> DevicePlugin:
        return build_device(robot, Patient(), samples=samples)

    plugin = configure()
    if plugin.real_time and plugin.follows != "nothing":
        sys.stderr.write("mimics: the device moves: up to 60 mm or mrad of its last joint\n")
    return check_device(plugin, robot, _WallTime() if plugin.real_time else None, configure)
