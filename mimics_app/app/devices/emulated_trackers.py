"""Trackers that are not there, worn by a person who is not there: `mimics devices emulate fastrak|flock|vrpn|osc`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.inputs.trackers.polhemus import euler_quaternion
from mimics_app.inputs.trackers.scripted_person import PERSON_SENSORS, person_at

__all__ = ["TRACKERS", "open_tracker", "report_on"]

TRACKERS = ("fastrak", "flock", "vrpn", "osc")
"""Kinds of trackers that can be emulated: on a pseudo-terminal, as a VRPN server, as a sender of OSC."""

_PERIOD_NS = 8_333_333
"""From one report to the next: 120 Hz [ns]."""
_OSC_PORT = 9000
_NS = 1_000_000_000

Report = Callable[[int], None]
"""Send where the person is at a time [ns]."""


@contextmanager
def open_tracker(kind: str, seed: int, port: int = 0) -> Iterator[tuple[str, Report]]:
    """An emulated tracker: what to write as `address` in a scene, and what sends a report.

    Args:
        kind: Of `TRACKERS`.
        seed: Of the person.
        port: A VRPN server listens on (0: any), or OSC is sent to (0: 9000).

    Raises:
        DeviceError: the port is taken, or there are no pseudo-terminals.
    """
    opened = {"vrpn": _vrpn, "osc": _osc}.get(kind)
    if opened is not None:
        with opened(seed, port) as tracker:
            yield tracker
        return
    from mimics_app.inputs.trackers.emulated_line import emulated_fastrak, emulated_flock

    try:
        line = emulated_fastrak(stations=4, seed=seed) if kind == "fastrak" else emulated_flock(seed=seed)
    except (ImportError, OSError) as error:
        raise DeviceError(f"this system has no pseudo-terminals: {error}", "emulate on Linux or macOS") from None
    try:
        yield line.port, lambda now_ns: None  # it reports from a thread of its own, at the pace of the line
    finally:
        line.close()


def report_on(report: Report, seconds: float | None) -> None:
    """Report 120 times a second, until the time is over or a signal ends it."""
    clock = MonotonicClock()
    due = clock.now_ns()
    end = 1 << 62 if seconds is None else due + round(seconds * _NS)
    while due < end:
        report(clock.now_ns())
        due = max(due + _PERIOD_NS, clock.now_ns() - _PERIOD_NS)
        clock.sleep_until_ns(due)


@contextmanager
def _vrpn(seed: int, port: int) -> Iterator[tuple[str, Report]]:
    from mimics_app.inputs.trackers.pose_senders import VrpnServer

    try:
        server = VrpnServer("person", port)
    except OSError as error:
        raise DeviceError(f"port {port} cannot be listened on: {error.strerror}") from None

    def report(now_ns: int) -> None:
        for number, sensor in enumerate(PERSON_SENSORS):
            server.send(number, *_pose(sensor, now_ns, seed), now_ns)

    try:
        yield f"person@127.0.0.1:{server.port}", report
    finally:
        server.close()


@contextmanager
def _osc(seed: int, port: int) -> Iterator[tuple[str, Report]]:
    from mimics_app.inputs.trackers.pose_senders import OscSender

    port = port or _OSC_PORT
    sender = OscSender(port)

    def report(now_ns: int) -> None:
        for sensor in PERSON_SENSORS:
            sender.send(sensor, *_pose(sensor, now_ns, seed))

    try:
        yield f"127.0.0.1:{port}", report
    finally:
        sender.close()


def _pose(sensor: str, now_ns: int, seed: int) -> tuple[tuple[float, float, float], tuple[float, float, float, float]]:
    """Place [m] and quaternion x, y, z, w of a sensor in the room."""
    place, (yaw, pitch, roll) = person_at(sensor, now_ns / _NS, seed)
    x, y, z, w = euler_quaternion(yaw, pitch, roll)
    # The convention turns about z, y, x; a person turns about y, x, z.
    return place, (y, z, x, w)
