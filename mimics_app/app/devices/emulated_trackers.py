"""Emulated trackers on a scripted person: `mimics devices emulate fastrak|flock|vrpn|osc`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from mimics_app.contracts.clock import SECOND_NS, MonotonicClock
from mimics_app.contracts.errors import DeviceError, UsageError, nearest
from mimics_app.inputs.trackers.scripted_person import PERSON_SENSORS, person_at, person_quaternion

__all__ = ["ROBOTS", "TRACKERS", "check_emulated", "open_tracker", "report_on"]

ROBOTS = ("serial", "hapticmaster", "lokomat")
"""Robots that can be emulated, see `app.devices.emulator`."""

TRACKERS = ("fastrak", "flock", "vrpn", "osc")
"""Kinds of trackers that can be emulated: on a pseudo-terminal, as a VRPN server, as a sender of OSC."""

_PERIOD_NS = 8_333_333
"""Period of the reports: 120 Hz [ns]."""
_OSC_PORT = 9000

Report = Callable[[int], None]
"""Sends the poses of the person at a time [ns]."""


def check_emulated(name: str) -> None:
    """Check that a robot or tracker of a name can be emulated.

    Raises:
        UsageError: It cannot.
    """
    known = (*ROBOTS, *TRACKERS)
    if name not in known:
        raise UsageError(f'there is no emulator of "{name}"', nearest(name, known))


@contextmanager
def open_tracker(kind: str, seed: int, port: int = 0) -> Iterator[tuple[str, Report]]:
    """Open an emulated tracker; yield its `address` for a scene, and the function that sends a report.

    Args:
        kind: One of `TRACKERS`.
        seed: Seed of the person.
        port: Port at which the VRPN server listens (0: any), or to which OSC is sent (0: 9000).

    Raises:
        DeviceError: The port is in use, or the system has no pseudo-terminals.
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
        yield line.port, lambda now_ns: None  # its own thread reports, at the pace of the line
    finally:
        line.close()


def report_on(report: Report, seconds: float | None) -> None:
    """Report 120 times a second for a time [s]; None: until a signal ends it."""
    clock = MonotonicClock()
    due = clock.now_ns()
    end = 1 << 62 if seconds is None else due + round(seconds * SECOND_NS)
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
    """Return position [m] and quaternion x y z w of a sensor in the room."""
    place, angles = person_at(sensor, now_ns / SECOND_NS, seed)
    return place, person_quaternion(*angles)
