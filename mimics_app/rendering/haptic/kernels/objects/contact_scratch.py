"""Working record of touching shapes: one point at one shape, and what the next tick needs of this one.

A record travels into compiled functions as one pointer; tuples of arrays would travel by value.
"""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.haptic_objects import MAX_POINTS, SHAPE

__all__ = ["BEFORE", "BIRTH", "CONTACT_SCRATCH", "DISABLED", "PLACED", "TRACED"]

TRACED = 1
"""CONTACT_SCRATCH.known: the point's last place is where it came from."""

PLACED = 0
"""CONTACT_SCRATCH.known: the point was put where it is."""

DISABLED = -1
"""CONTACT_SCRATCH.known: the point touches nothing."""

CONTACT_SCRATCH = np.dtype(
    [
        ("tick", "i8"),  # ticks so far
        ("revision", "i8"),  # of the rows last seen
        ("known", "i8", MAX_POINTS),  # TRACED, PLACED or DISABLED; 0 at first: PLACED
        ("last_points", "f8", (MAX_POINTS, 3)),  # at the last tick, world [m]
        ("last", "f8", 3),  # the present point at the last tick, world [m]
        ("point", "f8", 3),  # the present point, world [m]
        ("point_velocity", "f8", 3),  # [m/s]
        ("felt", "f8", 3),  # force on it so far in this tick, world [N]
        ("radius", "f8"),  # of its ball [m]
        ("contact", "i8"),  # number of the point of contact that carries it
        ("rotation", "f8", (3, 3)),  # world from the present shape
        ("position", "f8", 3),  # of that shape, world [m]
        ("drift", "f8", 3),  # velocity of that shape's origin, world [m/s]
        ("spin", "f8", 3),  # angular velocity of that shape, world [rad/s]
        ("p", "f8", 3),  # the point in the frame of the shape [m]
        ("v", "f8", 3),  # its velocity relative to the shape, same frame [m/s]
        ("slope", "f8", 3),  # of the rippled surface, same frame [-]
        ("rate", "f8"),  # of the rippled depth [m/s]
        ("force", "f8", 3),  # on the user, world [N]
        ("normal", "f8", 3),  # of the touched surface, world
        ("stiffness", "f8"),  # of the contact [N/m]
        ("damping", "f8"),  # of the contact [N s/m]
        ("hold", "f8"),  # stiffness of friction while it holds, else 0 [N/m]
        ("a", "f8", 3),  # scratch
        ("b", "f8", 3),  # scratch
        ("c", "f8", 3),  # scratch
    ],
    align=True,
)
"""Zeros are fresh."""

BIRTH = np.dtype(
    [
        ("tick", "i8"),  # in which the shape was new, edited, or put back with its body
        ("form", SHAPE),  # as last seen
    ],
    align=True,
)
"""When a shape began to be what it is."""

BEFORE = np.dtype(
    [
        ("position", "f8", 3),  # of the body's frame, world [m]
        ("rotation", "f8", (3, 3)),  # world from body
        ("spawn", "i8"),
    ],
    align=True,
)
"""A body at the last tick."""
