"""The life of a headset's session: states, frames and their order, whatever runtime is below.

    IDLE -> READY -> (begin) SYNCHRONIZED -> VISIBLE <-> FOCUSED -> STOPPING -> (end) IDLE -> EXITING
    LOSS_PENDING from anywhere, or a call that fails: everything of the runtime is made anew, three times at most.

A frame is waited for, begun, located, drawn where somebody sees it, and ended: with a picture, or empty.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.display_port import (
    DisplayFrame,
    Eye,
    FrameTiming,
    HeadsetState,
    Rect,
    Size,
    Tangents,
    Viewpoint,
)
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.tracker_port import TrackerSample
from mimics_app.maths.poses import quaternion_of
from mimics_app.rendering.visual.displays.plain_display import PlainDisplay

__all__ = ["EyeLocation", "HeadsetDisplay", "HeadsetRuntime", "RuntimeLostError", "sample_of"]

F8 = NDArray[np.float64]
_MOST_TRIES = 3
"""So often a runtime is opened anew between two frames that were seen; then it is gone for good."""
_RETRY_NS = 1_000_000_000
"""From one try that failed to the next [ns]."""
_RUNNING = (HeadsetState.SYNCHRONIZED, HeadsetState.VISIBLE, HeadsetState.FOCUSED)


class RuntimeLostError(DeviceError):
    """A runtime that answered before does not any more: everything of it is to be made anew."""


@dataclass(frozen=True, slots=True, eq=False)
class EyeLocation:
    """Where an eye is at a time.

    Attributes:
        rest_from_eye: Its whole pose in the frame of the head at rest, float64 [4, 4].
        tangents: Left, right, bottom, top.
    """

    rest_from_eye: F8
    tangents: Tangents


class HeadsetRuntime(Protocol):
    """What is below: OpenXR or its simulation. Every call but `close` may raise RuntimeLostError."""

    def eye_size(self, shown: Size) -> Size:
        """Size of each eye's picture [px] where a whole one of size `shown` was requested."""
        ...

    def states(self) -> list[HeadsetState]:
        """States entered since the last call, oldest first."""
        ...

    def begin_session(self) -> None:
        """After READY."""
        ...

    def end_session(self) -> None:
        """After STOPPING."""
        ...

    def rebuild(self) -> None:
        """After LOSS_PENDING: free everything and begin anew.

        Raises:
            DeviceError: there is none any more.
        """
        ...

    def wait_frame(self, now_ns: int) -> FrameTiming:
        """Wait until it is time to draw; when that will be seen."""
        ...

    def begin_frame(self) -> None:
        """Between waiting and locating."""
        ...

    def locate(self, display_ns: int) -> list[EyeLocation]:
        """The left and the right eye at a time."""
        ...

    def end_frame(self, display_ns: int, eyes: list[EyeLocation], frame: DisplayFrame | None) -> None:
        """Submit a picture of both eyes side by side, or none."""
        ...

    def tracked(self) -> Sequence[TrackerSample]:
        """Head and hands in the frame of the head at rest, at the display time of the newest frame."""
        ...

    def take_pressed(self) -> Sequence[str]:
        """See `Display.take_pressed`."""
        ...

    def close(self) -> None:
        """Free everything."""
        ...


class HeadsetDisplay(PlainDisplay):
    """A headset with a runtime, which does lenses, late reprojection and the pace itself.

    Args:
        kind: "openxr" or "sim-hmd".
        runtime: What is below; closed with the display.

    Attributes:
        state: Of the session.
    """

    def __init__(self, kind: str, runtime: HeadsetRuntime) -> None:
        super().__init__()
        self.kind, self._runtime = kind, runtime
        self.state = HeadsetState.IDLE
        self._timing: FrameTiming | None = None
        self._located: list[EyeLocation] = []
        self._lost, self._tries, self._retry_ns = "", 0, 0

    def drawn_size(self, shown: Size) -> Size:
        width, height = self._runtime.eye_size(shown)
        return 2 * width, height

    def begin_frame(self, now_ns: int) -> FrameTiming:
        """See `Display.begin_frame`.

        Raises:
            DeviceError: the runtime is gone for good.
        """
        self._timing = None
        if self._lost:
            self._rebuild()
        try:
            self._follow_states()
            if self.state in _RUNNING:
                timing = self._runtime.wait_frame(now_ns)
                self._runtime.begin_frame()
                self._timing = timing
        except RuntimeLostError as error:
            self._lose(error)
        return self._timing or FrameTiming(now_ns, render=False)

    def eyes(self, viewpoint: Viewpoint, drawn: Size, display_ns: int) -> list[Eye]:
        try:
            self._located = self._runtime.locate(display_ns)
        except RuntimeLostError as error:
            self._lose(error)
        half = drawn[0] // 2
        places: list[Rect] = [(0, 0, half, drawn[1]), (half, 0, drawn[0] - half, drawn[1])]
        each = zip(("left", "right"), self._located or _RESTING, places, strict=True)
        return [
            Eye(name, viewpoint.world_from_rest @ eye.rest_from_eye, eye.tangents, place, pair=0)
            for name, eye, place in each
        ]

    def end_frame(self, frame: DisplayFrame | None) -> None:
        timing, self._timing = self._timing, None
        if timing is None or self._lost:
            return
        seen = frame if timing.render else None
        try:
            self._runtime.end_frame(timing.display_ns, self._located, seen)
        except RuntimeLostError as error:
            self._lose(error)
        else:
            self._tries = 0 if seen is not None else self._tries

    def tracked(self) -> Sequence[TrackerSample]:
        if self._lost:
            return ()
        try:
            return self._runtime.tracked()
        except RuntimeLostError as error:
            self._lose(error)
            return ()

    def take_pressed(self) -> Sequence[str]:
        return () if self._lost else self._runtime.take_pressed()

    def renew(self) -> None:
        self._lost = self._lost or "the picture's context was made anew"

    def close(self) -> None:
        with suppress(DeviceError):  # of a runtime that is gone nothing can be ended
            if self._timing is not None:
                self.end_frame(None)
            if self.state in _RUNNING and not self._lost:
                self._runtime.end_session()
        self._runtime.close()

    def _follow_states(self) -> None:
        for state in self._runtime.states():
            self.state = state
            if state is HeadsetState.READY:
                self._runtime.begin_session()
            elif state is HeadsetState.STOPPING:
                self._runtime.end_session()
            elif state is HeadsetState.LOSS_PENDING:
                self._lost = "it is about to go"
                self._rebuild()
            elif state is HeadsetState.EXITING:
                self.leaving = True

    def _lose(self, error: RuntimeLostError) -> None:
        """What a failing call means: nothing of this session can be used any more."""
        self._lost = str(error)

    def _rebuild(self) -> None:
        now_ns = MonotonicClock().now_ns()
        if now_ns < self._retry_ns:
            return
        if self._tries == _MOST_TRIES:
            raise DeviceError(f"the headset is gone ({self._lost})", "start its runtime again")
        self.note("the headset's runtime was lost and is opened anew")
        self._tries, self.state = self._tries + 1, HeadsetState.IDLE
        try:
            self._runtime.rebuild()
        except DeviceError as error:
            self._lost, self._retry_ns = str(error), now_ns + _RETRY_NS
        else:
            self._lost = ""


def sample_of(sensor: str, t_ns: int, rest_from_part: F8) -> TrackerSample:
    """A pose as a tracker's report."""
    x, y, z = (float(value) for value in rest_from_part[:3, 3])
    qx, qy, qz, qw = (float(value) for value in quaternion_of(rest_from_part[:3, :3]))
    return TrackerSample(sensor, t_ns, (x, y, z), (qx, qy, qz, qw))


def _resting(x: float) -> EyeLocation:
    pose = np.eye(4)
    pose[0, 3] = x
    return EyeLocation(pose, (-1.0, 1.0, -1.0, 1.0))


_RESTING = [_resting(-0.0315), _resting(0.0315)]
"""Eyes that were never located."""
