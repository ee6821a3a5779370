"""The trackers of a session in one frame: roles of their sensors, and poses at any time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import DeviceError, MimicsError
from mimics_app.contracts.ports.display_port import MAX_PREDICTION_NS
from mimics_app.contracts.ports.input_port import WindowFrame
from mimics_app.contracts.ports.plugins import raised
from mimics_app.contracts.ports.tracker_port import TrackedPose, TrackerSample, TrackerSource
from mimics_app.inputs.trackers.calibration import Calibration
from mimics_app.inputs.trackers.tape import TapeWriter
from mimics_app.inputs.trackers.track import Track

__all__ = ["MountedTracker", "TrackerHub"]


_MANY_REJECTED = 100
"""Rejected reports of a tracker from which on this is reported; a few are usual."""
_UPSIDE_DOWN = -0.5
"""Cosine between a head's up and the room's below which its sensor is upside down: 120 degrees."""


@dataclass(frozen=True, slots=True, eq=False)
class MountedTracker:
    """A tracker and how it is mounted in the room.

    Attributes:
        source: The tracker.
        roles: Role by sensor: "head", "hand_left"; other sensors are ignored.
        axes: Rotation from its axes to the room's, float64 [3, 3].
        unit: Metres per unit of its reports, beyond its own conversion.
        calibration: Similarity from there to the room's frame.
        offset: sensor_from_part: pose of the body part in the frame of its sensor, float64 [4, 4].
    """

    source: TrackerSource
    roles: Mapping[str, str]
    axes: F8 = field(default_factory=lambda: np.eye(3))
    unit: float = 1.0
    calibration: Calibration = field(default_factory=Calibration.none)
    offset: F8 = field(default_factory=lambda: np.eye(4))


class TrackerHub:
    """Poses of head and hands for displays and avatars, each at the time it needs.

    Args:
        trackers: In order of precedence: the first that has reported a role determines it.
        tape: Recorder of all reports in the order of arrival; None: no tape.
    """

    def __init__(self, trackers: Sequence[MountedTracker] = (), tape: TapeWriter | None = None) -> None:
        self._trackers = tuple(trackers)
        self._tape = tape
        self._tracks: dict[tuple[int, str], Track] = {}
        self._problems: dict[str, bool] = {}
        self._lost: set[int] = set()
        self._simulated: set[int] = set()

    @property
    def roles(self) -> tuple[str, ...]:
        """All roles of the trackers, in their order."""
        return tuple(dict.fromkeys(role for each in self._trackers for role in each.roles.values()))

    def take_problems(self) -> list[str]:
        """Return the problems of trackers and tape since the last call, one line each; each is reported once."""
        for number, each in self._working():
            self._ask(number, partial(self._note_fault, each))
        if self._tape is not None and self._tape.problem:
            self._note("tape of the trackers", self._tape.problem)
        new = [what for what, taken in self._problems.items() if not taken]
        self._problems = dict.fromkeys(self._problems, True)
        return new

    def _note_fault(self, tracker: MountedTracker) -> None:
        if problem := tracker.source.problem or tracker.calibration.fault:
            self._note(_name(tracker), problem)
        if tracker.source.rejected >= _MANY_REJECTED:
            self._note(_name(tracker), f"over {_MANY_REJECTED} reports were damaged, no poses or implausible")

    def _working(self) -> Iterator[tuple[int, MountedTracker]]:
        """Yield the trackers that are not lost, with their numbers."""
        return ((number, each) for number, each in enumerate(self._trackers) if number not in self._lost)

    def _ask(self, number: int, call: Callable[[], None]) -> None:
        """Call a tracker; what it raises makes it a lost one, whose poses grow stale: the session continues."""
        try:
            call()
        except Exception as error:  # noqa: BLE001  of a library or a third party: it must not end the session
            self._lost.add(number)
            self._note(_name(self._trackers[number]), f"it is lost: it {raised(error)}")

    def _note(self, part: str, problem: str) -> None:
        self._problems.setdefault(f"{part}: {problem}", False)

    def _doubt(self, tracker: MountedTracker, role: str, found: TrackedPose) -> None:
        """Note an implausible pose of a body part."""
        if found.capped and not found.stale:
            limit_ms = MAX_PREDICTION_NS // 1_000_000
            self._note(
                _name(tracker), f"the {role} is needed more than {limit_ms} ms after a report; prediction ends there"
            )
        if role == "head" and found.pose[1, 1] < _UPSIDE_DOWN:
            self._note(_name(tracker), "the head is upside down: rotate its sensor, or correct `axes` or its `offset`")

    def start(self) -> None:
        """Start all trackers.

        Raises:
            DeviceError: A tracker is not available; those started before it are stopped.
        """
        begun: list[int] = []
        try:
            for number, each in enumerate(self._trackers):
                self._start(number, each.source)
                begun.append(number)
        except BaseException:
            for number in begun:
                self._ask(number, self._trackers[number].source.stop)
            raise

    def _start(self, number: int, source: TrackerSource) -> None:
        """Start a tracker.

        Raises:
            DeviceError: It is not available, or its plug-in fails.
        """
        try:
            if source.simulated:
                self._simulated.add(number)
            source.start(lambda sample: self._take(number, sample))
        except MimicsError:
            raise
        except Exception as error:
            raise DeviceError(f"the tracker {source.name} cannot be started: it {raised(error)}") from error

    def take_window(self, frame: WindowFrame) -> None:
        """Pass the window's events to the trackers."""
        for number, each in self._working():
            self._ask(number, partial(each.source.take_window, frame))

    def attach_display(self, reports: Callable[[], Sequence[TrackerSample]]) -> None:
        """Pass the display's own tracking of head and hands to the trackers."""
        for number, each in self._working():
            self._ask(number, partial(each.source.attach_display, reports))

    def poll(self, now_ns: int) -> None:
        """Poll all trackers; call once a frame."""
        for number, each in self._working():
            self._ask(number, partial(each.source.poll, now_ns))

    def pose(self, role: str, at_ns: int) -> TrackedPose | None:
        """Return room_from_part of a role at a time [ns]; None where no tracker has reported it yet."""
        stale: TrackedPose | None = None
        for number, each in enumerate(self._trackers):
            if stale is not None and number in self._simulated:
                continue  # a person whose tracking is lost does not continue as a simulated one
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
        """Return room_from_head for displays, float64 [4, 4]; the last pose where it is stale."""
        found = self.pose("head", at_ns)
        return None if found is None else found.pose

    def stop(self) -> None:
        """Stop all trackers and close the tape."""
        for number, each in enumerate(self._trackers):
            self._ask(number, each.source.stop)
        if self._tape is not None:
            self._tape.close()
            self._tape = None

    def _take(self, number: int, sample: TrackerSample) -> None:
        if sample.sensor in self._trackers[number].roles:
            self._tracks.setdefault((number, sample.sensor), Track()).add(sample)
        if self._tape is not None:
            self._tape.take(sample)


def _name(tracker: MountedTracker) -> str:
    """Return the name of a tracker in its problems."""
    return f"tracker {tracker.source.name}"


def _place(tracker: MountedTracker, pose: F8) -> F8:
    """Return room_from_part of a pose that a device reported."""
    mapped = np.eye(4)
    mapped[:3, :3] = tracker.axes @ pose[:3, :3] @ tracker.axes.T
    mapped[:3, 3] = tracker.unit * (tracker.axes @ pose[:3, 3])
    return np.asarray(tracker.calibration.apply(mapped) @ tracker.offset)
