"""Base of displays without a session: they show a frame as soon as it is drawn."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.ports.display_port import (
    Composing,
    Display,
    DisplayFrame,
    Eye,
    FrameTiming,
    HeadSource,
    Size,
    Viewpoint,
    WindowPlace,
)
from mimics_app.contracts.ports.tracker_port import TrackerSample

__all__ = ["PlainDisplay", "eye_offset"]


def _no_head(now_ns: int) -> None:
    """Return None: without a tracker the head is at rest."""
    return


def eye_offset(x: float) -> F8:
    """Return head_from_eye of an eye at a lateral offset from the head's centre [m]; float64 [4, 4]."""
    pose = np.eye(4)
    pose[0, 3] = x
    return pose


class PlainDisplay(Display):
    """Shows every frame at once, without frame pacing."""

    composing: Composing | None = None
    leaving = False
    windows: Sequence[WindowPlace] = ()

    def __init__(self) -> None:
        self.head: HeadSource = _no_head
        self._faults: dict[str, bool] = {}

    def drawn_size(self, shown: Size) -> Size:
        return shown

    def begin_frame(self, now_ns: int) -> FrameTiming:
        return FrameTiming(now_ns)

    @abstractmethod
    def eyes(self, viewpoint: Viewpoint, drawn: Size, display_ns: int) -> list[Eye]:
        """See `Display.eyes`."""

    def end_frame(self, frame: DisplayFrame | None) -> None:
        """Do nothing: the surface shows the frame."""

    def take_faults(self) -> list[str]:
        new = [what for what, taken in self._faults.items() if not taken]
        self._faults = dict.fromkeys(self._faults, True)
        return new

    def tracked(self) -> Sequence[TrackerSample]:
        return ()

    def take_pressed(self) -> Sequence[str]:
        return ()

    def renew(self) -> None:
        """Do nothing: it owns no GPU objects."""

    def close(self) -> None:
        """Do nothing: nothing is open."""

    def note(self, fault: str) -> None:
        """Record a fault, which is reported once."""
        self._faults.setdefault(fault, False)
