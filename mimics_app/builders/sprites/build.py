"""The pictures of scenes/examples/billboards_and_particles.json and scenes/examples/decals.json."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image

__all__ = ["compose"]

F8 = NDArray[np.float64]


def places(size: int) -> tuple[F8, F8]:
    """Coordinates of texel centres, -1 to 1, x to the right and y up."""
    y, x = (np.mgrid[0:size, 0:size] + 0.5) / (0.5 * size) - 1.0
    return x, -y


def smooth(low: float, high: float, value: F8) -> F8:
    """0 below `low`, 1 above `high`, smooth between."""
    share = np.clip((value - low) / (high - low), 0.0, 1.0)
    return np.asarray(share * share * (3.0 - 2.0 * share))


def noise(size: int, seed: int, octaves: int = 5) -> F8:
    """Clouds of 0 to 1 that repeat at the border."""
    random, total = np.random.default_rng(seed), np.zeros((size, size))
    for octave in range(octaves):
        cells = 4 << octave
        grid = random.random((cells, cells))
        at = np.arange(size) * cells / size
        low, mix = at.astype(int), smooth(0.0, 1.0, at % 1.0)
        high = (low + 1) % cells
        across = grid[:, low] * (1.0 - mix) + grid[:, high] * mix
        total += 0.5**octave * (across[low] * (1.0 - mix[:, None]) + across[high] * mix[:, None])
    return np.asarray((total - total.min()) / np.ptp(total))


def pack(colour: F8, cover: F8) -> bytes:
    """A PNG file of colour [h, w, 3] as display values and opacity [h, w], 0 to 1."""
    pixels, file = np.concatenate([colour, cover[..., None]], axis=-1), io.BytesIO()
    Image.fromarray(np.round(255.0 * np.clip(pixels, 0.0, 1.0)).astype(np.uint8)).save(file, "png", optimize=True)
    return file.getvalue()


def tree(seed: int, slim: float) -> tuple[F8, F8]:
    """A tree of leafy spots about a trunk; colour runs on under what is clear, so that edges stay green."""
    size = 256
    x, y = places(size)
    random = np.random.default_rng(seed)
    leaves, shade = np.zeros((size, size)), np.full((size, size), 0.45)
    for _ in range(420):
        high = random.uniform(-0.35, 0.92)
        reach = slim * np.sqrt(max(0.0, 1.0 - ((high - 0.28) / 0.66) ** 2))
        left, radius = random.uniform(-reach, reach), random.uniform(0.035, 0.085)
        inside = np.hypot(x - left, y - high) < radius * (0.8 + 0.4 * noise_at(x, y, left))
        leaves[inside] = 1.0
        shade[inside] = 0.55 + 0.25 * high + 0.12 * (x - left)[inside] / radius + random.uniform(-0.12, 0.12)
    trunk = (np.abs(x - 0.03 * np.sin(5.0 * y)) < 0.045 - 0.02 * y) & (y < 0.2)
    green = np.stack([0.30 * shade, 0.52 * shade + 0.05, 0.18 * shade], axis=-1)
    bark = np.array([0.30, 0.22, 0.15]) * (0.8 + 0.3 * noise(size, seed + 9)[..., None])
    shown = np.where((trunk & (leaves == 0.0))[..., None], bark, green)
    return shown, np.maximum(leaves, trunk)


def noise_at(x: F8, y: F8, phase: float) -> F8:
    """A little unevenness."""
    return np.asarray(0.5 + 0.5 * np.sin(23.0 * x + 40.0 * phase) * np.cos(19.0 * y - 30.0 * phase))


def target() -> tuple[F8, F8]:
    """Five rings as archers know them."""
    x, y = places(256)
    away = np.hypot(x, y)
    colours = np.array(
        [[0.98, 0.83, 0.10], [0.86, 0.12, 0.10], [0.12, 0.45, 0.85], [0.10, 0.10, 0.12], [0.96, 0.96, 0.94]]
    )
    number = np.clip((away * 5.0 / 0.97).astype(int), 0, 4)
    line = np.abs((away * 5.0 / 0.97) % 1.0 - 0.5) > 0.47
    worn = 0.75 + 0.25 * smooth(0.2, 0.5, noise(256, 3))
    return colours[number] * np.where(line, 0.75, 1.0)[..., None], worn * smooth(0.0, 0.01, 0.97 - away)


def arrow() -> tuple[F8, F8]:
    """An arrow painted with a roller, pointing up."""
    x, y = places(256)
    shaft = (np.abs(x) < 0.2) & (y > -0.9) & (y < 0.2)
    head = (y >= 0.2) & (y < 0.9) & (np.abs(x) < 0.62 * (0.9 - y) / 0.7)
    worn = smooth(0.18, 0.42, noise(256, 11))
    return np.full((256, 256, 3), 0.97), (shaft | head) * worn


def dirt() -> tuple[F8, F8]:
    """A puddle's mark."""
    x, y = places(256)
    blot = smooth(0.42, 0.62, noise(256, 21) + 0.75 - 0.95 * np.hypot(x, y))
    blot = blot * smooth(0.0, 0.25, 1.0 - np.maximum(np.abs(x), np.abs(y)))
    return np.array([0.42, 0.34, 0.26]) * (0.7 + 0.5 * noise(256, 22)[..., None]), 0.85 * blot


def window() -> tuple[F8, F8]:
    """A stained-glass window: panes of colour between bars of lead."""
    size = 256
    x, y = places(size)
    random = np.random.default_rng(5)
    arch = np.where(y > 0.3, np.hypot(x / 0.8, (y - 0.3) / 0.65) < 1.0, np.abs(x) < 0.8) & (y > -0.95)
    centres = random.uniform([-0.85, -1.0], [0.85, 1.0], (46, 2))
    away = np.hypot(x[..., None] - centres[:, 0], y[..., None] - centres[:, 1])
    order = np.sort(away, axis=-1)
    glass = np.array(
        [[0.9, 0.15, 0.1], [0.1, 0.3, 0.9], [0.95, 0.75, 0.1], [0.1, 0.65, 0.3], [0.6, 0.15, 0.75], [0.2, 0.75, 0.9]]
    )
    shown = glass[away.argmin(axis=-1) % len(glass)]
    rose = np.hypot(x, y - 0.3)
    shown = np.where((rose < 0.34)[..., None], glass[(np.arctan2(y - 0.3, x) * 6.0 / np.pi).astype(int) % 6], shown)
    lead = (order[..., 1] - order[..., 0] < 0.03) & (rose > 0.36) | (np.abs(rose - 0.35) < 0.02)
    return np.where((arch & ~lead)[..., None], shown, 0.0), np.ones((size, size))


def compose(seed: int) -> dict[str, bytes]:
    """All of them; only the trees are grown from the seed."""
    pictures = {
        "tree": tree(seed, 0.62),
        "tree_slim": tree(seed + 1, 0.36),
        "target": target(),
        "arrow": arrow(),
        "dirt": dirt(),
        "window": window(),
    }
    return {f"{name}.png": pack(*picture) for name, picture in pictures.items()}
