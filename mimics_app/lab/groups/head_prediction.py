"""Prediction of a head that rotates by +-30 degrees at 1 Hz, reported at 120 Hz, over several horizons.

Error: the largest angle; cost: of one pose of a track.
"""

from __future__ import annotations

import math
from functools import partial

from mimics_app.contracts.ports.tracker_port import TrackerSample
from mimics_app.inputs.trackers.polhemus import euler_quaternion
from mimics_app.inputs.trackers.track import Track
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.maths.poses import rotation_vector

__all__: list[str] = []

_RATE, _AMPLITUDE, _HZ = 120.0, math.radians(30.0), 1.0
_CALLS = 50


def _angle(t: float) -> float:
    return _AMPLITUDE * math.sin(2.0 * math.pi * _HZ * t)


def _sample(t: float) -> TrackerSample:
    return TrackerSample("1", round(t * 1e9), (0.0, 0.0, 0.0), euler_quaternion(math.degrees(_angle(t)), 0.0, 0.0))


def _prediction_error(horizon_s: float, *, hold: bool = False) -> float:
    """Return the largest error over two seconds [rad].

    Args:
        horizon_s: Time from the newest report to the requested pose [s].
        hold: Use the newest report without prediction.
    """
    track, worst = Track(), 0.0
    for k in range(round(2.0 * _RATE)):
        t = k / _RATE
        track.add(_sample(t))
        pose = track.pose(round((t if hold else t + horizon_s) * 1e9))
        if k < 2 or pose is None:
            continue
        worst = max(worst, abs(float(rotation_vector(pose.pose[:3, :3])[2]) - _angle(t + horizon_s)))
    return worst


def _cost(horizon_s: float) -> float:
    track = Track()
    for k in range(100):
        track.add(_sample(k / _RATE))
    at_ns = round((99 / _RATE + horizon_s) * 1e9)
    return shortest_us(lambda: [track.pose(at_ns) for _ in range(_CALLS)], _CALLS)


def _ahead(ms: int) -> tuple[Rival, Rival]:
    return (
        Rival(
            f"constant velocity, {ms} ms ahead",
            "straight and turning evenly from the last two reports, no farther than 50 ms",
            "to 50 ms; farther the head stays where that ends",
            {} if ms == 50 else None,
            (ms * 1e-3,),
        ),
        Rival(
            f"held, {ms} ms ahead",
            "the newest report as it is",
            "a head at rest",
            cost=partial(_cost, 0.0),
            error=partial(_prediction_error, ms * 1e-3, hold=True),
        ),
    )


compare(
    __name__,
    "a head that turns +-30 degrees at 1 Hz, reported at 120 Hz; error: the largest angle off when it is seen",
    "rad",
    [rival for ms in (20, 30, 50, 100) for rival in _ahead(ms)],
    Probes(_cost, _prediction_error),
    default="constant velocity, 50 ms ahead",
)
