"""Noise that is equal on every machine: a hash of lattice points, blended between them."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8, I8, U4

__all__ = ["hash_noise", "mixed_bits", "pixels", "smooth_noise", "smooth_step"]


def hash_noise(x: I8, y: I8, seed: int) -> F8:
    """Return white noise of [0, 1) at lattice points.

    Args:
        x: Lattice points, int64, any shape.
        y: Of the same shape.
        seed: Seed of the noise.
    """
    value = (x.astype(np.uint32) * np.uint32(0x9E3779B1)) ^ (y.astype(np.uint32) * np.uint32(0x85EBCA77))
    return mixed_bits(value ^ np.uint32((seed * 0xC2B2AE3D) & 0xFFFFFFFF))


def mixed_bits(value: U4) -> F8:
    """Return numbers of [0, 1) in which every bit of a value counts: the low-bias 32-bit hash of Wellons (2018)."""
    for shift, factor in ((15, 0x2C1B3C6D), (12, 0x297A2D39)):
        value = (value ^ (value >> np.uint32(shift))) * np.uint32(factor)
    return (value ^ (value >> np.uint32(15))) / 4294967296.0


def smooth_noise(height: int, width: int, cells_y: int, cells_x: int, seed: int) -> F8:
    """Tileable value noise of [0, 1), float64 [height, width]: lattice values blended by 3t^2 - 2t^3.

    Only sums and products of single elements are used, which every machine rounds alike.
    """
    y = np.arange(height) * cells_y / height
    x = np.arange(width) * cells_x / width
    row, column = y.astype(np.int64)[:, None], x.astype(np.int64)[None, :]
    fy, fx = (y - np.floor(y))[:, None], (x - np.floor(x))[None, :]
    fy, fx = fy * fy * (3.0 - 2.0 * fy), fx * fx * (3.0 - 2.0 * fx)

    def corner(dy: int, dx: int) -> F8:
        at_y, at_x = np.broadcast_arrays((row + dy) % cells_y, (column + dx) % cells_x)
        return hash_noise(at_x, at_y, seed)

    top = corner(0, 0) * (1.0 - fx) + corner(0, 1) * fx
    bottom = corner(1, 0) * (1.0 - fx) + corner(1, 1) * fx
    return top * (1.0 - fy) + bottom * fy


def pixels(width: int, height: int) -> tuple[I8, I8]:
    """Return column and row of every pixel of an image, [height, width] each."""
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    return x.astype(np.int64), y.astype(np.int64)


def smooth_step(low: float, high: float, value: F8) -> F8:
    """Return 0 below `low`, 1 above `high`, smooth between."""
    share = np.clip((value - low) / (high - low), 0.0, 1.0)
    return np.asarray(share * share * (3.0 - 2.0 * share))
