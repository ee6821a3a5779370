"""Where the shadows of boxes may fall: prisms along the sun's rays, cut to what they fall on."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F8, I4, U1
from mimics_app.contracts.kernel import kernel
from mimics_app.maths.mat import affine_inverse

__all__ = ["FIGURES", "LEAST", "cut_prisms", "slice_casters"]

FIGURES = 5
"""Of a caster in the frame of the rays: least and greatest x, least and greatest y, greatest z [m]."""

_LEFT, _RIGHT, _BOTTOM, _TOP, _NEAREST = range(FIGURES)

LEAST = [_LEFT, _BOTTOM]
"""Those of a caster's figures that are least; the others are greatest."""

_PARALLEL = 1e-9
"""Change of a coordinate along a ray below which the ray is parallel to the sides [1/m]."""

_SLENDER = 2.0
"""Length over width up to which a prism is one piece: an oblique one is much smaller than its bounding rectangle."""

_MOST_PIECES = 8

_ROWS = 4
"""Of a matrix that moves points."""

_FLAT = 1e-12
"""Volume of the unit cube of a node [m^3] below which its box is not used."""


@kernel
def _measure_corners(corners: F8, rays: F8, figures: F8) -> None:
    """Compute the figures of a box from its corners in the world [m], [8, 3]."""
    figures[::2], figures[1::2] = np.inf, -np.inf
    figures[_NEAREST] = -np.inf
    for corner in range(corners.shape[0]):
        x, y, z = corners[corner]
        across = rays[0, 0] * x + rays[0, 1] * y + rays[0, 2] * z
        up = rays[1, 0] * x + rays[1, 1] * y + rays[1, 2] * z
        near = rays[2, 0] * x + rays[2, 1] * y + rays[2, 2] * z
        figures[_LEFT], figures[_RIGHT] = min(figures[_LEFT], across), max(figures[_RIGHT], across)
        figures[_BOTTOM], figures[_TOP] = min(figures[_BOTTOM], up), max(figures[_TOP], up)
        figures[_NEAREST] = max(figures[_NEAREST], near)


@kernel
def slice_casters(corners: F8, starts: I4, rays: F8, slices: int, casters: F8) -> None:
    """Cut casters into slices of equal height across the rays, and compute the figures of each.

    Args:
        corners: Corners of their boxes, world [m], [boxes, 8, 3].
        starts: First box of each, and the number of boxes, int32 [n + 1].
        rays: Axes of the frame of the rays in the world: across, across, towards the sun; [3, 3].
        slices: Slices of each caster.
        casters: Written; of an empty slice the least x is beyond the greatest, [n * slices, `FIGURES`].
    """
    boxes = np.empty((corners.shape[0], FIGURES))
    for box in range(corners.shape[0]):
        _measure_corners(corners[box], rays, boxes[box])
    for i in range(starts.shape[0] - 1):
        own = boxes[starts[i] : starts[i + 1]]
        bottom, top = np.inf, -np.inf
        for box in own:
            bottom, top = min(bottom, box[_BOTTOM]), max(top, box[_TOP])
        for k in range(slices):
            caster = casters[i * slices + k]
            caster[_LEFT], caster[_RIGHT], caster[_NEAREST] = np.inf, -np.inf, -np.inf
            caster[_BOTTOM] = bottom + k * (top - bottom) / slices
            caster[_TOP] = bottom + (k + 1) * (top - bottom) / slices
            for box in own:
                if box[_BOTTOM] <= caster[_TOP] and box[_TOP] >= caster[_BOTTOM]:
                    caster[_LEFT] = min(caster[_LEFT], box[_LEFT])
                    caster[_RIGHT] = max(caster[_RIGHT], box[_RIGHT])
                    caster[_NEAREST] = max(caster[_NEAREST], box[_NEAREST])


@kernel
def _measure_box(box: F8, node: F8, rays: F8, middle: F8, around: F8) -> None:
    """Compute middle and half extents of a box of a node in the frame of the rays [m], [3] each."""
    middle[:], around[:] = 0.0, 0.0
    for r in range(3):
        half = 0.5 * (box[1, r] - box[0, r])
        centre = 0.5 * (box[1, r] + box[0, r])
        for k in range(3):
            along = rays[k, 0] * node[0, r] + rays[k, 1] * node[1, r] + rays[k, 2] * node[2, r]
            middle[k] += along * centre + rays[k, r] * node[r, 3]
            around[k] += abs(along) * half


@kernel
def _cut_by_box(prism: F8, middle: F8, inverse: F8, box: F8, rays: F8, reach: float) -> None:
    """Cut a prism to the box of what it falls on, grown by `reach`.

    Args:
        prism: Least and greatest x, y and z in the frame of the rays [m], [3, 2]; z is changed.
        middle: Middle of the box in that frame [m], [3].
        inverse: T_node_from_world, [4, 4].
        box: Its least and greatest corner in the node's frame [m], [2, 3].
        rays: Axes of the frame of the rays in the world, [3, 3].
        reach: Margin [m].
    """
    for i in range(3):
        row = inverse[i]
        limit = reach * math.sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2])
        limit += 0.5 * (box[1, i] - box[0, i])
        base = 0.0
        for k in range(2):
            slope = row[0] * rays[k, 0] + row[1] * rays[k, 1] + row[2] * rays[k, 2]
            base += slope * (0.5 * (prism[k, 0] + prism[k, 1]) - middle[k])
            limit += abs(slope) * 0.5 * (prism[k, 1] - prism[k, 0])
        slope = row[0] * rays[2, 0] + row[1] * rays[2, 1] + row[2] * rays[2, 2]
        if abs(slope) > _PARALLEL:
            centre, length = middle[2] - base / slope, limit / abs(slope)
            prism[2, 0], prism[2, 1] = max(prism[2, 0], centre - length), min(prism[2, 1], centre + length)
        elif abs(base) > limit:
            prism[2, 1] = -np.inf


@kernel
def _store(prism: F8, rays: F8, count: int, prisms: F8) -> int:
    """Store a prism in pieces while there is room; return the number of prisms with these."""
    width = max(prism[0, 1] - prism[0, 0], prism[1, 1] - prism[1, 0])
    length = prism[2, 1] - prism[2, 0]
    pieces = min(_MOST_PIECES, max(1, math.ceil(length / (_SLENDER * width))))
    for piece in range(pieces if count + pieces <= prisms.shape[0] else 0):
        for corner in range(prisms.shape[1]):
            x, y = prism[0, corner & 1], prism[1, corner >> 1 & 1]
            z = prism[2, 0] + (piece + (corner >> 2)) * length / pieces
            for r in range(3):
                prisms[count + piece, corner, r] = x * rays[0, r] + y * rays[1, r] + z * rays[2, r]
    return count + pieces


@kernel
def cut_prisms(casters: F8, rays: F8, reach: float, boxes: F8, nodes: I4, world: F8, prisms: F8, fallen: U1) -> int:
    """Compute the prisms in which the shadows of casters may fall on boxes.

    Args:
        casters: See `slice_casters`, [n, `FIGURES`].
        rays: Axes of the frame of the rays in the world, [3, 3].
        reach: Margin around a shadow [m].
        boxes: Least and greatest corner in the frame of a node [m], [m, 2, 3].
        nodes: Number of the node of each, int32 [m].
        world: T_world_from_node of each node, [nodes, 4, 4].
        prisms: Written: corners, world [m], [capacity, 8, 3].
        fallen: Set to 1 for each box on which a shadow may fall, [m].

    Returns:
        Number of prisms; more than the capacity where they did not fit.
    """
    count, prism, inverse = 0, np.empty((3, 2)), np.empty((_ROWS, _ROWS))
    middle, around = np.empty(3), np.empty(3)
    for j in range(boxes.shape[0]):
        _measure_box(boxes[j], world[nodes[j]], rays, middle, around)
        around += reach
        known = False
        for i in range(casters.shape[0]):
            for k in range(2):
                prism[k, 0] = max(casters[i, 2 * k] - reach, middle[k] - around[k])
                prism[k, 1] = min(casters[i, 2 * k + 1] + reach, middle[k] + around[k])
            prism[2, 0] = middle[2] - around[2]
            prism[2, 1] = min(casters[i, _NEAREST] + reach, middle[2] + around[2])
            if prism[0, 0] >= prism[0, 1] or prism[1, 0] >= prism[1, 1] or prism[2, 0] >= prism[2, 1]:
                continue
            if known or abs(affine_inverse(world[nodes[j]], inverse)) > _FLAT:
                known = True
                _cut_by_box(prism, middle, inverse, boxes[j], rays, reach)
            if prism[2, 0] < prism[2, 1]:
                fallen[j] = 1
                count = _store(prism, rays, count, prisms)
    return count
