"""Regions of stable contacts on the bench: of a device in numbers, and of the linear condition alone."""

from __future__ import annotations

from typing import Any

import numpy as np

from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.rendering.haptic.kernels.closed_region import REGION, find_region

HEAVY = {"virtual_mass": 1e3}
"""Of a mass whose region ends far beyond every contact: what is left is the linear condition."""


def region_of(delay: float, period: float = 1e-3, **values: float) -> Any:
    """A REGION record for fields of SCENE, a delay and a period [s]."""
    scene, region = np.zeros(1, SCENE), np.zeros(1, REGION)
    for name, value in values.items():
        scene[0][name] = value
    find_region(scene[0], delay, period, region[0])
    return region[0]


def linear_region(own: float, lag: float) -> Any:
    """The region of a device of unknown mass, with damping `own` [N s/m] and a lag T / 2 + delay [s]."""
    return region_of(0.5 * lag, lag, force_driven=1, device_damping=own)
