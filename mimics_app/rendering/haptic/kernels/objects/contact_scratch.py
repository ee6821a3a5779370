"""Working record of contacts of points with shapes: the present point and shape, and the state for the next tick.

A record is passed to compiled functions as one pointer; tuples of arrays would be passed by value.
"""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.loop.haptic_objects import MAX_POINTS, SHAPE

__all__ = ["BEFORE", "BIRTH", "CONTACT_SCRATCH", "DISABLED", "PLACED", "TRACED"]

TRACED = 1
"""CONTACT_SCRATCH.known: the point moved continuously from its last position."""

PLACED = 0
"""CONTACT_SCRATCH.known: the point was placed in this tick; its last position is invalid."""

DISABLED = -1
"""CONTACT_SCRATCH.known: the point touches nothing."""

CONTACT_SCRATCH = np.dtype(
    [
        ("tick", "i8"),  # number of the present tick, from 1
        ("revision", "i8"),  # of the rows in the last tick
        ("known", "i8", MAX_POINTS),  # TRACED, PLACED or DISABLED
        ("last_points", "f8", (MAX_POINTS, 3)),  # at the last tick, world [m]
        ("last", "f8", 3),  # the present point at the last tick, world [m]
        ("point", "f8", 3),  # the present point, world [m]
        ("point_velocity", "f8", 3),  # [m/s]
        ("on_point", "f8", 3),  # force on it so far in this tick, world [N]
        ("radius", "f8"),  # of its ball [m]
        ("contact", "i8"),  # number of its point of contact of the device
        ("rotation", "f8", (3, 3)),  # world from the present shape
        ("position", "f8", 3),  # of that shape, world [m]
        ("drift", "f8", 3),  # velocity of that shape's origin, world [m/s]
        ("spin", "f8", 3),  # angular velocity of that shape, world [rad/s]
        ("p", "f8", 3),  # the point in the frame of the shape [m]
        ("v", "f8", 3),  # its velocity relative to the shape, same frame [m/s]
        ("slope", "f8", 3),  # of the rippled surface, same frame [-]
        ("lowered", "f8"),  # depth less the rippled depth [m]
        ("rate", "f8"),  # of the rippled depth [m/s]
        ("ripple", "f8", 3),  # part of the force that the ripple makes, world [N]
        ("force", "f8", 3),  # on the user, world [N]
        ("normal", "f8", 3),  # of the touched surface, world
        ("stiffness", "f8"),  # of the contact [N/m]
        ("damping", "f8"),  # of the contact [N s/m]
        ("hold", "f8"),  # tangential stiffness of sticking friction, else 0 [N/m]
        ("a", "f8", 3),  # scratch
        ("b", "f8", 3),  # scratch
        ("c", "f8", 3),  # scratch
    ],
    align=True,
)
"""Working record; zeros are the initial state."""

BIRTH = np.dtype(
    [
        ("tick", "i8"),  # in which the shape was new, edited, or respawned with its body
        ("form", SHAPE),  # its geometry in the last tick
    ],
    align=True,
)
"""Tick of the last change of a shape."""

BEFORE = np.dtype(
    [
        ("position", "f8", 3),  # of the body's frame, world [m]
        ("rotation", "f8", (3, 3)),  # world from body
        ("spawn", "i8"),  # MOTION.spawn
    ],
    align=True,
)
"""Pose of a body in the last tick."""
