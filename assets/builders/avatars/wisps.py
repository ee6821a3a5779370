"""Wisps: flat strips with strands of hair as their texture, which soften the hairline and the outline of hair."""

from __future__ import annotations

import io
import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from assets.builders.avatars.draft import Draft
from assets.builders.avatars.fields import F8
from assets.builders.avatars.piece import Piece
from assets.builders.kit.lattice_noise import smooth_noise
from assets.builders.kit.rng import Rng

__all__ = ["WISPS", "WispRow", "make_wisps", "paint_wisps"]

_SIZE, _STRANDS, _STRIPS = 128, 40, 4
"""Side of the texture [texel], its strands, and the strips that share it side by side."""
_STEPS = 2
"""Quadrilaterals along a strip."""
_SEED = 71


@dataclass(frozen=True)
class WispRow:
    """Strips side by side around the head.

    Attributes:
        count: Of strips.
        between: Azimuths of the first and the last root [rad].
        share: Of roots and tips on the path from the crown (0) by the hairline (1) to the ends of long hair (2).
        beyond: How far the tips stand beyond the hairline [rad].
        lift: Height of roots and tips over the hair below [m].
        breadth: Of a strip [m].
        turn: Azimuth from root to tip [rad].
    """

    count: int
    between: tuple[float, float]
    share: tuple[float, float]
    beyond: float
    lift: tuple[float, float]
    breadth: float
    turn: float = 0.0


_ALL = (-math.pi, math.pi)
WISPS: dict[str, tuple[WispRow, ...]] = {
    "short": (
        WispRow(30, _ALL, (0.88, 1.0), 0.055, (0.0020, 0.0012), 0.020),
        WispRow(16, (-1.3, 1.3), (0.70, 0.42), 0.0, (0.0070, 0.0110), 0.022, 0.20),
        WispRow(16, (1.3, 5.0), (0.30, 0.55), 0.0, (0.0030, 0.0060), 0.024, 0.10),
    ),
    "crop": (
        WispRow(56, _ALL, (0.93, 1.0), 0.035, (0.0010, 0.0008), 0.013),
    ),
    "bob": (
        WispRow(14, (-0.9, 0.9), (0.86, 1.0), 0.060, (0.0040, 0.0030), 0.022, -0.08),
        WispRow(26, (1.0, 5.28), (1.62, 2.0), 0.0, (0.0030, 0.0020), 0.030),
        WispRow(24, _ALL, (0.45, 0.75), 0.0, (0.0020, 0.0045), 0.026, 0.12),
    ),
    "tail": (
        WispRow(44, (-1.45, 1.45), (1.0, 0.84), -0.030, (0.0006, 0.0022), 0.018),
        WispRow(24, (1.5, 4.78), (1.0, 0.86), -0.030, (0.0006, 0.0022), 0.020),
        WispRow(18, (-1.6, 1.6), (0.55, 0.35), 0.0, (0.0006, 0.0050), 0.020),
    ),
    "curls": (
        WispRow(64, _ALL, (0.95, 1.0), 0.030, (0.0010, 0.0010), 0.012, 0.03),
        WispRow(30, _ALL, (0.38, 0.42), 0.0, (-0.0010, 0.0065), 0.016, 0.06),
        WispRow(36, _ALL, (0.62, 0.67), 0.0, (-0.0010, 0.0065), 0.016, -0.06),
    ),
}  # fmt: skip
"""By style of hair."""

Path = Callable[[F8, F8, F8, F8], F8]
"""Gives places of hair [n, 3] by azimuth, share of the path, height and shift of the hairline upwards."""


def make_wisps(style: str, path: Path, held: Callable[[F8], F8], middle: F8, joints: int, seed: int) -> Piece:
    """Return the wisps of a style of hair; each is seen from both sides, so that the surface is closed.

    Args:
        style: Key of `WISPS`.
        path: Of the hair.
        held: Weights of places, [n, joints].
        middle: Of the head [m].
        joints: Number of joints.
        seed: Of their unevenness.
    """
    draft, rng = Draft(joints), Rng(seed, "wisps")
    shades: list[F8] = []
    for row in WISPS[style]:
        begin, end = row.between
        closed = math.isclose(end - begin, 2.0 * math.pi)
        for azimuth in np.linspace(begin, end, row.count, endpoint=not closed):
            loose, askew, tone = (rng.share() - 0.5 for _ in range(3))
            t = np.linspace(0.0, 1.0, _STEPS + 1)
            share = row.share[0] + (row.share[1] + 0.04 * loose - row.share[0]) * t
            lift = row.lift[0] + (row.lift[1] * (1.0 + 0.8 * loose) - row.lift[0]) * t
            across = float(azimuth) + 0.06 * askew + (row.turn + 0.10 * askew) * t
            line = path(across, np.maximum(share, 0.0), lift, -row.beyond * (1.0 + 0.6 * loose) * t)
            strip = math.floor(_STRIPS * rng.share() * 0.999)
            shades += _add(draft, line, middle, row.breadth, strip, held)
            shades[-1] *= 1.0 + 0.24 * tone
    piece = draft.finish("wisps", np.concatenate(shades))
    out = piece.places - middle
    return replace(piece, normals=out / np.linalg.norm(out, axis=1, keepdims=True), near=True)


def _add(draft: Draft, line: F8, middle: F8, breadth: float, strip: int, held: Callable[[F8], F8]) -> list[F8]:
    along = np.gradient(line, axis=0)
    beside = np.cross(along, line - middle)
    beside /= np.linalg.norm(beside, axis=1, keepdims=True)
    half = 0.5 * breadth * np.array([1.0, 1.0, 0.8])[:, None] * beside
    left, right = (strip + 0.02) / _STRIPS, (strip + 0.98) / _STRIPS
    for side in (False, True):  # one is the back of the other, with vertices of its own
        one, two = (draft.add(places, held(places)) for places in (line - half, line + half))
        for number, (i, j) in enumerate(itertools.pairwise(range(len(line)))):
            v = number / _STEPS, (number + 1) / _STEPS
            corners = (one[i], two[i], two[j], one[j])
            draft.face(corners, ((left, v[0]), (right, v[0]), (right, v[1]), (left, v[1])), flip=side)
    return [np.full((4 * len(line), 3), 0.92)]


def paint_wisps() -> bytes:
    """Return the PNG of strands that run down, dense above and single below; opacity is how much of them is hair."""
    from PIL import Image

    random = np.random.default_rng(_SEED)
    y, x = (np.mgrid[0:_SIZE, 0:_SIZE] + 0.5) / _SIZE
    alpha, tone = np.zeros((_SIZE, _SIZE)), np.full((_SIZE, _SIZE), 0.8)
    for number in range(_STRANDS):
        strip, place = divmod(number, _STRANDS // _STRIPS)
        wide = 1.0 / _STRIPS
        root = wide * (strip + 0.08 + 0.84 * (place + random.uniform(0.2, 0.8)) / (_STRANDS // _STRIPS))
        long, bend = random.uniform(0.45, 1.0), wide * random.uniform(-0.10, 0.10)
        shade, broad = random.uniform(0.62, 1.0), wide * random.uniform(0.05, 0.09)
        at = root + bend * y**2
        inside = np.clip(1.4 - np.abs(x - at) / (broad * np.clip(1.05 - y / long, 0.02, 1.0)), 0.0, 1.0) * (y < long)
        begins = np.clip(y / random.uniform(0.05, 0.20), 0.0, 1.0)
        tone = np.where(inside * begins > alpha, shade, tone)
        alpha = np.maximum(alpha, inside * begins)
    uneven = 0.85 + 0.3 * smooth_noise(_SIZE, _SIZE, 6, 40, _SEED)
    pixels = np.full((_SIZE, _SIZE, 4), 255.0)
    pixels[..., :3] = np.clip(205.0 * tone * uneven, 0.0, 255.0)[..., None]
    pixels[..., 3] = 255.0 * alpha
    stream = io.BytesIO()
    Image.fromarray(np.round(pixels).astype(np.uint8)).save(stream, "PNG", optimize=True)
    return stream.getvalue()
