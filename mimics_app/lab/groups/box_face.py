"""Rules for the face of a box, with their cost and error.

A point pressed 3 mm into a box slides towards its edge; the error is the largest difference [N] from a force along the
normal of the face of entry.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.lab.haptic.face_rules import cube_nearest_face
from mimics_app.lab.haptic.printed_equations import cube_printed
from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.rendering.haptic.kernels.contact import cube
from mimics_app.rendering.haptic.kernels.contact_records import CONTACT

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ContactRecord, Table

__all__ = ["false_force"]


_RIVALS = (
    Rival(
        "face of entry",
        "the face the point came in by, held until it leaves (Figure 27)",
        "any path; leaving by another face drops k d at once",
        {},
    ),
    Rival(
        "nearest face",
        "the face with the least depth of every tick",
        "away from edges: turns by a right angle where two faces are equally near",
    ),
    Rival("(14) printed", "min of |HIP'| - dim/2, which inside is the farthest face", "demonstration"),
)
"""In the order of their numbers."""

_NUMBERS = {rival.name: number for number, rival in enumerate(_RIVALS)}
_STIFFNESS = 2000.0  # [N/m]
_EDGES = (0.04, 0.04, 0.04)
_INWARD = np.array([0.0, 0.0, -0.008])


@kernel
def _touch(number: int, p: F8, v: F8, dimensions: F8, contact: ContactRecord) -> None:
    if number == 0:
        cube(p, v, dimensions, contact)
    elif number == 1:
        cube_nearest_face(p, dimensions, contact)
    else:
        cube_printed(p, dimensions, contact)


@kernel
def _slide(number: int, path: F8, v: F8, dimensions: F8, contacts: Table[ContactRecord], forces: F8) -> None:
    contact = contacts[0]
    for tick in range(path.shape[0]):
        _touch(number, path[tick], v, dimensions, contact)
        for i in range(3):
            forces[tick, i] = _STIFFNESS * contact.depth * contact.normal[i]


def _corner_path() -> F8:
    """Return a path: into the top to 3 mm in 1 s, then along x to 0.5 mm from the side; 8 and 4 um per tick."""
    down = np.linspace(0.025, 0.017, 1001)
    along = np.linspace(0.015, 0.0195, 1126)
    path = np.zeros((len(down) + len(along), 3))
    path[: len(down), 0], path[: len(down), 2] = along[0], down
    path[len(down) :, 0], path[len(down) :, 2] = along, down[-1]
    return path


def false_force(rule: str) -> float:
    """Return the largest difference [N] from the force of Figure 27, along the normal of the face of entry."""
    path = _corner_path()
    forces = np.zeros_like(path)
    _slide(_NUMBERS[rule], path, _INWARD, np.array(_EDGES), np.zeros(1, CONTACT), forces)
    forces[:, 2] -= _STIFFNESS * np.maximum(0.0, 0.5 * _EDGES[2] - path[:, 2])
    return float(np.max(np.linalg.norm(forces, axis=1)))


def _cost_us(rule: str) -> float:
    path = _corner_path()
    forces, contacts, edges = np.zeros_like(path), np.zeros(1, CONTACT), np.array(_EDGES)
    return shortest_us(lambda: _slide(_NUMBERS[rule], path, _INWARD, edges, contacts, forces), len(path))


compare(
    __name__,
    "depth and normal in a box of 4 cm; error: false force of a slide to the corner, 3 mm deep on 2 kN/m",
    "N",
    _RIVALS,
    Probes(_cost_us, false_force, reference_us),
    default="face of entry",
)
