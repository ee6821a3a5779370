"""The pictures of scenes/examples/billboards_and_particles.json and scenes/examples/decals.json."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

from assets.builders.kit.lattice_noise import smooth_step
from mimics_app.contracts.arrays import F8

__all__ = ["compose"]


_FINE = 3
"""Factor of supersampling of shapes with hard edges; `smaller` filters them down."""


def places(size: int) -> tuple[F8, F8]:
    """Return coordinates of texel centres, -1 to 1, x to the right and y up."""
    y, x = (np.mgrid[0:size, 0:size] + 0.5) / (0.5 * size) - 1.0
    return x, -y


def noise(size: int, seed: int, octaves: int = 5) -> F8:
    """Return tileable noise of 0 to 1."""
    random, total = np.random.default_rng(seed), np.zeros((size, size))
    for octave in range(octaves):
        cells = 4 << octave
        grid = random.random((cells, cells))
        at = np.arange(size) * cells / size
        low, mix = at.astype(int), smooth_step(0.0, 1.0, at % 1.0)
        high = (low + 1) % cells
        across = grid[:, low] * (1.0 - mix) + grid[:, high] * mix
        total += 0.5**octave * (across[low] * (1.0 - mix[:, None]) + across[high] * mix[:, None])
    return np.asarray((total - total.min()) / np.ptp(total))


def pack(colour: F8, cover: F8) -> bytes:
    """A PNG file of colour [h, w, 3] as display values and opacity [h, w], 0 to 1."""
    pixels, file = np.concatenate([colour, cover[..., None]], axis=-1), io.BytesIO()
    Image.fromarray(np.round(255.0 * np.clip(pixels, 0.0, 1.0)).astype(np.uint8)).save(file, "png", optimize=True)
    return file.getvalue()


def smaller(colour: F8, cover: F8) -> tuple[F8, F8]:
    """A picture at a third of its size, each pixel the mean of nine: smooth edges, colours weighed by their cover."""
    rows, columns = cover.shape[0] // _FINE, cover.shape[1] // _FINE
    blocks = cover.reshape(rows, _FINE, columns, _FINE)
    mean = blocks.mean(axis=(1, 3))
    weight = np.maximum(blocks, 1e-3)[..., None]
    shown = (colour.reshape(rows, _FINE, columns, _FINE, 3) * weight).sum(axis=(1, 3))
    return shown / weight.sum(axis=(1, 3)), mean


def tree(seed: int, slim: float) -> tuple[F8, F8]:
    """A tree of leaves about trunk and boughs; colour runs on under what is clear, so that edges stay green."""
    size = 256 * _FINE
    x, y = places(size)
    random = np.random.default_rng(seed)
    cover = np.zeros((size, size))
    colour = np.empty((size, size, 3))
    colour[:] = (0.20, 0.31, 0.11)
    bark = np.array([0.34, 0.25, 0.17]) * (0.7 + 0.5 * noise(size, seed + 9)[..., None])
    for foot, tip, wide in _boughs(random, slim):
        share = np.clip((y - foot[1]) / (tip[1] - foot[1]), 0.0, 1.0)
        flare = 1.0 + 1.1 * np.exp(-(y + 1.0) / 0.10)
        half = wide * flare * (1.0 - 0.7 * share)
        inside = (np.abs(x - foot[0] - share * (tip[0] - foot[0])) < half) & (y >= foot[1]) & (y <= tip[1])
        cover[inside] = 1.0
        colour[inside] = (bark * (1.0 - 0.35 * np.clip((x - foot[0]) / wide, -1.0, 1.0))[..., None])[inside]
    for _ in range(1500):
        _add_leaf(colour, cover, random, slim)
    return smaller(colour, cover)


def _boughs(random: np.random.Generator, slim: float) -> list[tuple[tuple[float, float], tuple[float, float], float]]:
    """Foot, tip and half width of the trunk and of what leaves it."""
    boughs = [((0.0, -1.0), (0.02, 0.55), 0.052)]
    for number in range(6):
        high = -0.42 + 0.13 * number
        side = (-1.0) ** number
        boughs.append(((0.0, high), (side * slim * random.uniform(0.5, 0.8), high + random.uniform(0.3, 0.45)), 0.022))
    return boughs


def _add_leaf(colour: F8, cover: F8, random: np.random.Generator, slim: float) -> None:
    """A tuft within an egg about the crown, lighter above and to the left, where the light comes from."""
    high = random.uniform(-0.42, 0.95)
    reach = slim * np.sqrt(max(0.0, 1.0 - ((high - 0.24) / 0.72) ** 2)) * (1.0 + 0.12 * np.sin(9.0 * high))
    left, radius = reach * random.uniform(-1.0, 1.0), random.uniform(0.018, 0.046)
    size = cover.shape[0]
    column, row = 0.5 * size * (left + 1.0), 0.5 * size * (1.0 - high)
    span = int(0.5 * size * radius) + 2
    rows = slice(max(int(row) - span, 0), min(int(row) + span, size))
    columns = slice(max(int(column) - span, 0), min(int(column) + span, size))
    down, across = np.mgrid[rows, columns]
    across, down = (across - column) / (0.5 * size * radius), (down - row) / (0.5 * size * radius)
    ragged = 0.82 + 0.18 * np.sin(5.0 * np.arctan2(down, across) + 40.0 * left)
    inside = np.hypot(across, down) < ragged
    light = 0.56 + 0.20 * high - 0.16 * left / slim + random.uniform(-0.10, 0.10)
    shade = np.clip(light - 0.10 * down - 0.07 * across, 0.12, 1.0)[inside]
    warm = random.uniform(0.0, 0.10)
    colour[rows, columns][inside] = np.stack([(0.50 + warm) * shade, 0.74 * shade + 0.03, 0.26 * shade], axis=-1)
    cover[rows, columns][inside] = 1.0


def target() -> tuple[F8, F8]:
    """Five rings as archers know them."""
    x, y = places(256)
    away = np.hypot(x, y)
    colours = np.array(
        [[0.98, 0.83, 0.10], [0.86, 0.12, 0.10], [0.12, 0.45, 0.85], [0.10, 0.10, 0.12], [0.96, 0.96, 0.94]]
    )
    number = np.clip((away * 5.0 / 0.97).astype(int), 0, 4)
    line = np.abs((away * 5.0 / 0.97) % 1.0 - 0.5) > 0.47
    worn = 0.75 + 0.25 * smooth_step(0.2, 0.5, noise(256, 3))
    return colours[number] * np.where(line, 0.75, 1.0)[..., None], worn * smooth_step(0.0, 0.01, 0.97 - away)


def arrow() -> tuple[F8, F8]:
    """An arrow painted with a roller, pointing up."""
    x, y = places(256 * _FINE)
    shaft = (np.abs(x) < 0.2) & (y > -0.9) & (y < 0.2)
    head = (y >= 0.2) & (y < 0.9) & (np.abs(x) < 0.62 * (0.9 - y) / 0.7)
    shown, cover = smaller(np.full((*x.shape, 3), 0.97), (shaft | head).astype(np.float64))
    return shown, cover * (0.55 + 0.45 * smooth_step(0.10, 0.40, noise(256, 11)))


def dirt() -> tuple[F8, F8]:
    """A puddle's mark."""
    x, y = places(256)
    blot = smooth_step(0.42, 0.62, noise(256, 21) + 0.75 - 0.95 * np.hypot(x, y))
    blot = blot * smooth_step(0.0, 0.25, 1.0 - np.maximum(np.abs(x), np.abs(y)))
    return np.array([0.42, 0.34, 0.26]) * (0.7 + 0.5 * noise(256, 22)[..., None]), 0.85 * blot


def window() -> tuple[F8, F8]:
    """A stained-glass window: panes of colour between bars of lead."""
    size = 256 * _FINE
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
    return smaller(np.where((arch & ~lead)[..., None], shown, 0.0), np.ones((size, size)))


def compose(seed: int) -> dict[str, bytes]:
    """Return all images; only the trees depend on the seed."""
    pictures = {
        "tree": tree(seed, 0.62),
        "tree_slim": tree(seed + 1, 0.36),
        "target": target(),
        "arrow": arrow(),
        "dirt": dirt(),
        "window": window(),
    }
    return {f"{name}.png": pack(*picture) for name, picture in pictures.items()}
