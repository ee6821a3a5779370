"""Measures of the gait orthosis on the person of the scenes, `player_white`, 1.021 times as large as modelled.

Frame: on the floor below the middle of the hips, x to the person's left, y up, z forward [m]. The machine is drawn at
plausible sizes; where the plant has a number of its own (arms and angles of the linkages), that is used.
"""

from __future__ import annotations

import math

from assets.builders.kit.sketch import Point

__all__ = [
    "BAR_ASIDE",
    "BELT_HEIGHT",
    "DRIVE_ASIDE",
    "GRIP",
    "HIP",
    "HIP_DRIVE_LEVER",
    "HIP_DRIVE_PIVOT",
    "HIP_HEIGHT",
    "KNEE",
    "KNEE_DRIVE_LEVER",
    "KNEE_DRIVE_PIVOT",
    "SCALE",
    "SPREADER",
]

SCALE = 1.021
"""Scale of the person in the scenes: parts that hang on bones are written smaller by it."""
HIP_HEIGHT = 1.0475
"""Height of the hips over the floor, as in the scenes [m]."""
BELT_HEIGHT = 0.085
"""Upper side of the belt [m]: the soles of a person who hangs straight are 1 cm above it."""
HIP: Point = (0.0895, 0.0, 0.0)
"""Left hip relative to the middle of the hips [m]."""
KNEE: Point = (-0.0013, -0.4319, -0.0020)
"""Left knee relative to the left hip, leg straight [m]."""
BAR_ASIDE = 0.2380
"""Distance of the bars along the legs from the middle: outside the shorts [m]."""
DRIVE_ASIDE = 0.2780
"""Distance of the drives from the middle [m]."""


def _arm(length: float, angle: float) -> tuple[float, float]:
    """Return height and depth of a point on an arm at an angle from straight down, forward positive [m]."""
    return -length * math.cos(angle), length * math.sin(angle)


_HIP_FIXED, _HIP_MOVED, _HIP_OFFSET = 0.32, 0.085, 1.70
_KNEE_FIXED, _KNEE_MOVED, _KNEE_OFFSET = 0.30, 0.065, 2.20
"""Arms [m] and angle between them in the standing pose [rad], as the settings of the simulated orthosis."""
_HIP_DRIVE = math.radians(270.0)
"""Direction of the fixed arm of the hip from straight down: backwards."""
_KNEE_DRIVE = math.radians(-170.0)
"""The same of the knee: up along the thigh, and a little backwards."""

HIP_DRIVE_PIVOT: Point = (DRIVE_ASIDE - HIP[0], *_arm(_HIP_FIXED, _HIP_DRIVE))
"""Where the drive of the left hip is held by the machine, relative to the hip [m]."""
HIP_DRIVE_LEVER: Point = (DRIVE_ASIDE - HIP[0], *_arm(_HIP_MOVED, _HIP_DRIVE - _HIP_OFFSET))
"""Where its rod holds the thigh, relative to the hip [m]."""
_KNEE_OF_PIVOT = _arm(_KNEE_FIXED, _KNEE_DRIVE)
KNEE_DRIVE_PIVOT: Point = (DRIVE_ASIDE - HIP[0], KNEE[1] + _KNEE_OF_PIVOT[0], KNEE[2] + _KNEE_OF_PIVOT[1])
"""Where the drive of the left knee is held by the thigh, relative to the hip [m]."""
KNEE_DRIVE_LEVER: Point = (DRIVE_ASIDE - HIP[0] - KNEE[0], *_arm(_KNEE_MOVED, _KNEE_DRIVE + _KNEE_OFFSET))
"""Where its rod holds the shank, relative to the knee [m]."""

SPREADER: Point = (0.26, 2.02, 0.0)
"""Left end of the bar that the harness hangs on [m]."""
GRIP: Point = (0.37, 1.16, 0.20)
"""Where the left hand rests on the rail [m]."""
