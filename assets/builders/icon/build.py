"""The icon of the application: a ball in the mouth of the wavy tunnel, for menus and title bars."""

from __future__ import annotations

import numpy as np

from assets.builders.kit.lattice_noise import smooth_step
from assets.builders.sprites.build import pack, places, smaller
from mimics_app.contracts.arrays import B1, F8

__all__ = ["compose"]

_PIXELS = 256
_FINE = 3
"""Factor of supersampling, as `smaller` expects."""

_NIGHT, _DAY = np.array([0.05, 0.16, 0.24]), np.array([0.13, 0.47, 0.53])
"""Colours of the tunnel's far end and of its mouth."""

_RINGS = ((0.86, 0.00), (0.70, 0.05), (0.55, 0.09), (0.42, 0.11), (0.31, 0.10))
"""Radius and sideways place of each ring of the tunnel, the nearest first: the centres follow a sine."""

_BALL, _PLACE = 0.26, (-0.20, -0.34)
"""Radius and centre of the ball."""


def compose(seed: int) -> dict[str, bytes]:
    """Return the one picture; nothing in it is random."""
    x, y = places(_PIXELS * _FINE)
    colour, cover = _tunnel(x, y), _rounded_square(x, y)
    ball, on_ball = _ball(x, y)
    return {"mimics.png": pack(*smaller(np.where(on_ball[..., None], ball, colour), cover))}


def _rounded_square(x: F8, y: F8) -> F8:
    corner, half = 0.42, 0.97
    beyond = np.hypot(np.maximum(np.abs(x) - (half - corner), 0.0), np.maximum(np.abs(y) - (half - corner), 0.0))
    return np.asarray(beyond < corner, dtype=np.float64)


def _tunnel(x: F8, y: F8) -> F8:
    """Rings that grow darker with depth, each lit from above at its edge, shape [rows, columns, 3]."""
    colour = np.broadcast_to(_DAY * 1.35 + 0.06 * y[..., None], (*x.shape, 3)).copy()
    for depth, (radius, aside) in enumerate(_RINGS):
        away = np.hypot(x - aside, y - 0.5 * aside)
        share = depth / (len(_RINGS) - 1)
        wall = _DAY * (1.0 - share) + _NIGHT * share
        rim = smooth_step(radius - 0.07, radius - 0.01, away)[..., None] * (0.22 + 0.18 * y[..., None])
        colour = np.where((away < radius)[..., None], wall + rim * (1.0 - 0.6 * share), colour)
    return colour


def _ball(x: F8, y: F8) -> tuple[F8, B1]:
    """A sphere lit from the upper left, and where it covers the picture."""
    across, up = (x - _PLACE[0]) / _BALL, (y - _PLACE[1]) / _BALL
    towards = np.sqrt(np.maximum(1.0 - across**2 - up**2, 0.0))
    light = np.clip(-0.45 * across + 0.60 * up + 0.66 * towards, 0.0, 1.0)
    shine = light[..., None] ** 40 * 0.7
    return np.array([0.98, 0.62, 0.18]) * (0.35 + 0.70 * light[..., None]) + shine, across**2 + up**2 < 1.0
