"""Occlusion by boxes between a source and the listener: diffraction around edges and transmission through walls.

Diffraction: Maekawa (1968), attenuation 10 log10(3 + 20 N) dB, N = 2 (detour) / wavelength; N is negative outside the
shadow, so that the gain is continuous. Transmission: the field-incidence mass law, 20 log10(f m) - 47 dB. The louder of
the two counts; five rays to points around the source model its extent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.shared_memory.sound_scene import BANDS, SOUND_SPEED

__all__ = ["BAND_HZ", "Box", "diffraction_db", "passes_of", "transmission_db"]


BAND_HZ = (250.0, 1400.0, 6000.0)
"""Representative frequency of each band [Hz]."""

_SPREAD = 0.25  # distance of the other four ray ends from the source [m]
_WAVELENGTHS = SOUND_SPEED / np.array(BAND_HZ)

# The twelve edges of the box [-1, 1]^3: one end of each and the axis it is parallel to.
_EDGES = [
    (np.insert(np.array([i, j]), axis, -1.0), axis) for axis in range(3) for i in (-1.0, 1.0) for j in (-1.0, 1.0)
]

# Pairs of edges a path may bend over: one edge twice, or two parallel edges of a face.
_TURNS = [
    (i, j)
    for i, (one, axis) in enumerate(_EDGES)
    for j, (other, along) in enumerate(_EDGES)
    if axis == along and np.count_nonzero(one != other) <= 1
]


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """An obstacle.

    Attributes:
        world_from_box: Pose, shape [4, 4].
        half: Half extents [m], shape [3].
        surface_mass: Mass per area of its wall [kg/m^2].
    """

    world_from_box: F8
    half: F8
    surface_mass: float


def transmission_db(surface_mass: float) -> F8:
    """Return the transmission loss of a wall per band [dB], at least 0."""
    return np.maximum(0.0, 20.0 * np.log10(np.array(BAND_HZ) * surface_mass) - 47.0)


def diffraction_db(detour: float | F8) -> F8:
    """Return the diffraction loss per band [dB] for a detour [m], negative where the source is visible."""
    fresnel = 2.0 * np.asarray(detour)[..., None] / _WAVELENGTHS
    return np.asarray(10.0 * np.log10(np.maximum(1.0, 3.0 + 20.0 * fresnel)))


def passes_of(listener: F8, source: F8, boxes: list[Box]) -> F8:
    """Return the linear gain per band past the boxes, shape [BANDS]; positions in the world [m], shape [3]."""
    total = np.ones(BANDS)
    for box in boxes:
        through = 10.0 ** (-transmission_db(box.surface_mass) / 10.0)
        energy = np.zeros(BANDS)
        targets = _around(listener, source)
        for target in targets:
            around = 10.0 ** (-diffraction_db(_detour(listener, target, box)) / 10.0)
            energy += np.maximum(around, through) / len(targets)
        total *= np.sqrt(energy)
    return total


def _around(listener: F8, source: F8) -> list[F8]:
    """Return the source and four points around it, perpendicular to the direct path."""
    between = source - listener
    distance = float(np.linalg.norm(between))
    if distance < _SPREAD:
        return [source]
    least = np.eye(3)[int(np.argmin(np.abs(between)))]
    across = np.cross(between, least)
    across *= _SPREAD / np.linalg.norm(across)
    other = np.cross(between / distance, across)
    return [source, source + across, source - across, source + other, source - other]


def _detour(listener: F8, source: F8, box: Box) -> float:
    """Return by how much the shortest path around the box exceeds the direct one [m]; negative where that is free."""
    turn, place = box.world_from_box[:3, :3], box.world_from_box[:3, 3]
    scale = np.linalg.norm(turn, axis=0)
    a, b = ((point - place) @ (turn / scale) for point in (listener, source))
    half = box.half * scale
    straight = _length(a, b)
    points = _bends(a, b, half)
    if not _hits(a, b, half):
        return straight - min(_length(a, p) + _length(p, b) for p in points)
    from_a, to_b = ([not _cut(end, p, half) for p in points] for end in (a, b))
    return (
        min(
            (
                _length(a, points[i]) + _length(points[i], points[j]) + _length(points[j], b)
                for i, j in _TURNS
                if from_a[i] and to_b[j]
            ),
            default=straight + float(half.sum()),
        )
        - straight
    )


def _length(a: F8, b: F8) -> float:
    return float(np.linalg.norm(b - a))


def _bends(a: F8, b: F8, half: F8) -> list[F8]:
    """Return on each edge the point over which the path from a to b is shortest."""
    points = []
    for corner, axis in _EDGES:
        start = corner * half
        across = [k for k in range(3) if k != axis]
        from_a, from_b = (float(np.linalg.norm((start - point)[across])) for point in (a, b))
        share = from_a / (from_a + from_b) if from_a + from_b > 0.0 else 0.5
        point = start.copy()
        point[axis] = np.clip(a[axis] + share * (b[axis] - a[axis]), -half[axis], half[axis])
        points.append(point)
    return points


def _hits(a: F8, b: F8, half: F8) -> bool:
    """Return whether the segment from a to b intersects the box (slab test)."""
    between = b - a
    with np.errstate(divide="ignore", invalid="ignore"):
        near, far = (-half - a) / between, (half - a) / between
    low = np.where(between == 0.0, np.where(np.abs(a) <= half, -np.inf, np.inf), np.minimum(near, far))
    high = np.where(between == 0.0, np.where(np.abs(a) <= half, np.inf, -np.inf), np.maximum(near, far))
    return bool(max(low.max(), 0.0) < min(high.min(), 1.0))


def _cut(a: F8, b: F8, half: F8) -> bool:
    """Like `_hits` for a segment that ends on an edge of the box: tests a slightly smaller box."""
    return _hits(a, b, half * (1.0 - 1e-6))
