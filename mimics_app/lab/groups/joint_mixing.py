"""Mixing of joints in skinning, with its cost and the loss of volume.

Probe: a tube whose lower half is rotated around its axis.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.lab.visual.skinned_figure import RIGID, SIZES, VERTICES, bend_by_loops, cost_of_call, dual_quaternions
from mimics_app.world.content.meshes.deform import VertexWeights
from mimics_app.world.content.motion.posing import mix_duals, mix_matrices
from mimics_app.world.content.motion.skinned_body import Skinning

__all__: list[str] = []


_TWIST = math.radians(150.0)


def _ring_left(skinning: Skinning, twist: float) -> float:
    """Return the relative radius of the central ring of a tube whose ends are rotated by a twist [rad].

    By matrices it is cos(twist / 2), by dual quaternions 1.
    """
    angles = np.linspace(0.0, 2.0 * math.pi, 32, endpoint=False)
    ring = np.stack([np.cos(angles), 0.0 * angles, np.sin(angles)], axis=1)
    weights = VertexWeights(np.tile(np.array([0, 1], np.uint16), (32, 1)), np.full((32, 2), 0.5, np.float32))
    rows = np.zeros((2, 3, 4))
    rows[0, :, :3] = np.eye(3)
    c, s = math.cos(twist), math.sin(twist)
    rows[1, :, :3] = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]
    if skinning == "linear":
        moved = mix_matrices(ring, weights, rows)
    else:
        moved = mix_duals(
            ring, weights, dual_quaternions(np.concatenate([rows, np.tile([[[0.0, 0.0, 0.0, 1.0]]], (2, 1, 1))], 1))
        )
    return float(np.linalg.norm(moved[:, [0, 2]], axis=1).mean())


compare(
    __name__,
    "vertices after four joints; error: radius lost half way along a tube that is twisted by 150 degrees",
    "of the radius",
    [
        Rival(
            "matrices",
            "mean of matrices (glTF 2.0 3.7.3); the ring closed form cos(angle / 2)",
            "any",
            {"skinning": "linear"},
            ("linear",),
        ),
        Rival(
            "dual quaternions",
            "mean of dual quaternions (Kavan et al. 2008)",
            f"{RIGID}; else matrices are mixed",
            {"skinning": "dual"},
            ("dual",),
        ),
    ],
    Probes(partial(cost_of_call, bend_by_loops), lambda skinning: 1.0 - _ring_left(skinning, _TWIST)),
    default="matrices",
    growth=Growth(work="vertices", sizes=SIZES, typical=VERTICES),
    few="what else keeps the volume needs weights or centres that no file brings",
)
