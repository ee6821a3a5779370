"""`mimics bench displays`: stereo in one pass against two, and the age of a head's pose when its frame is submitted."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from mimics_app.app.picture.picture import picture_quality
from mimics_app.app.session.core import open_core
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.preparation import prepare
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.clock import FRAME_NS, MonotonicClock, Stopwatch, process_seconds
from mimics_app.contracts.ports.display_port import Display, DisplayFrame
from mimics_app.inputs.trackers.ascension import FlockParser, flock_record
from mimics_app.inputs.trackers.plausibility import Plausibility
from mimics_app.inputs.trackers.polhemus import FastrakParser, fastrak_record
from mimics_app.inputs.trackers.scripted_person import person_at
from mimics_app.inputs.trackers.serial_tracker import RecordParser
from mimics_app.inputs.trackers.track import Track
from mimics_app.lab.groups.stereo import WORKLOADS, turns
from mimics_app.rendering.visual.displays.desktop import DesktopDisplay
from mimics_app.rendering.visual.displays.headset_file import HeadsetSpec
from mimics_app.rendering.visual.displays.headset_session import EyeLocation, HeadsetDisplay
from mimics_app.rendering.visual.displays.simulated_headset import SimulatedRuntime
from mimics_app.rendering.visual.displays.stereo import StereoDisplay
from mimics_app.rendering.visual.presenting.presenter import Presenter
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.surfaces.headless import open_offscreen
from mimics_app.rendering.visual.surfaces.surface import Size, Surface
from mimics_app.rendering.visual.view import View

__all__ = ["MotionTimes", "measure_displays", "one_frame"]

Row = dict[str, Any]

_GOAL_MS = 3.0
"""Largest time from a pose to the submission of its frame, without drawing [ms]."""
_QUEUE_GOAL = 1.15
"""Largest ratio of the time of simulation, animation and culling for two eyes to that for one."""
_SETTLING_FRAMES = 10
"""Number of first frames that do not count, in which buffers grow and the driver compiles."""


_RECORDS = 2000
_RATE_HZ = 120.0
_UNIT = 0.01
"""Unit of the record's numbers [m]."""
_AHEAD_NS = 10_000_000
"""Prediction of the requested pose [ns]."""
_RECORD_GOAL_MS = 1.0


def _measure_records() -> dict[str, object]:
    """Return the processor time from the last byte of a record to its pose [ms], by protocol: p50, p99, max."""
    lines: dict[str, tuple[RecordParser, Callable[[float], bytes]]] = {
        "fastrak": (FastrakParser(_UNIT), lambda t: fastrak_record(1, *person_at("head", t, 1), _UNIT)),
        "flock": (FlockParser(), lambda t: flock_record(*person_at("head", t, 1))),
    }
    return {"goal": _RECORD_GOAL_MS, **{name: _spread_of(*line) for name, line in lines.items()}}


def _spread_of(parser: RecordParser, record_at: Callable[[float], bytes]) -> dict[str, float]:
    believed, track, spent = Plausibility(), Track(), []
    for number in range(_RECORDS):
        t_s = number / _RATE_HZ
        record, t_ns = record_at(t_s), round(1e9 * t_s)
        begun = process_seconds()
        for found in parser.feed(record, t_ns):
            if believed.admits(found):
                track.add(found)
        track.pose(t_ns + _AHEAD_NS)
        spent.append(1e3 * (process_seconds() - begun))
    p50, p99 = np.percentile(spent, (50, 99)).tolist()
    return {"p50": p50, "p99": p99, "max": max(spent)}


def measure_displays(scene: Path, size: Size, frames: int, report: Callable[[str], None]) -> Row:
    """Measure the ratios of one pass to two, by workload, and the times from pose to submission.

    Args:
        scene: Scene shown on a simulated headset.
        size: Size of the pictures of both eyes together [px].
        frames: Number of timed frames.
        report: Called with the name of each measurement before it begins.

    Raises:
        DeviceError: No OpenGL context is available without a display.
    """
    rows = []
    for workload in WORKLOADS:
        report(f"displays: one pass against two, {workload}")
        two, one = turns(workload, "two_pass", "clip_distance")
        ratios = [a / b for a, b in zip(one, two, strict=True)]
        rows.append({"workload": workload, "two_pass_ms": median(two) * 1e-3, "ratio": median(ratios)})
    report(f"displays: from pose to submission, {frames} frames of {scene.stem}")
    motion = _measure_motion(scene, size, frames)
    motion["undrawn"] = _measure_undrawn(scene, size, frames)
    report(f"displays: what comes before drawing, for one eye and for two, {frames} frames of {scene.stem}")
    queueing = _measure_queueing(scene, size, frames)
    records = _measure_records()
    return {"stereo": rows, "motion_to_submit_ms": motion, "before_drawing": queueing, "record_to_pose_ms": records}


class MotionTimes(SimulatedRuntime):
    """A simulated headset that records the times of its pose requests and of the submitted frame.

    Args:
        spec: Properties of the headset.
        clock: Clock of the times.

    Attributes:
        asked_ns: Times at which poses were requested in this frame, and delivered [ns].
        given_ns: Time at which the frame was submitted [ns].
    """

    def __init__(self, spec: HeadsetSpec, clock: Stopwatch) -> None:
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
    """Measure the time from the latched pose, and from the queued one, to `end_frame`, without that of drawing."""
    clock = MonotonicClock()
    runtime = MotionTimes(HeadsetSpec(), clock)
    latched, queued = [], []
    with _played(scene, size, HeadsetDisplay("sim-hmd", runtime)) as (play, [(renderer, presenter)], _):
        for number in range(frames + _SETTLING_FRAMES):
            play.advance_frame()
            times = one_frame(renderer, presenter, runtime, clock)
            if number >= _SETTLING_FRAMES:
                latched.append(times[0])
                queued.append(times[1])
    return {"goal": _GOAL_MS, "frames": frames, "latched": _spread(latched), "queued": _spread(queued)}


class _ProcessorClock:
    """Clock of the processor time of this process, independent of other processes."""

    def now_ns(self) -> int:
        return round(1e9 * process_seconds())


def _measure_undrawn(scene: Path, size: Size, frames: int) -> Row:
    """Measure the time from both poses to submission with all calls of the driver but no drawing.

    The frame is drawn on the condition of an occlusion query in which no sample passed: the driver takes every call and
    discards it (OpenGL 3.0, conditional rendering).
    """
    clock = _ProcessorClock()
    runtime = MotionTimes(HeadsetSpec(), clock)
    latched, queued = [], []
    with _played(scene, size, HeadsetDisplay("sim-hmd", runtime)) as (play, [(renderer, presenter)], surface):
        camera = renderer.world.cameras[0]
        nothing = surface.ctx.query(any_samples=True)
        with nothing:
            pass
        unseen = nothing.crender
        assert unseen is not None
        for number in range(frames + _SETTLING_FRAMES):
            play.advance_frame()
            runtime.asked_ns.clear()
            presenter.begin(number * FRAME_NS)
            with unseen:
                renderer.draw(presenter.views(camera), partial(presenter.views, camera))
                presenter.present()
            if number >= _SETTLING_FRAMES:
                queued.append(1e-6 * (runtime.given_ns - runtime.asked_ns[0][0]))
                latched.append(1e-6 * (runtime.given_ns - runtime.asked_ns[-1][0]))
    return {"latched": _spread(latched), "queued": _spread(queued)}


def _measure_queueing(scene: Path, size: Size, frames: int) -> Row:
    """Measure simulation, animation and culling of the same frames for one eye and for two, alternately."""
    clock = MonotonicClock()
    played: list[float] = []
    queued: tuple[list[float], list[float]] = ([], [])
    displays = DesktopDisplay(), StereoDisplay("sbs")
    with _played(scene, size, *displays) as (play, drawn, _):
        for number in range(frames + _SETTLING_FRAMES):
            started = clock.now_ns()
            play.advance_frame()
            ended = clock.now_ns()
            times = [_queueing_ms(renderer, presenter) for renderer, presenter in drawn]
            if number >= _SETTLING_FRAMES:
                played.append(1e-6 * (ended - started))
                for each, time_ms in zip(queued, times, strict=True):
                    each.append(time_ms)
    one, two = (median(played) + median(each) for each in queued)
    return {"goal": _QUEUE_GOAL, "frames": frames, "one_eye_ms": one, "two_eyes_ms": two, "ratio": two / one}


def _queueing_ms(renderer: Renderer, presenter: Presenter) -> float:
    """Return the time of culling of a whole frame [ms]; unchanged parts are not reused, as two eyes cannot."""
    renderer.forget_picture()
    presenter.begin(0)
    renderer.timing = True
    renderer.draw(presenter.views(renderer.world.cameras[0]))
    presenter.skip()
    times = renderer.times
    assert times is not None
    return times.frames[-1].cpu_ms["prepare"] + times.frames[-1].cpu_ms["cull"]


@contextmanager
def _played(
    scene: Path, size: Size, *displays: Display
) -> Iterator[tuple[Frames, list[tuple[Renderer, Presenter]], Surface]]:
    """Yield a session on the virtual clock, and a renderer and presenter for each display."""
    settings = RunSettings(scene, size=size)
    core = open_core(prepare(settings, live=False))
    with core, open_offscreen("auto", size) as surface:
        presenters = [Presenter(display, surface) for display in displays]
        quality = picture_quality(core.scene, settings.profile)
        renderers = [Renderer(presenter.drawn, core.world, quality) for presenter in presenters]
        frames = Frames(core)
        frames.play_to_start()
        yield frames, list(zip(renderers, presenters, strict=True)), surface
        for renderer, presenter in zip(renderers, presenters, strict=True):
            renderer.release()
            presenter.release()


def one_frame(renderer: Renderer, presenter: Presenter, runtime: MotionTimes, clock: Stopwatch) -> tuple[float, float]:
    """Return the times from the latched pose, and from the first one, to submission, without drawing [ms]."""
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
