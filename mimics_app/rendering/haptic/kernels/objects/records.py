"""What the loop keeps of the objects beside their motion: records only, see `contact_records`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.haptic.kernels.contact_records import CONTACT, FRICTION

__all__ = [
    "DYNAMICS",
    "GRIP",
    "MAX_CONTACT_POINTS",
    "MAX_WALLS",
    "MEMORY",
    "MESH",
    "PAIR",
    "RIDGES",
    "SCRATCH",
    "SOLID",
    "SWEEP",
    "TRACKING",
    "WALL_TOUCH",
    "new_grip",
]

DYNAMICS = np.dtype(
    [
        ("inertia", "f8", (3, 3)),  # BODY.inertia as last seen [kg m^2]
        ("axes", "f8", (4,)),  # body from principal axes, xyzw
        ("inverse", "f8", (3,)),  # reciprocals of the principal moments [1/(kg m^2)], 0: does not turn about that axis
        ("tensor", "f8", (3, 3)),  # room for `find_principal_axes`
        ("vectors", "f8", (3, 3)),
        ("rest_force", "f8", (3,)),  # all that pulled when it fell asleep, but contacts [N]
        ("rest_torque", "f8", (3,)),  # likewise [N m]
        ("placed", "i4"),  # 1: put in its place in this tick, contacts are to be forgotten
        ("stirred", "i4"),  # 1: a neighbour that moves touches it
    ],
    align=True,
)
"""What the loop derives of one body."""

GRIP = np.dtype(
    [
        ("body", "i8"),  # row of the body held, -1: none
        ("spawn", "i8"),  # of that body when it was taken; another one lets go
        ("crushed", "i8"),  # row of the body pressed beyond its crush_force in this grip, -1: none
        ("half_width", "f8"),  # of the body along the axis when it was taken [m]
        ("offset", "f8"),  # of its middle from the hand's, along the axis; the closing fingers bring it to 0 [m]
        ("twist", "f8"),  # angle about the axis that the patches of contact hold [rad]
        ("contact_a", "f8", (3,)),  # where the finger at -u sticks, body frame [m]
        ("contact_b", "f8", (3,)),  # where the finger at +u sticks
        ("friction_a", FRICTION),
        ("friction_b", FRICTION),
        # of this tick
        ("axis", "f8", (3,)),  # u, world, unit
        ("across", "f8", (2, 3)),  # two unit vectors that make it a right-handed frame
        ("centre", "f8", (3,)),  # between the fingers, world [m]
        ("velocity", "f8", (3,)),  # of the hand [m/s]
        ("low", "f8"),  # extent of the body along u from the hand's middle [m]
        ("high", "f8"),
        ("place", "f8", (3,)),  # scratch: a contact point, from the body's centre of mass, world
        ("moving", "f8", (3,)),  # scratch: its velocity against the hand
        ("force", "f8", (3,)),  # scratch: of one finger on the body
        ("shift", "f8", (2,)),  # scratch: across the axis
        ("hold", "f8", (2,)),  # scratch
    ],
    align=True,
)
"""One hand's grip. The first eleven fields outlive a tick."""

TRACKING = np.dtype(
    [
        # revision + 1 of the rows as each of these last saw them; 0: never
        ("placed_revision", "i8"),  # place_bodies
        ("posed_revision", "i8"),  # pose_shapes
        ("paired_revision", "i8"),  # collide_bodies
        ("moving", "i8"),  # shapes of bodies: so many of `moving_shapes` count
        ("turn", "f8", (4,)),  # room for one quaternion
    ],
    align=True,
)
"""What is kept from tick to tick so that only what can have changed is computed again."""

MEMORY = np.dtype(
    [
        ("contact", CONTACT),  # depth, normal, feature of entry, last place, in the shape's frame
        ("anchor", "f8", 3),  # where friction holds the point, shape's frame [m]
        ("touching", "u1"),  # the anchor is set
        ("sticking", "u1"),  # friction held in the last tick
        ("tick", "i8"),  # in which the shape was last looked at
    ],
    align=True,
)
"""Memory of one (point, shape); zeros are a fresh one."""

MAX_WALLS = 8
"""Walls that one point may touch at once and still have their corner solved; forces of more are added."""

WALL_TOUCH = np.dtype(
    [
        ("row", np.int64),  # of the shape
        ("depth", np.float64),  # [m]
        ("rate", np.float64),  # of the depth [m/s]
        ("normal", np.float64, 3),  # world, unit
        ("direction", np.float64, 3),  # world, unit, along which its stiffness counts: see part_walls
        ("slope", np.float64, 3),  # of its ripple, in its frame [-]
    ],
    align=True,
)
"""One wall that a point touches."""

SOLID = np.dtype(
    [
        ("kind", "i4"),  # of SHAPE
        ("body", "i4"),
        ("enabled", "i4"),
        ("mesh", "i4"),
        ("size", "f8", (3,)),
        ("rounding", "f8"),
        ("radius", "f8"),  # of the sphere about its origin that holds it [m]
        ("local", "f8", (3, 3)),  # body from shape
        ("rotation", "f8", (3, 3)),  # world from shape
        ("position", "f8", (3,)),  # of its origin, world [m]
        ("low", "f8", (3,)),  # bounds along the world's axes [m]
        ("high", "f8", (3,)),
        ("fat_low", "f8", (3,)),  # bounds within which it may move until pairs are looked for again
        ("fat_high", "f8", (3,)),
    ],
    align=True,
)
"""One shape as the collisions see it: all that a test of two needs, in one place of memory."""

MAX_CONTACT_POINTS = 24
"""Rows of a table of contact points: two octagons overlap in 16 corners at most."""

PAIR = np.dtype(
    [
        ("a", "i4"),  # rows of SHAPE
        ("b", "i4"),
        ("body_a", "i4"),  # rows of BODY, or STATIC
        ("body_b", "i4"),
        ("kept", "i4"),  # 1: found again by the sweep
        ("law", "i4"),  # ForceLaw
        ("slot", "i8"),  # where the hash has it
        # both surfaces as one
        ("stiffness", "f8"),  # k_s [N/m], [N/m^n]
        ("damping", "f8"),  # b_s [N s/m], or a of Hunt and Crossley [s/m]
        ("exponent", "f8"),
        ("friction_static", "f8"),
        ("friction_dynamic", "f8"),
        ("friction_stiffness", "f8"),  # [N/m]
        ("friction_damping", "f8"),  # [N s/m], of the spring-damper law
        # memory of the contact
        ("normal", "f8", (3,)),  # unit, from a to b, world; zero: they have never met
        ("stretch", "f8", (3,)),  # of the spring from the friction's anchor to the contact [m]
        ("twist", "f8"),  # angle that the patch of contact holds about the normal [rad]
        ("share", "f8"),  # of the stiffness that touches, smoothed
        ("force", "f8"),  # normal force of the last tick [N]
        ("rest_force", "f8"),  # likewise, of the last tick that both were awake
        ("feature", "i4"),  # axis of two boxes
        ("touching", "i4"),
        ("sticking", "i4"),
        ("ticks_apart", "i4"),
    ],
    align=True,
)
"""Two shapes that may touch."""

SCRATCH = np.dtype(
    [
        ("feature_a", "f8", (8, 3)),  # world [m]
        ("feature_b", "f8", (8, 3)),
        ("polygon", "f8", (3, 24, 2)),  # of both in the plane, and the third to clip into
        ("points", "f8", (MAX_CONTACT_POINTS, 5)),  # of contact
        ("simplex", "f8", (4, 3)),
        ("cosines", "f8", (3, 3)),
        ("normals", "f8", (MAX_CONTACT_POINTS, 3)),
        ("mesh_point", "f8", (3,)),
        ("mesh_closest", "f8", (3,)),
        ("mesh_normal", "f8", (3,)),
    ],
    align=True,
)
"""Room for one pair at a time."""

SWEEP = np.dtype(
    [
        ("pairs", "i8"),  # in use
        ("sorted", "i8"),  # shapes in the order
        ("walls", "i8"),  # at the end of the order's array
        ("axis", "i8"),  # 0, 1, 2: along which is swept
        ("left_out", "i8"),  # pairs the table had no room for
        ("most_left_out", "i8"),  # most of them so far
        ("remade", "i8"),  # times the list was made
    ],
    align=True,
)
"""State of the sweep."""

MESH = np.dtype(
    [
        ("first_triangle", "i8"),
        ("triangles", "i8"),
        ("first_node", "i8"),
        ("leaves", "i8"),
        ("closed", "i8"),  # 1: every edge has two triangles, so that there is an inside
        ("first_hull", "i8"),
        ("hull_corners", "i8"),  # 0: no body carries it
        ("first_edge", "i8"),
        ("edges", "i8"),  # sharp ones; 0: no body carries it
    ],
    align=True,
)
"""Where one mesh lies in the tables."""

RIDGES = np.dtype(
    [
        ("first_ridge", "i8"),
        ("ridges", "i8"),
        ("first_node", "i8"),
        ("leaves", "i8"),
    ],
    align=True,
)
"""Where the ridges of one mesh lie in theirs."""


def new_grip() -> NDArray[np.void]:
    """A hand that holds nothing, shape [1]."""
    grip = np.zeros(1, GRIP)
    grip["body"] = -1
    grip["crushed"] = -1
    return grip
