"""The frame graph: recent frames as stacked bars, a colour per stage, and the GPU time as a line."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.figures.hud import HUD_ROW, Colour, Hud
from mimics_app.rendering.visual.figures.palette import FAINT, INK
from mimics_app.rendering.visual.overlay.frame_budget import BUDGET_MS, FRAME_MS
from mimics_app.rendering.visual.overlay.stage_times import FrameTimes

__all__ = ["draw_frame_graph"]

_WIDTH, _HEIGHT = 480.0, 120.0
_MARGIN, _BELOW = 18.0, 98.0
"""Margins from the right and the upper edge, below the cards of a task [hud px]."""
_FRAMES = 240
_PANEL: Colour = (0.05, 0.06, 0.08, 0.80)
_OVER: Colour = (0.98, 0.45, 0.36, 1.0)
_GPU: Colour = (1.0, 1.0, 1.0, 0.95)
_COLOURS: tuple[Colour, ...] = (
    (0.36, 0.62, 0.96, 1.0),
    (0.98, 0.76, 0.30, 1.0),
    (0.38, 0.80, 0.52, 1.0),
    (0.86, 0.46, 0.80, 1.0),
    (0.95, 0.48, 0.36, 1.0),
    (0.50, 0.85, 0.90, 1.0),
    (0.70, 0.70, 0.74, 1.0),
)
_SCALES_MS = (20.0, 40.0, 80.0, 160.0, 400.0, 2000.0)
_NOTE = 14.0
_SUMMED = 30
"""Number of recent frames whose median is shown."""


def draw_frame_graph(hud: Hud, frames: Sequence[FrameTimes], note: str = "") -> None:
    """Draw the graph in the upper right, below the cards of a task, with a note in several lines."""
    known = list(frames)[:-1][-_FRAMES:]  # the last frame is in progress
    if not known:
        return
    stages = list(dict.fromkeys(name for frame in known for name in frame.cpu_ms))
    x, top = hud.width - _MARGIN - _WIDTH - 28.0, hud.height - _BELOW
    notes = hud.wrap(note, _NOTE, _WIDTH, 4)
    height = _HEIGHT + 66.0 + 19.0 * (len(stages) + len(notes))
    hud.box(x, top - height, _WIDTH + 28.0, height, _PANEL, radius=12.0)
    _write_head(hud, known, x + 14.0, top - 26.0)
    bottom = top - 42.0 - _HEIGHT
    longest = max(sum(frame.cpu_ms.values()) for frame in known)
    full = next((scale for scale in _SCALES_MS if longest <= scale), _SCALES_MS[-1])
    hud.extend(_bars(known, stages, x + 14.0, bottom, _HEIGHT / full))
    budget = bottom + FRAME_MS * _HEIGHT / full
    hud.box(x + 14.0, budget, _WIDTH, 1.0, FAINT)
    hud.text(x + 14.0 + _WIDTH, budget + 3.0, "60 Hz", 11.0, FAINT, align="right")
    _write_stages(hud, known, stages, x + 14.0, bottom - 22.0)
    for number, line in enumerate(notes):
        hud.text(x + 14.0, bottom - 22.0 - 19.0 * (len(stages) + number), line, _NOTE, INK)


def _write_head(hud: Hud, frames: Sequence[FrameTimes], x: float, y: float) -> None:
    newest = frames[-_SUMMED:]
    cpu = median(sum(frame.cpu_ms.values()) for frame in newest)
    gpu = [sum(frame.gpu_ms.values()) for frame in newest if frame.gpu_ms]
    driver = f"driver {median(gpu):.1f} ms" if gpu else ""
    wide = hud.text(x, y, f"{cpu:.1f} ms", 18.0, INK, bold=True)
    hud.text(x + wide + 12.0, y, driver, 14.0, FAINT)
    last = frames[-1]
    drawn = last.items - last.culled - last.hidden
    counts = f"{drawn} drawn, {last.culled} outside, {last.hidden} hidden"
    hud.text(x + _WIDTH, y, counts, 14.0, FAINT, align="right")


def _bars(
    frames: Sequence[FrameTimes], stages: Sequence[str], x: float, bottom: float, per_ms: float
) -> NDArray[np.void]:
    """Return stacked bars of the stages of each frame, and a dash for its GPU time."""
    times = np.array([[frame.cpu_ms.get(name, 0.0) for name in stages] for frame in frames])
    heights = np.minimum(per_ms * times, _HEIGHT)
    base = np.minimum(np.cumsum(heights, axis=1) - heights, _HEIGHT)
    heights = np.minimum(heights, _HEIGHT - base)
    step = _WIDTH / _FRAMES
    left = x + _WIDTH - step * np.arange(len(frames), 0, -1)
    rows = np.zeros((len(frames), len(stages) + 1), HUD_ROW)
    rows["box"][..., 0], rows["box"][..., 2] = left[:, None], step
    rows["box"][:, :-1, 1], rows["box"][:, :-1, 3] = bottom + base, heights
    rows["tint"][:, :-1] = [_COLOURS[number % len(_COLOURS)] for number in range(len(stages))]
    driver = np.array([sum(frame.gpu_ms.values()) for frame in frames])
    rows["box"][:, -1, 1], rows["box"][:, -1, 3] = bottom + np.minimum(per_ms * driver, _HEIGHT), 1.6 * (driver > 0.0)
    rows["tint"][:, -1] = _GPU
    flat = rows.reshape(-1)
    return np.asarray(flat[flat["box"][:, 3] > 0.0])


def _write_stages(hud: Hud, frames: Sequence[FrameTimes], stages: Sequence[str], x: float, y: float) -> None:
    newest = frames[-_SUMMED:]
    for number, name in enumerate(stages):
        line = y - 19.0 * number
        hud.box(x, line, 10.0, 10.0, _COLOURS[number % len(_COLOURS)], radius=3.0)
        hud.text(x + 18.0, line, name, 14.0, INK)
        cpu = median(frame.cpu_ms.get(name, 0.0) for frame in newest)
        gpu = [frame.gpu_ms[name] for frame in newest if name in frame.gpu_ms]
        budget = BUDGET_MS.get(name, FRAME_MS)
        hud.text(x + 230.0, line, f"{cpu:.2f} ms", 14.0, _OVER if cpu > budget else INK, align="right")
        hud.text(x + 300.0, line, f"of {budget:.1f}", 14.0, FAINT, align="right")
        hud.text(x + 420.0, line, f"driver {median(gpu):.2f}" if gpu else "", 14.0, FAINT, align="right")
