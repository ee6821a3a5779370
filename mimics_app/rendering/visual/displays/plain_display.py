"""What displays without a session of their own have in common: they show a frame when it is there."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np

from mimics_app.contracts.display_port import (
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
from mimics_app.contracts.tracker_port import TrackerSample

__all__ = ["PlainDisplay", "eye_offset", "no_head"]


def no_head(now_ns: int) -> None:
    """No tracker: the head is at rest."""
    return


def eye_offset(x: float) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """head_from_eye of an eye beside the middle of the head [m], which turns with the head; float64 [4, 4]."""
    pose = np.eye(4)
    pose[0, 3] = x
    return pose


class PlainDisplay(Display):
    """Shows every frame at once and paces nothing."""

    composing: Composing | None = None
    leaving = False
    windows: Sequence[WindowPlace] = ()

    def __init__(self) -> None:
        self.head: HeadSource = no_head
        self._faults: dict[str, bool] = {}

    def drawn_size(self, shown: Size) -> Size:
        return shown

    def begin_frame(self, now_ns: int) -> FrameTiming:
        return FrameTiming(now_ns)

    @abstractmethod
    def eyes(self, viewpoint: Viewpoint, drawn: Size, display_ns: int) -> list[Eye]:
        """Depends on what is looked at: every display says it for itself."""

    def end_frame(self, frame: DisplayFrame | None) -> None:
        """The surface shows it."""

    def take_faults(self) -> list[str]:
        new = [what for what, taken in self._faults.items() if not taken]
        self._faults = dict.fromkeys(self._faults, True)
        return new

    def tracked(self) -> Sequence[TrackerSample]:
        return ()

    def take_pressed(self) -> Sequence[str]:
        return ()

    def renew(self) -> None:
        """Nothing of it lives in a context."""

    def close(self) -> None:
        """Nothing is open."""

    def note(self, fault: str) -> None:
        """Remember a fault; reported once."""
        self._faults.setdefault(fault, False)
