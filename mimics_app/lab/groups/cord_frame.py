"""Frames along a cord, with the cost for the drawn rings and the twist of the surface.

Each on a hanging cord, on one with an inflection, and on a helix. Error: the
largest angle to the rotation-minimising frame, computed in steps 32 times finer.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.maths.cord import hang
from mimics_app.maths.frames import (
    frenet_normals,
    plane_normal,
    projected_up_normals,
    rotation_minimising_normals,
)
from mimics_app.rendering.visual.passes.cord import RINGS

__all__ = ["FRAMES"]

Frame = Callable[[F8, F8], F8]
"""Function of positions and unit tangents of rings, [n, 3] each, that returns unit normals, [n, 3]."""

_FINER = 32
_UP = np.array([0.0, 1.0, 0.0])


def _hanging(t: F8) -> F8:
    return hang([0.0, 1.2, 0.0], [0.0, 1.1, -1.0], 1.2).point(1.2 * t)


def _both_sides(t: F8) -> F8:
    return np.stack([0.0 * t, 0.1 * np.sin(2.0 * np.pi * t), -t], axis=1)


def _helix(t: F8) -> F8:
    angle = 4.0 * np.pi * t
    return np.stack([0.1 * np.cos(angle), 0.1 * np.sin(angle), -t], axis=1)


_CURVES: dict[str, Callable[[F8], F8]] = {"hanging": _hanging, "bent to both sides": _both_sides, "helix": _helix}
"""Functions of shares of a cord's length [n] that return positions [m], [n, 3], by name."""


def constant_binormal(places: F8, tangents: F8) -> F8:
    """Return normals whose binormal is the normal of the plane of best fit."""
    return _unit(np.cross(plane_normal(places), tangents))


def frenet(places: F8, tangents: F8) -> F8:
    """Return principal normals from the differences of the tangents."""
    return frenet_normals(tangents, np.gradient(tangents, axis=0))


def projected_up(places: F8, tangents: F8) -> F8:
    """Return normals as near to upwards as the cord allows."""
    return projected_up_normals(tangents, _UP)


def double_reflection(places: F8, tangents: F8) -> F8:
    """Return the rotation-minimising normals."""
    side = np.eye(3)[np.argmin(np.abs(tangents[0]))]
    return rotation_minimising_normals(places, tangents, _unit(np.cross(tangents[:1], side))[0])


FRAMES: dict[str, tuple[Frame, str, str]] = {
    "constant binormal": (constant_binormal, "a hanging cord lies in a plane", "plane cords: exact there"),
    "Frenet": (frenet, "tangent and its change", "where the cord bends to one side, and bends at all"),
    "projected up": (projected_up, "the normal as near to upwards as can be", "cords that nowhere go straight up"),
    "double reflection": (double_reflection, "Wang et al. 2008, ring after ring", "any cord; not in a vertex shader"),
}


def _unit(vectors: F8) -> F8:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12))


@cache
def _rings(curve: str) -> tuple[F8, F8, F8]:
    """Return positions, tangents and rotation-minimising normals of the drawn rings."""
    t = np.linspace(0.0, 1.0, (RINGS - 1) * _FINER + 1)
    places = _CURVES[curve](t)
    tangents = _unit(np.gradient(places, t, axis=0, edge_order=2))
    normals = double_reflection(places, tangents)
    return places[::_FINER], tangents[::_FINER], normals[::_FINER]


def _twist_error(frame: Frame, curve: str) -> float:
    """Return the largest rotation of a frame around the cord since its start [rad]."""
    places, tangents, still = _rings(curve)
    normals = frame(places, tangents)
    across = np.cross(tangents, still)
    angle = np.unwrap(np.arctan2((normals * across).sum(axis=1), (normals * still).sum(axis=1)))
    return float(np.abs(angle - angle[0]).max())


def _cost_us(frame: Frame, curve: str) -> float:
    places, tangents, _ = _rings(curve)
    return shortest_us(lambda: frame(places, tangents))


_RUNS = "constant binormal, hanging"
compare(
    __name__,
    f"a frame for each of {RINGS} rings of a cord; error: by which angle it twists the surface",
    "rad",
    [
        Rival(named, source, valid, {} if named == _RUNS else None, (frame, curve))
        for name, (frame, source, valid) in FRAMES.items()
        for curve in _CURVES
        for named in [f"{name}, {curve}"]
    ],
    Probes(_cost_us, _twist_error),
    default=_RUNS,
)
