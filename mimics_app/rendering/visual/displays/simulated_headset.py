"""A simulated headset: scripted head, states and dropped frames on the session's clock, and a compositor.

It is as strict as a runtime may be: calls out of order are errors, and the submitted eyes must be the located ones.
"""

from __future__ import annotations

from bisect import bisect_right

import numpy as np

from mimics_app.contracts.arrays import F8, U1
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.display_port import DisplayFrame, FrameTiming, HeadsetState, Size
from mimics_app.contracts.ports.tracker_port import TrackerSample
from mimics_app.maths.poses import interpolate_pose, pose_from_parts
from mimics_app.rendering.visual.displays.headset_file import HeadsetSpec
from mimics_app.rendering.visual.displays.headset_session import EyeLocation, HeadsetRuntime, sample_of

__all__ = ["SimulatedRuntime"]

_NS = 1_000_000_000
_UP = (HeadsetState.READY, HeadsetState.SYNCHRONIZED, HeadsetState.VISIBLE, HeadsetState.FOCUSED)
_SEEN = (HeadsetState.VISIBLE, HeadsetState.FOCUSED)


class SimulatedRuntime(HeadsetRuntime):
    """A deterministic runtime: everything follows from the file and the times of the calls.

    Args:
        spec: Headset and script.

    Attributes:
        calls: Names of the calls in order, for tests.
        composed: Picture on the panels, both eyes side by side, RGBA uint8 [height, width, 4]; None before the first.
        shown: Per frame with a picture: display time [ns], time of the located poses [ns], whether it was dropped.
    """

    def __init__(self, spec: HeadsetSpec) -> None:
        self._spec = spec
        self._period = round(_NS / spec.refresh_hz)
        self._heads = [(pose.t, pose_from_parts(pose.position, pose.rotation)) for pose in spec.poses]
        self._waiting: list[HeadsetState] = [HeadsetState.IDLE, *_UP]
        self._scripted = sorted(spec.states, key=lambda each: each.frame)
        self._state = HeadsetState.IDLE
        self._running = self._begun = self._waited = False
        self._frame = -1
        self._asked = 0
        self._located_ns: int | None = None
        self._display_ns: int | None = None
        self._located: list[EyeLocation] = []
        self.calls: list[str] = []
        self.composed: U1 | None = None
        self.shown: list[tuple[int, int, bool]] = []

    def eye_size(self, shown: Size) -> Size:
        return self._spec.pixels or (max(1, shown[0] // 2), shown[1])

    def states(self) -> list[HeadsetState]:
        while self._scripted and self._scripted[0].frame <= self._asked:
            self._waiting.append(HeadsetState(self._scripted.pop(0).state))
        self._asked += 1
        entered, self._waiting = self._waiting, []
        if entered:
            self._state = entered[-1]
        return entered

    def begin_session(self) -> None:
        self._require(not self._running, "begin_session")
        self._running = True

    def end_session(self) -> None:
        self._require(self._running and not self._begun, "end_session")
        self._running = False

    def rebuild(self) -> None:
        self.calls.append("rebuild")
        self._running = self._begun = self._waited = False
        self._state = HeadsetState.IDLE
        self._waiting = [HeadsetState.IDLE, *_UP]

    def wait_frame(self, now_ns: int) -> FrameTiming:
        self._require(self._running and not self._begun, "wait_frame")
        # A frame begun now is displayed at the end of the present period.
        self._frame = now_ns // self._period
        self._waited = True
        late = self._frame in self._spec.dropped
        display_ns = self._display_ns = (self._frame + (2 if late else 1)) * self._period
        return FrameTiming(display_ns, self._period, self._state in _SEEN)

    def begin_frame(self) -> None:
        self._require(self._waited and not self._begun, "begin_frame")
        self._begun, self._waited = True, False

    def locate(self, display_ns: int) -> list[EyeLocation]:
        self.calls.append("locate")
        head = self.head(display_ns)
        self._located_ns = display_ns
        self._located = [
            EyeLocation(head @ pose_from_parts(eye.position, eye.rotation), eye.tangents)
            for eye in (self._spec.left, self._spec.right)
        ]
        return self._located

    def end_frame(self, display_ns: int, eyes: list[EyeLocation], frame: DisplayFrame | None) -> None:
        self._require(self._begun, "end_frame")
        self._begun = False
        if frame is None:
            return
        self._require(self._state in _SEEN, "a picture")
        self._require(eyes is self._located, "eyes as located")
        late = self._frame in self._spec.dropped
        self.shown.append((display_ns, self._located_ns or 0, late))
        if not late:
            self.composed = frame.read()

    def head(self, display_ns: int) -> F8:
        """Return rest_from_head at a time, interpolated in the script; float64 [4, 4]."""
        if not self._heads:
            return np.eye(4)
        t = display_ns / _NS
        after = bisect_right(self._heads, t, key=lambda each: each[0])
        if after in (0, len(self._heads)):
            return self._heads[min(after, len(self._heads) - 1)][1]
        (t0, first), (t1, second) = self._heads[after - 1], self._heads[after]
        return interpolate_pose(first, second, (t - t0) / (t1 - t0))

    def tracked(self) -> list[TrackerSample]:
        """Return the head alone, if it has a script: there are no controllers."""
        if self._display_ns is None or not self._heads:
            return []
        return [sample_of("head", self._display_ns, self.head(self._display_ns))]

    def take_pressed(self) -> list[str]:
        return []

    def close(self) -> None:
        self.calls.append("close")

    def _require(self, allowed: bool, call: str) -> None:
        self.calls.append(call)
        if not allowed:
            raise DeviceError(f"the simulated headset was given {call} out of order", "see displays.headset_session")
