"""Conformance kit of trackers: what the hub takes for granted of one, built in or of a package."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.ports.tracker_port import TrackerSample, TrackerSource
from mimics_app.inputs.trackers.tape import TapeWriter, read_tape

FRAMES = 30
MOST_FRAMES = 1000
"""Frames after which a tracker that has not reported reports nothing; a line or a stream begins late."""
FRAME_NS = 16_666_667
BEGUN_NS = 5 * SECOND_NS
"""A session's clock does not begin at 0."""
UNIT = 1e-6
"""Largest deviation of a quaternion's length from 1."""


def on_the_virtual_clock(frame: int) -> int:
    """The time of a frame [ns]."""
    return BEGUN_NS + frame * FRAME_NS


def check_tracker(
    tracker: TrackerSource, tape: Path, frame_at: Callable[[int], int] = on_the_virtual_clock
) -> list[TrackerSample]:
    """Poll a tracker as a session does; raises AssertionError at what a tracker must not do.

    Args:
        tracker: Built, not started.
        tape: A file to be written.
        frame_at: Waits for a frame and returns its time [ns]; the device of a tracker with a thread sends meanwhile.

    Returns:
        Its reports.
    """
    assert isinstance(tracker.name, str) and tracker.name, "it has the name that its scene gives it"
    taken: list[TrackerSample] = []
    tracker.poll(frame_at(0))
    tracker.start(taken.append)
    frame = rejected = 0
    while frame < FRAMES or (not taken and frame < MOST_FRAMES):
        frame += 1
        tracker.poll(frame_at(frame))
        _check_state(tracker, rejected)
        rejected = tracker.rejected
    _check_reports(list(taken), frame_at(frame + 1))
    tracker.stop()
    reports = len(taken)
    tracker.poll(frame_at(frame + 2))
    assert len(taken) == reports, "it reports between start and stop"
    assert tracker.problem == ""
    _check_tape(taken, tape)
    return taken


def _check_state(tracker: TrackerSource, rejected: int) -> None:
    assert type(tracker.rejected) is int and tracker.rejected >= rejected, "rejected counts up"
    assert isinstance(tracker.problem, str) and "\n" not in tracker.problem, "a problem is one line"


def _check_reports(taken: list[TrackerSample], now_ns: int) -> None:
    """Rigid poses by sensor, in the order of time on the session's clock."""
    assert taken, "it reports"
    newest: dict[str, int] = {}
    for sample in taken:
        assert isinstance(sample.sensor, str) and sample.sensor, "a sensor has a name"
        assert sample.t_ns >= newest.get(sample.sensor, -1), "no report is older than the last of its sensor"
        newest[sample.sensor] = sample.t_ns
        assert BEGUN_NS - SECOND_NS <= sample.t_ns <= now_ns, "the time of a report is the session's, and past"
        assert len(sample.position) == 3 and all(map(math.isfinite, sample.position)), "a position is finite"
        assert abs(math.hypot(*sample.rotation) - 1.0) <= UNIT, "a rotation is a unit quaternion"


def _check_tape(taken: list[TrackerSample], tape: Path) -> None:
    """What was reported is what a tape plays: plain numbers, to the last bit."""
    writer = TapeWriter(tape)
    try:
        for sample in taken:
            writer.take(sample)
    except TypeError as error:
        raise AssertionError(f"a report can be written on a tape: {error}") from error
    finally:
        writer.close()
    assert list(read_tape(tape)) == taken, "a tape gives back what was reported"
