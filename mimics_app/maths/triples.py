"""Vectors as three numbers in plain Python: for single points of a frame, without an array or the compiler."""

from __future__ import annotations

from mimics_app.contracts.arrays import Vec3

__all__ = ["add_scaled", "cross", "dot", "subtract"]


def dot(a: Vec3, b: Vec3) -> float:
    """Return the inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vec3, b: Vec3) -> Vec3:
    """Return a x b (right-handed)."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def subtract(a: Vec3, b: Vec3) -> Vec3:
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def add_scaled(a: Vec3, b: Vec3, factor: float) -> Vec3:
    """Return a + factor b."""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]
