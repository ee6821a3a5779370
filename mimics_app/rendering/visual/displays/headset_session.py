"""The session of a headset: states, frames and their order, for any runtime.

    IDLE -> READY -> (begin) SYNCHRONIZED -> VISIBLE <-> FOCUSED -> STOPPING -> (end) IDLE -> EXITING
    LOSS_PENDING in any state, or a call that fails: the runtime is opened again, at most three times.

A frame is waited for, begun, located, drawn if it is visible, and ended with a picture or empty.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.display_port import (
    DisplayFrame,
    Eye,
    FrameTiming,
    HeadsetState,
    Rect,
    Size,
    Tangents,
    Viewpoint,
)
from mimics_app.contracts.ports.tracker_port import TrackerSample
from mimics_app.maths.poses import quaternion_of
from mimics_app.rendering.visual.displays.plain_display import PlainDisplay

__all__ = ["EyeLocation", "HeadsetDisplay", "HeadsetRuntime", "RuntimeLostError", "sample_of"]

_MAX_TRIES = 3
"""Maximum number of attempts to open a lost runtime again between two visible frames."""
_RETRY_NS = 1_000_000_000
"""Interval between failed attempts [ns]."""
_RUNNING = (HeadsetState.SYNCHRONIZED, HeadsetState.VISIBLE, HeadsetState.FOCUSED)


class RuntimeLostError(DeviceError):
    """The connection to a runtime was lost: it has to be opened again."""


@dataclass(frozen=True, slots=True, eq=False)
class EyeLocation:
    """Pose and frustum of an eye at a time.

    Attributes:
        rest_from_eye: Its pose in the frame of the head at rest, float64 [4, 4].
        tangents: Tangents left, right, bottom, top.
    """

    rest_from_eye: F8
    tangents: Tangents


class HeadsetRuntime(Protocol):
    """Runtime of a headset: OpenXR or its simulation. Every call but `close` may raise RuntimeLostError."""

    def eye_size(self, shown: Size) -> Size:
        """Return the size of each eye's picture [px] for a requested picture of size `shown`."""
        ...

    def states(self) -> list[HeadsetState]:
        """Return the states entered since the last call, oldest first."""
        ...

    def begin_session(self) -> None:
        """Begin the session, after READY."""
        ...

    def end_session(self) -> None:
        """End the session, after STOPPING."""
        ...

    def rebuild(self) -> None:
        """Free everything and open the runtime again, after LOSS_PENDING.

        Raises:
            DeviceError: the runtime is not available any more.
        """
        ...

    def wait_frame(self, now_ns: int) -> FrameTiming:
        """Wait until it is time to draw; return the timing of the frame."""
        ...

    def begin_frame(self) -> None:
        """Begin a frame, between `wait_frame` and `locate`."""
        ...

    def locate(self, display_ns: int) -> list[EyeLocation]:
        """Return the left and the right eye at a time."""
        ...

    def end_frame(self, display_ns: int, eyes: list[EyeLocation], frame: DisplayFrame | None) -> None:
        """End a frame with a picture of both eyes side by side, or None."""
        ...

    def tracked(self) -> Sequence[TrackerSample]:
        """Return head and hands in the frame of the head at rest, at the display time of the newest frame."""
        ...

    def take_pressed(self) -> Sequence[str]:
        """See `Display.take_pressed`."""
        ...

    def close(self) -> None:
        """Free everything."""
        ...


class HeadsetDisplay(PlainDisplay):
    """A headset with a runtime, which does lens correction, reprojection and frame pacing itself.

    Args:
        kind: "openxr" or "sim-hmd".
        runtime: The runtime; closed with the display.

    Attributes:
        state: State of the session.
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
            DeviceError: the runtime was lost for good.
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
        self._lost = self._lost or "the graphics context was lost"

    def close(self) -> None:
        with suppress(DeviceError):  # a lost runtime can end nothing
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
                self._lost = "the runtime announced its loss"
                self._rebuild()
            elif state is HeadsetState.EXITING:
                self.leaving = True

    def _lose(self, error: RuntimeLostError) -> None:
        """Record that nothing of the present session can be used any more."""
        self._lost = str(error)

    def _rebuild(self) -> None:
        now_ns = MonotonicClock().now_ns()
        if now_ns < self._retry_ns:
            return
        if self._tries == _MAX_TRIES:
            raise DeviceError(f"the headset was lost ({self._lost})", "restart its runtime")
        self.note("the headset's runtime was lost and is opened again")
        self._tries, self.state = self._tries + 1, HeadsetState.IDLE
        try:
            self._runtime.rebuild()
        except DeviceError as error:
            self._lost, self._retry_ns = str(error), now_ns + _RETRY_NS
        else:
            self._lost = ""


def sample_of(sensor: str, t_ns: int, rest_from_part: F8) -> TrackerSample:
    """Return a pose as a tracker's sample."""
    x, y, z = (float(value) for value in rest_from_part[:3, 3])
    qx, qy, qz, qw = (float(value) for value in quaternion_of(rest_from_part[:3, :3]))
    return TrackerSample(sensor, t_ns, (x, y, z), (qx, qy, qz, qw))


def _resting(x: float) -> EyeLocation:
    pose = np.eye(4)
    pose[0, 3] = x
    return EyeLocation(pose, (-1.0, 1.0, -1.0, 1.0))


_RESTING = [_resting(-0.0315), _resting(0.0315)]
"""Eyes before they are first located."""
