"""Frame along the tunnel's bisector: methods with their cost and error."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.maths import frames

__all__ = ["Helix", "helix", "twist_between"]

Helix = tuple[F8, F8, F8, F8, F8]


_POINTS = 385  # two turns of a tunnel of 24 pieces, 16 steps each
_UP = np.array([0.0, 1.0, 0.0])


def helix(count: int, radius: float = 0.1, pitch: float = 0.08, turns: float = 2.0) -> Helix:
    """Return points along a helix around y and their exact frames.

    Returns:
        Points [m], first and second derivative by the angle, unit tangents, and rotation-minimising normals that start
        as the principal normal, each of shape [count, 3]. The normals lag the principal ones by torsion x arc length.
    """
    angle = np.linspace(0.0, 2.0 * np.pi * turns, count)
    rise = pitch / (2.0 * np.pi)
    cos, sin, zero = np.cos(angle), np.sin(angle), np.zeros(count)
    # Rotation around +y from x to z, left-handed: torsion = -rise / (radius^2 + rise^2).
    points = np.column_stack([radius * cos, rise * angle, radius * sin])
    first = np.column_stack([-radius * sin, np.full(count, rise), radius * cos])
    second = np.column_stack([-radius * cos, zero, -radius * sin])
    speed = np.hypot(radius, rise)
    tangents = first / speed
    principal = second / radius
    lag = -rise / speed**2 * speed * angle
    binormal = np.cross(tangents, principal)
    normals = np.cos(lag)[:, None] * principal - np.sin(lag)[:, None] * binormal
    return points, first, second, tangents, normals


def twist_between(tangents: F8, normals: F8, reference: F8) -> F8:
    """Return the angle around the tangents from reference normals to normals [rad], in -pi..pi, shape [m]."""
    along = np.sum(normals * reference, axis=1)
    across = np.sum(np.cross(reference, normals) * tangents, axis=1)
    return np.arctan2(across, along)


def _double_reflection(curve: Helix) -> F8:
    points, _, _, tangents, normals = curve
    return frames.rotation_minimising_normals(points, tangents, normals[0])


def _frenet(curve: Helix) -> F8:
    return frames.frenet_normals(curve[1], curve[2])


def _projected_up(curve: Helix) -> F8:
    return frames.projected_up_normals(curve[3], _UP)


def _error(normals_of: Callable[[Helix], F8]) -> float:
    """Return the largest angle around the tangent from the closed form, with equal initial normals [rad]."""
    curve = helix(_POINTS)
    twist = np.unwrap(twist_between(curve[3], normals_of(curve), curve[4]))
    return float(np.max(np.abs(twist - twist[0])))


def _cost_us(normals_of: Callable[[Helix], F8]) -> float:
    curve = helix(_POINTS)
    return shortest_us(lambda: normals_of(curve), _POINTS)


compare(
    __name__,
    f"normals along two turns of a helix at {_POINTS} points, against the closed form; cost per point",
    "rad",
    [
        Rival(
            "double reflection",
            "rotation-minimising frame (Wang, Juettler, Zheng & Liu 2008)",
            "any smooth curve; error of order 4 in the step",
            {},
            (_double_reflection,),
        ),
        Rival(
            "frenet",
            "principal normal (Frenet 1847, Serret 1851)",
            "curves without inflection or straight part; turns with the torsion",
            None,
            (_frenet,),
        ),
        Rival(
            "projected up",
            "world's up made square to the tangent",
            "curves that are nowhere vertical",
            None,
            (_projected_up,),
        ),
    ],
    Probes(_cost_us, _error),
    default="double reflection",
)
