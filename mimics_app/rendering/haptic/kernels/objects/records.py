"""Records of the objects in the loop other than their motion; those of contacts are in `contact_records`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS
from mimics_app.rendering.haptic.kernels.contact_records import CONTACT, FRICTION
from mimics_app.rendering.haptic.kernels.tunnel_state import TUNNEL_STATE

__all__ = [
    "DYNAMICS",
    "EFFECT_MEMORY",
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
        ("inverse", "f8", (3,)),  # reciprocals of the principal moments [1/(kg m^2)], 0: locked axis
        ("tensor", "f8", (3, 3)),  # scratch of `find_principal_axes`
        ("vectors", "f8", (3, 3)),  # scratch of `find_principal_axes`
        ("rest_force", "f8", (3,)),  # load without contacts of the last tick awake [N]
        ("rest_torque", "f8", (3,)),  # torque of that load [N m]
        ("placed", "i4"),  # 1: placed in this tick, its contacts are invalid
        ("stirred", "i4"),  # 1: in contact with a moving neighbour
    ],
    align=True,
)
"""Derived properties and load of one body."""

GRIP = np.dtype(
    [
        ("body", "i8"),  # row of the held body, -1: none
        ("spawn", "i8"),  # of that body when it was gripped; a respawned body is released
        ("crushed", "i8"),  # row of the body pressed beyond its crush_force in this grip, -1: none
        ("half_width", "f8"),  # of the body along the axis when it was gripped [m]
        ("offset", "f8"),  # of the body's centre from the grip's, along the axis; it decays to 0 [m]
        ("twist", "f8"),  # torsion of the contact patches about the axis [rad]
        ("contact_a", "f8", (3,)),  # contact point of the finger at -u, body frame [m]
        ("contact_b", "f8", (3,)),  # contact point of the finger at +u, body frame [m]
        ("friction_a", FRICTION),
        ("friction_b", FRICTION),
        # of this tick
        ("axis", "f8", (3,)),  # u, world, unit
        ("across", "f8", (2, 3)),  # two unit vectors that complete a right-handed frame
        ("centre", "f8", (3,)),  # between the fingers, world [m]
        ("velocity", "f8", (3,)),  # of that centre, world [m/s]
        ("low", "f8"),  # lowest coordinate of the body along u from the centre [m]
        ("high", "f8"),  # highest coordinate [m]
        ("place", "f8", (3,)),  # scratch: a contact point, from the body's centre of mass, world [m]
        ("moving", "f8", (3,)),  # scratch: its velocity against the hand [m/s]
        ("force", "f8", (3,)),  # scratch: of one finger on the body [N]
        ("shift", "f8", (2,)),  # scratch: displacement perpendicular to the axis [m]
        ("hold", "f8", (2,)),  # scratch: friction perpendicular to the axis [N]
    ],
    align=True,
)
"""Grip of one point of contact, as of a hand; the fields before `axis` are kept from tick to tick."""

TRACKING = np.dtype(
    [
        # revision + 1 of the rows at the last update by each kernel; 0: never
        ("placed_revision", "i8"),  # place_bodies
        ("posed_revision", "i8"),  # pose_shapes
        ("paired_revision", "i8"),  # collide_bodies
        ("moving", "i8"),  # number of entries of `moving_shapes` in use
        ("turn", "f8", (4,)),  # scratch: a quaternion
    ],
    align=True,
)
"""Revisions of the rows at their last update: unchanged rows are not processed again."""

MEMORY = np.dtype(
    [
        ("contact", CONTACT),  # depth, normal, feature of entry, last position, in the shape's frame
        ("anchor", "f8", 3),  # of friction, shape's frame [m]
        ("touching", "u1"),  # 1: the anchor is set
        ("sticking", "u1"),  # 1: friction stuck in the last tick
        ("tick", "i8"),  # of the last contact test
    ],
    align=True,
)
"""Contact memory of one (point, shape); zeros are the initial state."""

MAX_WALLS = 8
"""Largest number of walls of a corner; the forces of further walls are added."""

WALL_TOUCH = np.dtype(
    [
        ("row", np.int64),  # of the shape
        ("depth", np.float64),  # [m]
        ("lowered", "f8"),  # depth less the rippled depth [m]
        ("rate", np.float64),  # of the depth [m/s]
        ("normal", np.float64, 3),  # world, unit
        ("direction", np.float64, 3),  # of its stiffness, world, unit: see corner.orthogonalise
        ("slope", np.float64, 3),  # of its ripple, in its frame [-]
    ],
    align=True,
)
"""One wall touched by a point."""

SOLID = np.dtype(
    [
        ("kind", "i4"),  # of SHAPE
        ("body", "i4"),
        ("enabled", "i4"),
        ("mesh", "i4"),
        ("size", "f8", (3,)),
        ("rounding", "f8"),
        ("radius", "f8"),  # of the bounding sphere about its origin [m]
        ("local", "f8", (3, 3)),  # body from shape
        ("rotation", "f8", (3, 3)),  # world from shape
        ("position", "f8", (3,)),  # of its origin, world [m]
        ("low", "f8", (3,)),  # minimum of its AABB, world [m]
        ("high", "f8", (3,)),  # maximum of its AABB, world [m]
        ("fat_low", "f8", (3,)),  # minimum of its fat AABB: while the AABB is inside, pairs are valid [m]
        ("fat_high", "f8", (3,)),  # maximum of its fat AABB [m]
    ],
    align=True,
)
"""One shape in the collisions: all properties a pair test needs, contiguous in memory."""

MAX_CONTACT_POINTS = 24
"""Capacity of a table of contact points: two octagons intersect in at most 16 corners."""

PAIR = np.dtype(
    [
        ("a", "i4"),  # rows of SHAPE
        ("b", "i4"),
        ("body_a", "i4"),  # rows of BODY, or STATIC
        ("body_b", "i4"),
        ("kept", "i4"),  # 1: found again by the sweep
        ("law", "i4"),  # ForceLaw
        ("slot", "i8"),  # in the hash
        # joint properties of both surfaces
        ("stiffness", "f8"),  # k_s [N/m], [N/m^n]
        ("damping", "f8"),  # b_s [N s/m], or a of Hunt and Crossley [s/m]
        ("exponent", "f8"),
        ("friction_static", "f8"),
        ("friction_dynamic", "f8"),
        ("friction_stiffness", "f8"),  # [N/m]
        ("friction_damping", "f8"),  # [N s/m], of the spring-damper law
        # state of the contact
        ("normal", "f8", (3,)),  # unit, from a to b, world; zero: no contact yet
        ("stretch", "f8", (3,)),  # of the spring from the friction's anchor to the contact [m]
        ("twist", "f8"),  # torsion of the contact patch about the normal [rad]
        ("share", "f8"),  # touching share of the stiffness, smoothed [-]
        ("force", "f8"),  # normal force of the last tick [N]
        ("rest_force", "f8"),  # normal force of the last tick with both bodies awake [N]
        ("feature", "i4"),  # separating axis of two boxes, 0: none
        ("touching", "i4"),  # 1: in contact in the last tick
        ("sticking", "i4"),  # 1: friction sticks
        ("ticks_apart", "i4"),  # since the last contact
    ],
    align=True,
)
"""Two shapes that may touch, and their contact."""

SCRATCH = np.dtype(
    [
        ("feature_a", "f8", (8, 3)),  # corners, world [m]
        ("feature_b", "f8", (8, 3)),  # corners, world [m]
        ("polygon", "f8", (3, 24, 2)),  # both features in the plane of contact, and the result of a clip [m]
        ("points", "f8", (MAX_CONTACT_POINTS, 5)),  # of contact, see `manifold`
        ("simplex", "f8", (4, 3)),  # of GJK [m]
        ("cosines", "f8", (3, 3)),  # between the axes of two boxes
        ("normals", "f8", (MAX_CONTACT_POINTS, 3)),  # of the points of a contact with a mesh
        ("mesh_point", "f8", (3,)),  # mesh frame [m]
        ("mesh_closest", "f8", (3,)),  # mesh frame [m]
        ("mesh_normal", "f8", (3,)),  # mesh frame
    ],
    align=True,
)
"""Working memory of the collision of one pair."""

SWEEP = np.dtype(
    [
        ("pairs", "i8"),  # in use
        ("sorted", "i8"),  # shapes in the order
        ("walls", "i8"),  # at the end of the order's array
        ("axis", "i8"),  # 0, 1, 2: world axis of the sweep
        ("left_out", "i8"),  # pairs beyond the capacity of the table
        ("most_left_out", "i8"),  # largest left_out so far
        ("remade", "i8"),  # number of sweeps so far
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
        ("hull_corners", "i8"),  # vertices of the convex hull; 0: no body carries the mesh
        ("first_edge", "i8"),
        ("edges", "i8"),  # sharp edges; 0: no body carries the mesh
    ],
    align=True,
)
"""Rows of one mesh in the tables."""

RIDGES = np.dtype(
    [
        ("first_ridge", "i8"),
        ("ridges", "i8"),
        ("first_node", "i8"),
        ("leaves", "i8"),
    ],
    align=True,
)
"""Rows of the ridges of one mesh in the tables."""


def new_grip() -> NDArray[np.void]:
    """Initial grips of all points of contact, without a body, shape [MAX_CONTACTS]."""
    grip = np.zeros(MAX_CONTACTS, GRIP)
    grip["body"] = -1
    grip["crushed"] = -1
    return grip


EFFECT_MEMORY = np.dtype(
    [
        # inputs of this tick: the values of its row plus those of wires
        ("position", "f8", (3,)),  # as EFFECT.position
        ("size", "f8"),  # as EFFECT.force [N]
        ("stiffness", "f8"),  # [N/m] >= 0
        # kept from tick to tick
        ("quarantined", "i8"),  # 1: its field gave a number that is not finite
        ("sticking", "i8"),  # 1 while stick-slip holds
        ("anchor", "f8", (3,)),  # of stick-slip, from its place; in the frame of the body if it has one [m]
        ("path", TUNNEL_STATE),  # closest point of its path
        # of this tick
        ("p", "f8", (3,)),  # position of the hand or of the body acted on, from the place, world [m]
        ("v", "f8", (3,)),  # the same for the velocity [m/s]
        ("arm", "f8", (3,)),  # from the body's centre of mass to the place [m]
        ("force", "f8", (3,)),  # on the hand or on the body acted on, world [N]
        ("damper", "f8", (3,)),  # scratch
        ("held", "i8"),  # 1 while its spring or damper acts: it counts towards the stability limit
    ],
    align=True,
)
"""State of one effect; zeros are the initial state."""
