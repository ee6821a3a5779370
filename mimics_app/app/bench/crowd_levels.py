"""The peers' crowd with levels of detail of its characters, as `mimics assets levels` makes them."""

from __future__ import annotations

import statistics
import tempfile
from pathlib import Path

from mimics_app.app.bench.render_workloads import Crowd
from mimics_app.contracts.clock import MonotonicClock, process_seconds
from mimics_app.lab.visual.probe import differing_pixels
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.surfaces.surface import Size, Surface
from mimics_app.world.files.simplify.level_writer import write_levels

__all__ = ["compare_levels"]

_PIXELS = 4.0
"""Largest error of a level [px], at the worst vertex with every joint bent."""
_VISIBLE = 8
"""Difference of a pixel above which it counts [levels of 255]."""
_SAMPLED = 10
"""Period of the comparisons of pictures [frames]."""


def compare_levels(
    whole: Crowd, size: Size, frames: int, surface: Surface, renderer: Renderer
) -> dict[str, float | int]:
    """Time frames of a crowd with and without levels of detail alternately; {} where no level can be made.

    Args:
        whole: The crowd without levels.
        size: Size of the picture [px].
        frames: Number of frames of each.
        surface: Surface to draw on.
        renderer: Renderer of `whole`.

    Returns:
        Median frame and its processor time [ms], the ratios of those without levels to these, triangles of the last
        frame, and the share of pixels that differ by more than 8 of 255, and of all that differ.
    """
    with tempfile.TemporaryDirectory(prefix="mimics-levels-") as folder:
        file = Path(folder) / whole.file.name
        if not write_levels(whole.file, file, pixels=_PIXELS):
            return {}
        coarse = Crowd(file, whole.nodes)
    other = Renderer(surface, coarse.world, renderer.settings)
    walls: tuple[list[float], list[float]] = ([], [])
    costs: tuple[list[float], list[float]] = ([], [])
    differing, unequal = [], []
    for frame in range(frames + 1):
        pictures = []
        for side, (crowd, drawn) in enumerate(((whole, renderer), (coarse, other))):
            wall, cost, triangles = _draw(crowd, drawn, frame, size)
            if frame:  # the first one loads what is drawn
                walls[side].append(wall)
                costs[side].append(cost)
            if frame % _SAMPLED == 1:
                pictures.append(read_pixels(surface)[..., :3])
        if pictures:
            differing.append(differing_pixels(pictures[0], pictures[1], level=_VISIBLE))
            unequal.append(differing_pixels(pictures[0], pictures[1], level=0))
    other.release()
    medians = [[statistics.median(side) for side in each] for each in (walls, costs)]
    return {
        "levels_ms": round(medians[0][1], 3),
        "levels_ms_cpu": round(medians[1][1], 3),
        "times_levels": round(medians[0][0] / medians[0][1], 3),
        "times_levels_cpu": round(medians[1][0] / medians[1][1], 3),
        "levels_tris": triangles,
        "levels_differing": round(max(differing), 6),
        "levels_unequal": round(max(unequal), 6),
    }


def _draw(crowd: Crowd, renderer: Renderer, frame: int, size: Size) -> tuple[float, float, int]:
    """Return time, processor time of all threads [ms], and triangles of a frame, including its poses."""
    clock = MonotonicClock()
    started, begun = clock.now_ns(), process_seconds()
    crowd.update(frame)
    renderer.forget_picture()
    triangles = renderer.draw_finished([crowd.view(frame, size)]).triangles
    return (clock.now_ns() - started) * 1e-6, (process_seconds() - begun) * 1e3, triangles
