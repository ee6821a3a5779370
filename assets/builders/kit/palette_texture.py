"""Textures of few colours: every texel is a tone on one of up to sixteen ramps from dark to light."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from assets.builders.kit.lattice_noise import hash_noise, pixels
from assets.builders.kit.png_writer import write_indexed_png
from mimics_app.contracts.arrays import F8

__all__ = ["Canvas", "Ramp", "Rgb"]

Rgb = tuple[int, int, int]
Ramp = tuple[Rgb, Rgb]


class Canvas:
    """A texture under construction.

    Args:
        width: [pixels].
        height: [pixels].
        ramps: sRGB colours, darkest and lightest of each ramp, 16 at most.

    Attributes:
        ramp: Index of each pixel's ramp, uint8 [height, width].
        tone: Of each pixel, 0 dark to 1 light, float64 [height, width].
        clear: True where nothing is drawn, bool [height, width].
    """

    def __init__(self, width: int, height: int, ramps: Sequence[Ramp]) -> None:
        self._ramps = ramps
        self._levels = 256 // (len(ramps) + 1) if len(ramps) > 1 else 255
        self.ramp = np.zeros((height, width), np.uint8)
        self.tone: F8 = np.full((height, width), 0.5)
        self.clear = np.zeros((height, width), np.bool_)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [pixels]."""
        height, width = self.ramp.shape
        return width, height

    def rectangle(
        self, left: int, top: int, right: int, bottom: int, ramp: int, tone: float | tuple[float, float] = 0.5
    ) -> None:
        """Fill pixels [left, right) x [top, bottom); two tones make a gradient from top to bottom."""
        rows = slice(max(top, 0), max(bottom, 0))
        columns = slice(max(left, 0), max(right, 0))
        self.ramp[rows, columns] = ramp
        if isinstance(tone, tuple):
            steps = np.arange(rows.start, rows.stop) - top
            self.tone[rows, columns] = (tone[0] + (tone[1] - tone[0]) * (steps + 0.5) / (bottom - top))[:, None]
        else:
            self.tone[rows, columns] = tone
        self.clear[rows, columns] = False

    def shade(self, factor: F8 | float, where: NDArray[np.bool_] | None = None) -> None:
        """Multiply tones."""
        self.tone = self.tone * factor if where is None else np.where(where, self.tone * factor, self.tone)

    def grain(self, strength: float, seed: int) -> None:
        """Add white noise."""
        self.tone = self.tone + strength * (hash_noise(*pixels(*self.size), seed) - 0.5)

    def to_png(self) -> bytes:
        """Return the texture as a PNG file with a palette."""
        levels = self._levels
        dither = hash_noise(*pixels(*self.size), 1)
        level = np.clip(np.floor(self.tone * (levels - 1) + dither), 0, levels - 1).astype(np.int64)
        index = self.ramp.astype(np.int64) * levels + level
        palette = np.zeros((len(self._ramps) * levels + 1, 4), np.uint8)
        palette[:, 3] = 255
        for number, (dark, light) in enumerate(self._ramps):
            for step in range(levels):
                colour = [low + (high - low) * step // (levels - 1) for low, high in zip(dark, light, strict=True)]
                palette[number * levels + step, :3] = colour
        if not self.clear.any():
            return write_indexed_png(index.astype(np.uint8), palette[:-1, :3])
        palette[-1, :3], palette[-1, 3] = palette[levels // 2, :3], 0  # the edge fades into its own colour
        index[self.clear] = len(palette) - 1
        return write_indexed_png(index.astype(np.uint8), palette)
