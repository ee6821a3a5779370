"""`mimics bench render`: frames of a workload that peers draw too, timed to the last pixel."""

from __future__ import annotations

import statistics
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.app.bench.crowd_levels import compare_levels
from mimics_app.app.bench.render_workloads import Crowd, Nodes, Workload
from mimics_app.app.bench.workload_opening import open_workload
from mimics_app.app.picture.governor import FrameGovernor
from mimics_app.contracts.clock import MonotonicClock, process_seconds
from mimics_app.contracts.errors import require_choice
from mimics_app.rendering.visual.frame_stats import FrameStats
from mimics_app.rendering.visual.quality_steps import quality_steps
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.surfaces.headless import open_offscreen, read_pixels, save_png
from mimics_app.rendering.visual.surfaces.rasteriser import without_software
from mimics_app.rendering.visual.surfaces.surface import Size, Surface

__all__ = ["RenderBench", "measure_render"]

_MIN_FRAMES = 5
_FEW = 3
_CALM_NS, _SETTLING_NS = 4_000_000_000, 40_000_000_000
"""Time without a change after which the governor has stabilised, and time-out for it [ns]."""

_OPTIONS: dict[str, dict[str, Any]] = {
    "full": {"shading": "full"},
    "noocc": {"occlusion": "off"},
    "derived": {"occlusion": "derived"},
    "authored": {"occlusion": "authored"},
    "flat": {"culling": "flat"},
    "tree": {"culling": "tree"},
    "noshadow": {"shadow_size": 0},
    "shadow1024": {"shadow_size": 1024},
    "scale75": {"scale": 0.75},
    "noaa": {"msaa": 0, "fxaa": False},
    "feedback": {"skinning": "feedback"},
    "freethreads": {"place_threads": False},
    "osmesa": {},
    "nosoftware": {},
}
"""Changes of the settings by the words of `--opt`."""


@dataclass(frozen=True, slots=True)
class RenderBench:
    """Settings of one measurement.

    Attributes:
        workload: One of `workload_opening.WORKLOADS`.
        data: Folder of the workloads' files, or None.
        size: Size of the picture [px].
        msaa: Samples per pixel; None: those of the workload.
        frames: Number of timed frames.
        warmup: Number of frames drawn before.
        budget: Timed seconds after which it stops [s].
        count: Number of nodes, people or particles; 0: that of the peers.
        options: Keys of `_OPTIONS`.
        shot: PNG file for the last frame, or None.
        fps: Frame rate to hold by lowering the quality, as in a run [Hz]; None: full quality.
    """

    workload: str
    data: Path | None
    size: Size = (1280, 720)
    msaa: int | None = None
    frames: int = 40
    warmup: int = 6
    budget: float = 25.0
    count: int = 0
    options: tuple[str, ...] = ()
    shot: Path | None = None
    fps: float | None = None


def measure_render(wanted: RenderBench) -> dict[str, Any]:
    """Draw and time a workload.

    Returns:
        The keys that the peers print too: times [ms], mean colour of the last frame, and its counts.

    Raises:
        UsageError: An option or the workload does not exist.
        DeviceError: No OpenGL context is available.
    """
    for word in wanted.options:
        require_choice(word, _OPTIONS, "option")
    workload = open_workload(wanted.workload, wanted.data, wanted.count)
    workload.prepare(wanted.warmup + wanted.frames)
    changes: dict[str, Any] = {} if wanted.msaa is None else {"msaa": wanted.msaa}
    for word in wanted.options:
        changes |= _OPTIONS[word]
    backend = "osmesa" if "osmesa" in wanted.options else "egl"
    driver = without_software() if "nosoftware" in wanted.options else nullcontext()
    with driver, open_offscreen(backend, wanted.size) as surface:
        renderer = Renderer(surface, workload.world, replace(workload.quality(surface), **changes))
        lowered = _lowered_quality(wanted.fps, wanted, workload, renderer) if wanted.fps else {}
        answer = {**_time_frames(wanted, workload, renderer, surface), **lowered, **_quality(renderer)}
        if isinstance(workload, Nodes):
            answer.update(_time_poses(workload, wanted.frames))
        if isinstance(workload, Crowd):
            answer.update(_time_still(workload, wanted, renderer))
            answer.update(compare_levels(workload, wanted.size, wanted.frames, surface, renderer))
        renderer.release()
    return answer


def _lowered_quality(fps: float, wanted: RenderBench, workload: Workload, renderer: Renderer) -> dict[str, Any]:
    """Let the governor settle at the quality that holds a frame rate."""
    clock = MonotonicClock()
    governor = FrameGovernor(quality_steps(renderer), 1e3 / fps)
    begun = calm = clock.now_ns()
    state, frame = governor.state, 0
    while (now := clock.now_ns()) - calm < _CALM_NS and now - begun < _SETTLING_NS:
        workload.update(frame)
        renderer.draw_finished([workload.view(frame, wanted.size)])
        governor.note((clock.now_ns() - now) * 1e-6, clock.now_ns())
        if governor.state != state:
            state, calm = governor.state, clock.now_ns()
        frame += 1
    return {"fps_wanted": fps, "lowered": state, "settled": now - begun < _SETTLING_NS}


def _time_frames(wanted: RenderBench, workload: Workload, renderer: Renderer, surface: Surface) -> dict[str, Any]:
    clock = MonotonicClock()
    updates: list[float] = []
    renders: list[float] = []
    processor = 0.0
    for frame in range(wanted.warmup + wanted.frames):
        if frame == wanted.warmup:
            processor = process_seconds()
        started = clock.now_ns()
        workload.update(frame)
        updated = clock.now_ns()
        stats = renderer.draw_finished([workload.view(frame, wanted.size)])
        done = clock.now_ns()
        if frame >= wanted.warmup:
            updates.append((updated - started) * 1e-6)
            renders.append((done - updated) * 1e-6)
        if len(renders) >= _MIN_FRAMES and 1e-3 * (sum(updates) + sum(renders)) > wanted.budget:
            break
    processor = process_seconds() - processor
    if wanted.shot is not None:
        save_png(surface, wanted.shot)
    picture = read_pixels(surface)[..., :3].reshape(-1, 3)
    return {
        **_describe(wanted, workload, surface),
        **_times(updates, renders, processor),
        "mean_rgb": [round(float(level), 1) for level in picture.mean(axis=0)],
        **_drawn(stats),
    }


def _time_poses(nodes: Nodes, frames: int) -> dict[str, float]:
    """Return the times [ms] of all poses and world matrices of a frame, undrawn: set at once, and per node."""
    clock = MonotonicClock()

    def median_ms(update: Callable[[int], None], count: int) -> float:
        times = []
        for frame in range(count):
            started = clock.now_ns()
            update(frame)
            times.append((clock.now_ns() - started) * 1e-6)
        return round(statistics.median(times), 3)

    return {"ms_setter": median_ms(nodes.update, frames), "ms_handles": median_ms(nodes.update_by_handles, _FEW)}


def _time_still(crowd: Crowd, wanted: RenderBench, renderer: Renderer) -> dict[str, float]:
    """Return the cost of a skinned vertex that is skinned and drawn, and of one that is drawn again without movement.

    Both are processor times of all threads, measured alternately; poses and world matrices do not count.
    """
    bent: list[float] = []
    still: list[float] = []
    for frame in range(wanted.frames):
        crowd.update(frame)
        views = [crowd.view(frame, wanted.size)]
        renderer.forget_picture()
        started = process_seconds()
        vertices = renderer.draw_finished(views).bent
        renderer.forget_picture()
        between = process_seconds()
        renderer.draw_finished(views)
        bent.append((between - started) * 1e9 / max(vertices, 1))
        still.append((process_seconds() - between) * 1e9 / max(vertices, 1))
    return {
        "ns_vertex": round(statistics.median(bent), 2),
        "ns_vertex_still": round(statistics.median(still), 2),
        "times_still": round(sum(bent) / sum(still), 3),
    }


def _describe(wanted: RenderBench, workload: Workload, surface: Surface) -> dict[str, Any]:
    return {
        "workload": wanted.workload,
        "size": f"{wanted.size[0]}x{wanted.size[1]}",
        "n": wanted.count,
        "opt": " ".join(wanted.options),
        "nodes": workload.nodes,
        "device": surface.ctx.info["GL_RENDERER"],
    }


def _quality(renderer: Renderer) -> dict[str, Any]:
    settings = renderer.settings
    return {
        "msaa": settings.msaa,
        "fxaa": settings.fxaa,
        "scale": settings.scale,
        "shadow_size": settings.shadow_size,
        "shading": settings.shading,
    }


def _times(updates: list[float], renders: list[float], processor: float) -> dict[str, Any]:
    whole = [update + render for update, render in zip(updates, renders, strict=True)]
    return {
        "frames": len(whole),
        "fps_median": round(1e3 / statistics.median(whole), 2),
        "ms_median": round(statistics.median(whole), 3),
        "ms_min": round(min(whole), 3),
        "ms_p95": round(float(np.percentile(whole, 95)), 3),
        "ms_update": round(statistics.median(updates), 3),
        "ms_render": round(statistics.median(renders), 3),
        "ms_cpu": round(1e3 * processor / len(whole), 3),
    }


def _drawn(stats: FrameStats) -> dict[str, Any]:
    return {
        "draw_calls": stats.draws,
        "tris_submitted": stats.triangles,
        "items": stats.items,
        "culled": stats.culled,
        "hidden": stats.hidden,
        "tests": stats.tests,
    }
