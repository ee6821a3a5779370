"""Bodies under the clothes as the product reads them: measures, and the rings of the skin that have the girths."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np

from assets.builders.avatars.cage import make_cage
from assets.builders.avatars.fields import F8
from assets.builders.avatars.flesh import make_flesh
from assets.builders.avatars.measures import measure, tape
from assets.builders.avatars.person import EVERYBODY, Person
from assets.builders.avatars.sheet import I8, triangles_of
from assets.builders.avatars.skeleton import make_skeleton

__all__ = ["write_bodies"]

_REST = 0.081 + 2 * (0.006 + 0.0145)
"""Share of head and neck, hands and feet in the mass of a body (Dempster 1955, in Winter 2009, table 4.1)."""
_DENSITY = 1000.0
"""Of a body with air in its lungs [kg/m^3]."""
_BICEPS_ROW = 3
"""Row of an arm where the biceps is thickest."""


def write_bodies() -> bytes:
    """Return the table of all people's bodies, JSON: by name sex, age, mass, lengths [m], and rings [m] by girth."""
    rows = {person.name: _body(person) for person in EVERYBODY}
    lines = ",\n".join(f"  {json.dumps(name)}: {json.dumps(row)}" for name, row in rows.items())
    return f"{{\n{lines}\n}}\n".encode()


def _body(person: Person) -> dict[str, object]:
    bones = make_skeleton(person)
    cage = make_cage(person, bones, make_flesh(person, bones))
    found = measure(person, bones, cage)
    trunk, leg, arm = cage.trunk, cage.legs[1], cage.arms[1]
    rings = {
        "neck": trunk[-1],
        "chest": _chosen(max, cage.places, trunk[9:12]),
        "waist": trunk[6],
        "hip": _chosen(max, cage.places, trunk[1:4]),
        "thigh": leg[2],
        "calf": _chosen(max, cage.places, leg[8:12]),
        "ankle": _chosen(min, cage.places, leg[-3:]),
        "biceps": arm[_BICEPS_ROW],
        "wrist": _chosen(min, cage.places, arm[-2:]),
    }
    lengths = {name: round(value, 4) for name, value in found.items() if name not in rings}
    corners = cage.places - cage.places.mean(axis=0)  # wrists, ankles and neck are open: closed to their midpoints
    volume = _volume(corners, triangles_of(cage.faces, corners))
    ends = [trunk[-1], *(limbs[side][-1] for limbs in (cage.arms, cage.legs) for side in (1, -1))]
    volume += sum(_cap(corners[ring]) for ring in ends)
    return {
        "sex": "f" if person.body.woman else "m",
        "age": person.years,
        "mass": round(_DENSITY * volume / (1.0 - _REST), 1),
        "lengths": lengths | {"foot": person.body.foot},
        "rings": {name: np.round(cage.places[ring], 4).tolist() for name, ring in rings.items()},
    }


def _chosen(choose: Callable[..., I8], places: F8, rings: I8) -> I8:
    """Return the ring with the longest (max) or shortest (min) tape."""
    return choose(rings, key=lambda ring: tape(places[ring]))


def _volume(places: F8, triangles: I8) -> float:
    a, b, c = (places[triangles[:, i]] for i in range(3))
    return float((a * np.cross(b, c)).sum()) / 6.0


def _cap(ring: F8) -> float:
    """Return the volume between the origin and a ring that is closed to its midpoint, outwards positive [m^3]."""
    around = np.roll(ring, -1, axis=0)
    middle = ring.mean(axis=0)
    return abs(float((middle * np.cross(ring, around)).sum()) / 6.0)
