"""The life of a headset's session: states, frames and their order, whatever runtime is below.

    IDLE -> READY -> (begin) SYNCHRONIZED -> VISIBLE <-> FOCUSED -> STOPPING -> (end) IDLE -> EXITING
    LOSS_PENDING from anywhere: everything of the runtime is made anew.

A frame is waited for, begun, located, drawn where somebody sees it, and ended: with a picture, or empty.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

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
from mimics_app.rendering.visual.displays.plain_display import PlainDisplay

__all__ = ["EyeLocation", "HeadsetDisplay", "HeadsetRuntime"]

F8 = NDArray[np.float64]
_RUNNING = (HeadsetState.SYNCHRONIZED, HeadsetState.VISIBLE, HeadsetState.FOCUSED)


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
    """What is below: OpenXR or its simulation. Every call that may fail raises DeviceError."""

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
        """After LOSS_PENDING: free everything and begin anew."""
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

    def drawn_size(self, shown: Size) -> Size:
        width, height = self._runtime.eye_size(shown)
        return 2 * width, height

    def begin_frame(self, now_ns: int) -> FrameTiming:
        self._follow_states()
        if self.state not in _RUNNING:
            self._timing = None
            return FrameTiming(now_ns, render=False)
        timing = self._runtime.wait_frame(now_ns)
        self._runtime.begin_frame()
        self._timing = timing
        return timing

    def eyes(self, viewpoint: Viewpoint, drawn: Size, display_ns: int) -> list[Eye]:
        self._located = self._runtime.locate(display_ns)
        half = drawn[0] // 2
        places: list[Rect] = [(0, 0, half, drawn[1]), (half, 0, drawn[0] - half, drawn[1])]
        each = zip(("left", "right"), self._located, places, strict=True)
        return [
            Eye(name, viewpoint.world_from_rest @ eye.rest_from_eye, eye.tangents, place, pair=0)
            for name, eye, place in each
        ]

    def end_frame(self, frame: DisplayFrame | None) -> None:
        timing, self._timing = self._timing, None
        if timing is not None:
            self._runtime.end_frame(timing.display_ns, self._located, frame if timing.render else None)

    def close(self) -> None:
        if self._timing is not None:
            self.end_frame(None)
        if self.state in _RUNNING:
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
                self.note("the headset's runtime was lost and is opened anew")
                self._runtime.rebuild()
                self.state = HeadsetState.IDLE
            elif state is HeadsetState.EXITING:
                self.leaving = True
