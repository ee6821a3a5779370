"""Measures of a travel: time, path error, contacts, force, smoothness, and those of the task's kinds.

Those of a device with several points of contact are followed for each of them, too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.tasks.kinds.kind import KindPlay
from mimics_app.tasks.observation import Contact, Observation, PointObservation

__all__ = ["RESAMPLE_HZ", "Measures", "PointMeasures", "Tally", "resample_speed", "sparc"]

RESAMPLE_HZ = 60.0
"""Rate [Hz] of the speed profile passed to `sparc`; three times its widest band, and the usual frame rate."""

_CUTOFF_HZ = 10.0  # highest frequency of the spectrum that is used [Hz]
_AMPLITUDE_THRESHOLD = 0.05  # share of the largest amplitude that ends the arc
_PAD_LEVEL = 4  # the spectrum is padded to 2^4 times the length


def sparc(speed: NDArray[np.float64], rate: float) -> float | None:
    """Spectral arc length of a speed profile; closer to 0 is smoother, one minimum-jerk reach gives -1.41.

    The length of the normalised Fourier magnitude up to the last frequency (at most 10 Hz) where it reaches 0.05, with
    the frequency axis scaled to 1; it depends neither on the movement's amplitude nor on its duration. Balasubramanian,
    Melendez-Calderon, Roby-Brami, Burdet (2015), On the analysis of movement smoothness, Journal of NeuroEngineering
    and Rehabilitation 12:112.

    Args:
        speed: Speed [m/s, any unit], shape [n].
        rate: Its sampling rate [Hz], >= 20.

    Returns:
        The arc length [-], or None where there is no movement to evaluate (fewer than 4 samples, or all zero).
    """
    if speed.shape[0] < 4 or not speed.any():
        return None
    length = 1 << (int(np.ceil(np.log2(speed.shape[0]))) + _PAD_LEVEL)
    magnitude = np.abs(np.fft.rfft(speed, length))
    band = magnitude[: int(np.floor(_CUTOFF_HZ * length / rate)) + 1]
    band = band / band.max()
    last = int(np.flatnonzero(band >= _AMPLITUDE_THRESHOLD)[-1])
    if last == 0:
        return None
    return -float(np.sum(np.hypot(1.0 / last, np.diff(band[: last + 1]))))


def resample_speed(times_s: NDArray[np.float64], speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Speeds at `RESAMPLE_HZ` by linear interpolation.

    Args:
        times_s: When the speeds were seen [s], rising, shape [n].
        speeds: [m/s], shape [n].

    Returns:
        Shape [m], from the first time to the last whole period before the end; empty for fewer than two times.
    """
    if times_s.shape[0] < 2:
        return np.zeros(0)
    count = int(np.floor((times_s[-1] - times_s[0]) * RESAMPLE_HZ + 1e-9)) + 1
    return np.interp(times_s[0] + np.arange(count) / RESAMPLE_HZ, times_s, speeds)


@dataclass(frozen=True, slots=True)
class Measures:
    """Measures of one travel.

    Attributes:
        time_s: Duration [s].
        path_error_rms_m: Root mean square distance from the task's path over the time in which there is one [m]; None
            without a path.
        path_error_max_m: Largest distance [m], of every tick; None where the loop follows no path.
        contacts: Number of contacts, including those that lasted when the travel began.
        contact_time_s: Time in contact with at least one partner [s].
        smoothness: SPARC [-], negative; None without movement.
        force_mean_n: Time mean of the force felt [N].
        force_peak_n: Largest force felt [N], of every tick.
        progress: Largest progress, 0-1; None where the task has none.
        path_m: Length of the hand's path [m].
    """

    time_s: float = 0.0
    path_error_rms_m: float | None = None
    path_error_max_m: float | None = None
    contacts: int = 0
    contact_time_s: float = 0.0
    smoothness: float | None = None
    force_mean_n: float = 0.0
    force_peak_n: float = 0.0
    progress: float | None = None
    path_m: float = 0.0


@dataclass(frozen=True, slots=True)
class PointMeasures:
    """Measures of one point of contact in a travel, of a device with several; as in `Measures`.

    Attributes:
        contacts: Number of its contacts.
        contact_time_s: Time in which it touched at least one partner [s].
        force_mean_n: Time mean of the force felt there [N].
        force_peak_n: Largest force felt there [N], of every tick.
        path_m: Length of its path [m].
        smoothness: SPARC of its speed [-], negative; None without movement.
        path_error_rms_m: Root mean square distance from the bisector of its tunnel [m]; None without one.
        path_error_max_m: Largest distance [m], of every tick; None without a tunnel.
        progress: Largest progress in its tunnel, 0-1; None without one.
        work_j: Work of the person there [J].
    """

    contacts: int
    contact_time_s: float
    force_mean_n: float
    force_peak_n: float
    path_m: float
    smoothness: float | None
    path_error_rms_m: float | None
    path_error_max_m: float | None
    progress: float | None
    work_j: float


class _Contacts:
    """Contacts of one point, or of all together, with their times.

    Attributes:
        count: Contacts so far, those that lasted at the begin included.
    """

    def __init__(self, touching: int, now_ns: int) -> None:
        self.count = self._partners = touching
        self._begin_ns = self._parted_ns = now_ns
        self._touched_ns = 0
        self._since_ns = now_ns if touching else None

    def see(self, contacts: Sequence[Contact], touching: int, now_ns: int) -> None:
        """Take the contacts since the last frame, and the number of partners now."""
        for contact in contacts:
            self._take(contact)
        if not contacts and not touching:
            self.part(now_ns)

    def part(self, t_ns: int) -> None:
        """Let the hand touch nothing from a time on."""
        self._partners = 0
        if self._since_ns is not None:
            self._parted_ns = max(t_ns, self._since_ns)
            self._touched_ns += self._parted_ns - self._since_ns
            self._since_ns = None

    def seconds(self, now_ns: int) -> float:
        """Return the time in contact [s]; a contact in progress counts up to now."""
        lasting_ns = 0 if self._since_ns is None else max(0, now_ns - self._since_ns)
        return (self._touched_ns + lasting_ns) / 1e9

    def _take(self, contact: Contact) -> None:
        if contact.t_ns < self._begin_ns:
            return
        if not contact.begins:
            self._partners -= 1
            if self._partners <= 0:
                self.part(contact.t_ns)
            return
        self.count += 1
        self._partners += 1
        if self._since_ns is None:  # one whose event comes a frame late counts from where the last ended
            self._since_ns = max(contact.t_ns, self._parted_ns)


class _Movement:
    """Path, speed and force of one point over the time of a travel."""

    def __init__(self, point: PointObservation | Observation) -> None:
        self.path = self._force_s = 0.0
        self._times_s, self._speeds = [0.0], [point.speed]
        self.last = point

    def add(self, point: PointObservation | Observation, seconds: float, time_s: float) -> None:
        """Take the next frame, `seconds` after the last, at a time of the travel [s]."""
        self._force_s += 0.5 * seconds * (point.force + self.last.force)
        self.path += math.dist(point.hip_world, self.last.hip_world)
        self._times_s.append(time_s)
        self._speeds.append(point.speed)
        self.last = point

    def mean_force(self, seconds: float) -> float:
        """Return the mean of the force over the travel of a length [N]."""
        return self._force_s / seconds if seconds > 0.0 else self.last.force

    @property
    def smoothness(self) -> float | None:
        """SPARC [-]; None without movement."""
        return sparc(resample_speed(np.array(self._times_s), np.array(self._speeds)), RESAMPLE_HZ)


class _PointTally:
    """Accumulator of one point of contact."""

    def __init__(self, first: PointObservation, now_ns: int) -> None:
        self.contacts, self._movement = _Contacts(first.touching, now_ns), _Movement(first)
        self._squared_distance_s, self._first, self._last = 0.0, first, first

    def add(self, point: PointObservation, seconds: float, time_s: float) -> None:
        self._squared_distance_s += 0.5 * seconds * (point.distance**2 + self._last.distance**2)
        self._movement.add(point, seconds, time_s)
        self._last = point

    def measures(self, seconds: float, now_ns: int) -> PointMeasures:
        last = self._last
        farthest = max(last.distance_peak, self._first.distance)
        follows = farthest > 0.0  # a ball that is in a tunnel is never on its bisector to the last bit all the way
        mean_square = self._squared_distance_s / seconds if seconds > 0.0 else last.distance**2
        return PointMeasures(
            contacts=self.contacts.count,
            contact_time_s=self.contacts.seconds(now_ns),
            force_mean_n=self._movement.mean_force(seconds),
            force_peak_n=last.force_peak,
            path_m=self._movement.path,
            smoothness=self._movement.smoothness,
            path_error_rms_m=math.sqrt(mean_square) if follows else None,
            path_error_max_m=farthest if follows else None,
            progress=max(last.progress_peak, self._first.progress) if follows else None,
            work_j=last.own_work,
        )


class Tally:
    """Accumulator of one travel, frame by frame.

    Contacts and extremes are the loop's, of every tick; means and sums are of frames.
    Means are integrals by the trapezoidal rule, so that frames are weighted by their duration.

    Args:
        first: First frame of the travel.
        plays: The task's kinds, with measures of their own.

    Attributes:
        begin_ns: Time at which the travel began [ns].
    """

    def __init__(self, first: Observation, plays: Sequence[KindPlay] = ()) -> None:
        self._plays = tuple(plays)
        self.begin_ns = self._last_ns = first.now_ns
        self._paused_ns = 0
        self._contacts, self._movement = _Contacts(first.touching, first.now_ns), _Movement(first)
        several = first.points if len(first.points) > 1 else ()
        self._points = [_PointTally(point, first.now_ns) for point in several]
        self._squared_distance_s = 0.0
        self._last = first
        self._on_path_s = 0.0
        self._first_distance = first.distance or 0.0
        self._farthest = first.progress

    @property
    def contacts(self) -> int:
        """Contacts so far, see `Measures`."""
        return self._contacts.count

    @property
    def time_s(self) -> float:
        """Length of the travel so far [s]."""
        return (self._last_ns - self.begin_ns - self._paused_ns) / 1e9

    def add(self, seen: Observation) -> None:
        """Take the next frame; of one that is not later than the last, only its contacts."""
        self._contacts.see(seen.contacts, seen.touching, seen.now_ns)
        for number, (tally, point) in enumerate(zip(self._points, seen.points, strict=False)):
            own = [contact for contact in seen.contacts if contact.point == number]
            tally.contacts.see(own, point.touching, seen.now_ns)
        if seen.now_ns <= self._last_ns:
            return
        seconds = (seen.now_ns - self._last_ns) / 1e9
        time_s = (seen.now_ns - self.begin_ns - self._paused_ns) / 1e9
        self._add_distance(seen, seconds)
        self._farthest = max(self._farthest, seen.progress, seen.progress_peak or 0.0)
        self._movement.add(seen, seconds, time_s)
        for tally, point in zip(self._points, seen.points, strict=False):
            tally.add(point, seconds, time_s)
        for play in self._plays:
            play.travel(seen, seconds)
        self._last, self._last_ns = seen, seen.now_ns

    def pause(self, now_ns: int, paused_ns: int) -> None:
        """Take a frame of a pause, `paused_ns` after the one before it, which does not count."""
        for contacts in (self._contacts, *(tally.contacts for tally in self._points)):
            contacts.part(self._last_ns)
        self._paused_ns += paused_ns
        self._last_ns = now_ns

    def _add_distance(self, seen: Observation, seconds: float) -> None:
        if seen.distance is None:
            return
        before = seen.distance if self._last.distance is None else self._last.distance
        self._on_path_s += seconds
        self._squared_distance_s += 0.5 * seconds * (seen.distance**2 + before**2)

    def row(self) -> dict[str, Any]:
        """Return all measures by column of the trial table; those of the second point as "point_1_force_peak_n"."""
        columns = asdict(self.measures())
        for play in self._plays:
            columns |= play.measures
        for number, tally in enumerate(self._points):
            measures = asdict(tally.measures(self.time_s, self._last_ns))
            columns |= {f"point_{number}_{name}": value for name, value in measures.items()}
        return columns

    def measures(self) -> Measures:
        """Return the measures so far; a contact in progress counts up to the last frame."""
        seconds = self.time_s
        return Measures(
            time_s=seconds,
            path_error_rms_m=self._path_error(),
            path_error_max_m=self._largest_distance(),
            contacts=self._contacts.count,
            contact_time_s=self._contacts.seconds(self._last_ns),
            smoothness=self._movement.smoothness,
            force_mean_n=self._movement.mean_force(seconds),
            force_peak_n=self._last.force_peak,
            progress=self._farthest if self._plays else None,
            path_m=self._movement.path,
        )

    def _path_error(self) -> float | None:
        return math.sqrt(self._squared_distance_s / self._on_path_s) if self._on_path_s > 0.0 else self._last.distance

    def _largest_distance(self) -> float | None:
        """Return the largest distance of every tick, the one at which the travel began included [m]."""
        peak = self._last.distance_peak
        return None if peak is None else max(peak, self._first_distance)
