"""All trackers of a session in one room: who reports, what each sensor is, and where it is at a time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.display_port import MAX_PREDICTION_NS
from mimics_app.contracts.input_port import WindowFrame
from mimics_app.contracts.tracker_port import TrackedPose, TrackerSample, TrackerSource
from mimics_app.inputs.trackers.calibration import Calibration
from mimics_app.inputs.trackers.headset_tracker import HeadsetTracker
from mimics_app.inputs.trackers.pointer_tracker import PointerTracker
from mimics_app.inputs.trackers.scripted_person import ScriptedPerson
from mimics_app.inputs.trackers.tape import TapeWriter
from mimics_app.inputs.trackers.track import Track

__all__ = ["Placed", "TrackerHub"]


_UPSIDE_DOWN = -0.5
"""Cosine between a head's up and the room's below which nobody stands or lies: 120 degrees."""


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """A tracker with its place in the room.

    Attributes:
        source: What reports.
        roles: Role by sensor: "head", "hand_left"; sensors not named play none.
        axes: Rotation from its axes to the room's, float64 [3, 3].
        unit: Metres per unit of what it reports beyond its own conversion.
        calibration: From there into the room.
        offset: sensor_from_part: where the part of the body is from its sensor, float64 [4, 4].
    """

    source: TrackerSource
    roles: Mapping[str, str]
    axes: F8 = field(default_factory=lambda: np.eye(3))
    unit: float = 1.0
    calibration: Calibration = field(default_factory=Calibration.none)
    offset: F8 = field(default_factory=lambda: np.eye(4))


class TrackerHub:
    """Where head and hands are; asked by displays and avatars, each for the time it needs.

    Args:
        trackers: In order of precedence: the first that knows a role gives it.
        tape: Keeps every report in the order of arrival, None for no tape.
    """

    def __init__(self, trackers: Sequence[Placed] = (), tape: TapeWriter | None = None) -> None:
        self._trackers = tuple(trackers)
        self._tape = tape
        self._tracks: dict[tuple[int, str], Track] = {}
        self._problems: dict[str, bool] = {}

    @property
    def roles(self) -> tuple[str, ...]:
        """All that some tracker has, in their order."""
        return tuple(dict.fromkeys(role for each in self._trackers for role in each.roles.values()))

    def take_problems(self) -> list[str]:
        """What has gone wrong with trackers since the last call, a line each; each is reported once."""
        for each in self._trackers:
            self._note(each, each.source.problem or each.calibration.fault)
        new = [what for what, taken in self._problems.items() if not taken]
        self._problems = dict.fromkeys(self._problems, True)
        return new

    def _note(self, tracker: Placed, problem: str) -> None:
        if problem:
            self._problems.setdefault(f"tracker {tracker.source.name}: {problem}", False)

    def _doubt(self, tracker: Placed, role: str, found: TrackedPose) -> None:
        """Remember what cannot be right about where a part of the body is said to be."""
        if found.capped and not found.stale:
            least_ms = MAX_PREDICTION_NS // 1_000_000
            self._note(
                tracker, f"the {role} is requested past {least_ms} ms after a report; it is predicted no farther"
            )
        if role == "head" and found.pose[1, 1] < _UPSIDE_DOWN:
            self._note(tracker, "the head is upside down: turn its sensor over, or correct `axes` or its `offset`")

    def start(self) -> None:
        """Begin to listen.

        Raises:
            DeviceError: a tracker cannot be had; those begun before it are stopped.
        """
        begun: list[TrackerSource] = []
        try:
            for number, each in enumerate(self._trackers):
                each.source.start(lambda sample, number=number: self._take(number, sample))  # type: ignore[misc]
                begun.append(each.source)
        except BaseException:
            for source in begun:
                source.stop()
            raise

    def see(self, frame: WindowFrame) -> None:
        """What happened at the window, for those that follow mouse and gamepad."""
        for each in self._trackers:
            if isinstance(each.source, PointerTracker):
                each.source.see(frame)

    def listen_to(self, display: Callable[[], Sequence[TrackerSample]]) -> None:
        """What the display itself knows of head and hands, for those that report it."""
        for each in self._trackers:
            if isinstance(each.source, HeadsetTracker):
                each.source.listen_to(display)

    def poll(self, now_ns: int) -> None:
        """Once a frame."""
        for each in self._trackers:
            each.source.poll(now_ns)

    def pose(self, role: str, at_ns: int) -> TrackedPose | None:
        """room_from_part of a role at a time [ns]; None where no tracker has reported it yet."""
        stale: TrackedPose | None = None
        for number, each in enumerate(self._trackers):
            if stale is not None and isinstance(each.source, ScriptedPerson):
                continue  # a person who was there does not go on as one who is not
            for sensor in (sensor for sensor, played in each.roles.items() if played == role):
                track = self._tracks.get((number, sensor))
                found = None if track is None else track.pose(at_ns)
                if found is None:
                    continue
                placed = TrackedPose(_place(each, found.pose), found.age_ns, found.stale, found.capped)
                self._doubt(each, role, placed)
                if not placed.stale:
                    return placed
                stale = stale or placed
        return stale

    def head(self, at_ns: int) -> F8 | None:
        """room_from_head for displays, float64 [4, 4]; of a stale one its last place."""
        found = self.pose("head", at_ns)
        return None if found is None else found.pose

    def stop(self) -> None:
        """End all of them."""
        for each in self._trackers:
            each.source.stop()
        if self._tape is not None:
            self._tape.close()
            self._tape = None

    def _take(self, number: int, sample: TrackerSample) -> None:
        self._tracks.setdefault((number, sample.sensor), Track()).add(sample)
        if self._tape is not None:
            self._tape.take(sample)


def _place(tracker: Placed, pose: F8) -> F8:
    """From what a device reports into the room."""
    mapped = np.eye(4)
    mapped[:3, :3] = tracker.axes @ pose[:3, :3] @ tracker.axes.T
    mapped[:3, 3] = tracker.unit * (tracker.axes @ pose[:3, 3])
    return np.asarray(tracker.calibration.apply(mapped) @ tracker.offset)
