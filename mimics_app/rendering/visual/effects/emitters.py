"""Particle emitters: their records for the kernels, and the births of the living particles."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.kernels.particles import BIRTH, EMITTER, SPRITE, BirthPlace, Series, fill_particles
from mimics_app.world.components.effects import Particles
from mimics_app.world.content.effects import Burst
from mimics_app.world.graph.entity_ids import grown

__all__ = ["Emitter", "SpriteRows"]


_NUMBERS_OF_BURST = 1 << 20
"""Particle numbers reserved per burst, more than it can have, so that no two particles share random numbers."""

_BURSTS_KEPT = 2
"""Simultaneous bursts whose births are all cached; with more, some are computed again in every frame."""


class SpriteRows:
    """Growing array of sprites, reused from frame to frame.

    Attributes:
        rows: SPRITE records, of which the first `count` are in use.
        count: Number of sprites.
    """

    def __init__(self) -> None:
        self.rows = np.zeros(256, SPRITE)
        self.count = 0

    def reserve(self, more: int) -> None:
        """Reserve space for more sprites."""
        self.rows = grown(self.rows, self.count + more)


class Emitter:
    """One particle emitter.

    Args:
        spec: Its component in the scene.
        seed: Seed of its particles, unsigned 64 bits.
        state: Number of their render state.
        layer: Layer of their texture.
    """

    def __init__(self, spec: Particles, seed: int, state: int, layer: int) -> None:
        self.spec = spec
        self._record = _record(spec, seed, state, layer)
        alive = spec.rate * spec.lifetime[1] if spec.trigger == "always" else _BURSTS_KEPT * spec.count
        self._births = np.zeros(max(1, min(spec.capacity, math.ceil(alive) + 1)), BIRTH)
        self._births["number"] = -1 << 62

    def fill(self, now: float, world_from_emitter: F8, bursts: Sequence[Burst], rows: SpriteRows) -> None:
        """Append the sprites of the living particles.

        Args:
            now: Time of the scene [s].
            world_from_emitter: Pose of the emitter, float64 [4, 4].
            bursts: Its bursts, oldest first.
            rows: Sprites to append to.
        """
        spec = self.spec
        if spec.trigger == "always":
            if spec.rate > 0.0:
                last = math.floor(now * spec.rate)
                first = max(math.ceil((now - spec.lifetime[1]) * spec.rate), last + 1 - spec.capacity)
                series = Series(first, last + 1 - first, first / spec.rate, 1.0 / spec.rate)
                self._add(series, now, world_from_emitter, rows)
            return
        left = spec.capacity
        for burst in reversed(bursts):
            count = min(spec.count, left)
            left -= count
            interval = spec.spread / max(spec.count, 1)
            number = burst.number * _NUMBERS_OF_BURST
            self._add(Series(number, count, burst.born_s, interval), now, burst.world_from_emitter, rows)

    def _add(self, series: Series, now: float, pose: F8, rows: SpriteRows) -> None:
        if series.births <= 0:
            return
        box = pose[:3, :3] * np.asarray(self.spec.box)
        corner = pose[:3, 3] - 0.5 * box.sum(axis=1)
        axes = axes_about(pose[:3, :3] @ np.asarray(self.spec.direction))
        rows.reserve(series.births)
        rows.count = fill_particles(
            self._record, self._births, series, now, BirthPlace(corner, box, axes), rows.rows, rows.count
        )


def axes_about(direction: F8) -> F8:
    """Return two unit vectors across a direction, and the unit direction, as columns; right-handed, float64 [3, 3]."""
    along = direction / np.linalg.norm(direction)
    helper = np.eye(3)[int(np.argmin(np.abs(along)))]
    across = np.cross(helper, along)
    across /= np.linalg.norm(across)
    return np.ascontiguousarray(np.stack([across, np.cross(along, across), along], axis=1))


def _record(spec: Particles, seed: int, state: int, layer: int) -> NDArray[np.void]:
    record = np.zeros(1, EMITTER)
    one = record[0]
    one["seed"] = seed
    for name in ("lifetime", "speed", "drag", "sway", "spin", "size", "aspect", "growth"):
        one[name] = getattr(spec, name)
    one["angles"] = 0.0 if spec.upright else 2.0 * math.pi
    one["cosine"] = math.cos(spec.cone)
    one["pull"] = np.asarray(spec.gravity) + spec.drag * np.asarray(spec.wind)
    one["sway_rate"] = 2.0 * math.pi * spec.sway_hz
    one["floor"] = -math.inf if spec.floor is None else spec.floor
    tints = spec.palette or ((1.0, 1.0, 1.0, 1.0),)
    one["colours"], one["tints"] = len(spec.colours), len(tints)
    one["colour"][: len(spec.colours)], one["tint"][: len(tints)] = spec.colours, tints
    one["tumbles"] = spec.shape == "paper" and spec.texture is None
    one["state"], one["style"] = state, (layer, spec.blend != "add", 0.0, spec.cutoff)
    return record
