"""The harness of the body-weight support: a vest around the trunk, and straps over the shoulders to the spreader."""

from __future__ import annotations

import numpy as np

from assets.builders.kit.sketch import Point
from assets.builders.orthosis.machine_part import ALUMINIUM, BLACK, BLUE, MachinePart, ring
from assets.builders.orthosis.orthosis_measures import HIP_HEIGHT, SCALE, SPREADER
from mimics_app.contracts.arrays import F8

__all__ = ["CHEST", "compose_harness"]

CHEST: Point = (0.0, 1.161, -0.020)
"""Place of the bone that the harness moves with, in the person's model [m]."""
_FLOOR = HIP_HEIGHT / SCALE - 0.9306
"""Height of the person's model over the floor, in the model's unit [m]."""

_TRUNK = {
    0.985: (0.155, 0.169, 0.188, 0.194, 0.191, 0.187, 0.174, 0.147, 0.136),
    1.02: (0.144, 0.157, 0.176, 0.184, 0.184, 0.182, 0.170, 0.147, 0.137),
    1.06: (0.134, 0.145, 0.164, 0.175, 0.177, 0.175, 0.167, 0.146, 0.136),
    1.10: (0.127, 0.139, 0.154, 0.165, 0.168, 0.167, 0.162, 0.143, 0.134),
    1.14: (0.125, 0.137, 0.151, 0.161, 0.164, 0.163, 0.157, 0.141, 0.131),
    1.18: (0.129, 0.142, 0.157, 0.168, 0.170, 0.168, 0.159, 0.143, 0.131),
    1.22: (0.134, 0.149, 0.164, 0.174, 0.176, 0.173, 0.164, 0.146, 0.133),
    1.26: (0.140, 0.157, 0.172, 0.178, 0.178, 0.177, 0.172, 0.149, 0.134),
    1.30: (0.146, 0.167, 0.182, 0.186, 0.186, 0.187, 0.181, 0.155, 0.138),
}
"""Radii of the trunk by height, from the back over the left side to the front in steps of 22.5 degrees [m]."""
_OFF = 0.011
"""Distance of the vest from the shirt [m]."""
_OVER_SHOULDER = (
    (1.275, 0.151),
    (1.32, 0.155),
    (1.36, 0.153),
    (1.40, 0.136),
    (1.435, 0.105),
    (1.47, 0.072),
    (1.515, 0.042),
    (1.548, 0.006),
    (1.556, -0.030),
    (1.554, -0.064),
    (1.516, -0.112),
    (1.465, -0.142),
    (1.42, -0.158),
    (1.36, -0.165),
    (1.275, -0.162),
)
"""Height and depth of a strap over a shoulder, front to back [m]."""
_STRAP, _ASIDE = 0.046, 0.092
"""Width of that strap, and its distance from the middle [m]."""


def compose_harness() -> MachinePart:
    """Return vest, straps and their hooks in the frame of the chest."""
    part = MachinePart()
    angles = np.linspace(2.0 * np.pi, 0.0, 33)
    vest = [_around(height, _OFF, angles) for height in _TRUNK]
    part.band("fabric", BLUE, vest, closed=True)
    for low, high in ((1.01, 1.05), (1.12, 1.16), (1.225, 1.265)):
        part.band("fabric", BLACK, [_around(h, _OFF + 0.005, angles) for h in (low, high)], closed=True)
        middle = 0.5 * (low + high)
        front = _around(middle, _OFF + 0.008, np.array([0.5 * np.pi]))[0]
        part.box("plastic", BLACK, tuple(front.tolist()), (0.058, 0.046, 0.016), 0.006)
        part.box("metal", ALUMINIUM, tuple((front + [0.0, 0.0, 0.009]).tolist()), (0.022, 0.030, 0.006), 0.002)
    for side in (1.0, -1.0):
        _add_shoulder(part, side)
    return part


def _around(height: float, off: float, angles: F8) -> F8:
    """Return points around the trunk at a height, at a distance from it, in the frame of the chest."""
    heights = list(_TRUNK)
    half = [float(np.interp(height, heights, [row[k] for row in _TRUNK.values()])) + off for k in range(9)]
    radii = half[4:] + half[7::-1] + half[1:4]  # from the left over the front and the right to the back
    return ring((0.0, height, 0.0), radii, angles) - CHEST


def _add_shoulder(part: MachinePart, side: float) -> None:
    """Add a strap over a shoulder, its pad, and the straps up to the spreader."""
    line = np.array(_OVER_SHOULDER)
    for colour, rows, half, lift in ((BLACK, line, 0.5 * _STRAP, 0.0), (BLUE, line[5:12], 0.64 * _STRAP, 0.003)):
        away = np.stack([np.gradient(rows[:, 1]), -np.gradient(rows[:, 0])], 1)
        away /= -np.linalg.norm(away, axis=1, keepdims=True)
        spread = [
            np.stack(
                [
                    np.full(len(rows), side * _ASIDE + edge * half),
                    rows[:, 0] + lift * away[:, 0] - 0.006 * side * edge * (np.abs(rows[:, 1]) < 0.1),
                    rows[:, 1] + lift * away[:, 1],
                ],
                1,
            )
            - CHEST
            for edge in (1.0, -1.0)
        ]
        part.band("fabric", colour, spread)
    top = np.array([side * SPREADER[0], SPREADER[1], SPREADER[2]]) / SCALE - [0.0, _FLOOR, 0.0] - CHEST
    for low in ((0.108, 1.452, 0.106), (0.104, 1.512, -0.120)):
        foot = np.array([side * low[0], low[1], low[2]]) - CHEST
        part.box("metal", ALUMINIUM, tuple(foot.tolist()), (0.040, 0.018, 0.022), 0.005)
        part.beam("fabric", BLACK, tuple(foot.tolist()), tuple(top.tolist()), (0.030, 0.004), 0.0015)
