"""Settings of a simulated device in a scene: positive numbers by name, each with a place in the device's memory."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import DeviceError, nearest

__all__ = ["write_settings"]

_LARGEST = 1e9
"""Bound of every setting, in its unit: the stiffness of a rod is below it."""


def write_settings(
    memory: NDArray[np.float64],
    known: Mapping[str, tuple[int, float]],
    given: Mapping[str, object],
    device: str,
    or_zero: Collection[str] = (),
) -> None:
    """Write all settings to the memory: the given values, defaults for the rest.

    Args:
        memory: Memory of the device.
        known: Place and default value by name.
        given: `robot.settings` of the scene.
        device: Name of the device in error messages.
        or_zero: Settings that may be 0.

    Raises:
        DeviceError: An unknown setting, or one that is not a positive number, or 0 where it may be.
    """
    for place, usual in known.values():
        memory[place] = usual
    for name, value in given.items():
        if name not in known:
            raise DeviceError(f'the {device} has no setting "{name}"', nearest(name, known))
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value < _LARGEST:
            raise DeviceError(f'the setting "{name}" of the {device} is {value!r}', "give a positive number")
        if value == 0.0 and name not in or_zero:
            raise DeviceError(f'the setting "{name}" of the {device} is 0', "give a positive number")
        memory[known[name][0]] = value
