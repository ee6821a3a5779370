"""`mimics bench displays`: one pass against two, and how old a head's pose is when a headset is given the frame."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from mimics_app.app.picture.picture import picture_quality
from mimics_app.app.session.core import open_core
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.preparation import prepare
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.display_port import DisplayFrame
from mimics_app.lab.visual.stereo import WORKLOADS, turns
from mimics_app.rendering.visual.displays.headset_file import HeadsetSpec
from mimics_app.rendering.visual.displays.headset_session import EyeLocation, HeadsetDisplay
from mimics_app.rendering.visual.displays.simulated_headset import SimulatedRuntime
from mimics_app.rendering.visual.presenting.presenter import Presenter
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.surfaces.headless import open_offscreen
from mimics_app.rendering.visual.surfaces.surface import Size
from mimics_app.rendering.visual.view import View

__all__ = ["MotionTimes", "measure_displays", "one_frame"]

Row = dict[str, Any]

_GOAL_MS = 3.0
"""From a pose to the frame that shows it, without drawing [ms]; at 60 Hz a frame has 16.7."""
_SETTLE = 10
"""Frames that are not counted: buffers grow, the driver compiles."""


def measure_displays(scene: Path, size: Size, frames: int, tell: Callable[[str], None]) -> Row:
    """Ratios of one pass to two, by workload, and times from pose to submission.

    Args:
        scene: Whose frames a simulated headset is given.
        size: Of both eyes' pictures together [px].
        frames: How many are timed.
        tell: Called with what is measured next.

    Raises:
        DeviceError: there is no way to draw without a display.
    """
    rows = []
    for workload in WORKLOADS:
        tell(f"displays: one pass against two, {workload}")
        two, one = turns(workload, "two_pass", "clip_distance")
        ratios = [a / b for a, b in zip(one, two, strict=True)]
        rows.append({"workload": workload, "two_pass_ms": median(two) * 1e-3, "ratio": median(ratios)})
    tell(f"displays: from pose to submission, {frames} frames of {scene.stem}")
    return {"stereo": rows, "motion_to_submit_ms": _measure_motion(scene, size, frames)}


class MotionTimes(SimulatedRuntime):
    """A simulated headset that looks at a clock when it is asked for poses and when it is given the frame.

    Args:
        spec: What it is.
        clock: Which.

    Attributes:
        asked_ns: When poses were asked for in this frame, and when they were there [ns].
        given_ns: When the frame was handed over [ns].
    """

    def __init__(self, spec: HeadsetSpec, clock: Clock) -> None:
        super().__init__(spec)
        self._clock = clock
        self.asked_ns: list[tuple[int, int]] = []
        self.given_ns = 0

    def locate(self, display_ns: int) -> list[EyeLocation]:
        began = self._clock.now_ns()
        located = super().locate(display_ns)
        self.asked_ns.append((began, self._clock.now_ns()))
        return located

    def end_frame(self, display_ns: int, eyes: list[EyeLocation], frame: DisplayFrame | None) -> None:
        self.given_ns = self._clock.now_ns()
        super().end_frame(display_ns, eyes, frame)


def _measure_motion(scene: Path, size: Size, frames: int) -> Row:
    """From the latched pose, and from the queued one, to `end_frame`, less what the renderer drew meanwhile."""
    clock = MonotonicClock()
    runtime = MotionTimes(HeadsetSpec(), clock)
    latched, queued = [], []
    with _played(scene, size, runtime) as (play, renderer, presenter):
        for number in range(frames + _SETTLE):
            play.play_on()
            times = one_frame(renderer, presenter, runtime, clock)
            if number >= _SETTLE:
                latched.append(times[0])
                queued.append(times[1])
    return {"goal": _GOAL_MS, "frames": frames, "latched": _spread(latched), "queued": _spread(queued)}


@contextmanager
def _played(scene: Path, size: Size, runtime: SimulatedRuntime) -> Iterator[tuple[Frames, Renderer, Presenter]]:
    settings = RunSettings(scene, size=size)
    core = open_core(prepare(settings, live=False))
    with core, open_offscreen("auto", size) as surface:
        presenter = Presenter(HeadsetDisplay("sim-hmd", runtime), surface)
        renderer = Renderer(presenter.drawn, core.world, picture_quality(core.scene, settings.profile))
        frames = Frames(core)
        frames.play_to_start()
        yield frames, renderer, presenter
        renderer.release()
        presenter.release()


def one_frame(renderer: Renderer, presenter: Presenter, runtime: MotionTimes, clock: Clock) -> tuple[float, float]:
    """Milliseconds from the latched pose, and from the first one, to submission; drawing left out."""
    camera = renderer.world.cameras[0]
    runtime.asked_ns.clear()
    presenter.begin(clock.now_ns())
    latched_ns = 0

    def latch() -> Sequence[View]:
        nonlocal latched_ns
        views = presenter.views(camera)
        latched_ns = clock.now_ns()
        return views

    renderer.draw(presenter.views(camera), latch)
    drawing_ns = clock.now_ns() - latched_ns
    presenter.present()
    first, last = runtime.asked_ns[0][0], runtime.asked_ns[-1][0]
    return 1e-6 * (runtime.given_ns - last - drawing_ns), 1e-6 * (runtime.given_ns - first - drawing_ns)


def _spread(values_ms: list[float]) -> Row:
    p50, p95, p99 = np.percentile(values_ms, (50, 95, 99)).tolist()
    return {"p50": p50, "p95": p95, "p99": p99, "max": max(values_ms)}
