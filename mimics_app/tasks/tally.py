"""Measures of a travel: time, path error, contacts, force, smoothness, and those of the task's kinds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from mimics_app.tasks.kinds.kind import KindPlay
from mimics_app.tasks.observation import Contact, Observation
from mimics_app.tasks.smoothness import RESAMPLE_HZ, resample_speed, sparc

__all__ = ["Measures", "Tally"]


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


class Tally:
    """Accumulator of one travel, frame by frame.

    Contacts and extremes are the loop's, of every tick; means and sums are of frames.
    Means are integrals by the trapezoidal rule, so that frames are weighted by their duration.

    Args:
        first: First frame of the travel.
        plays: The task's kinds, with measures of their own.

    Attributes:
        begin_ns: Time at which the travel began [ns].
        contacts: Contacts so far, see `Measures`.
    """

    def __init__(self, first: Observation, plays: Sequence[KindPlay] = ()) -> None:
        self._plays = tuple(plays)
        self.begin_ns = self._last_ns = first.now_ns
        self._paused_ns = 0
        self.contacts = self._partners = first.touching
        self._contact_ns = 0
        self._parted_ns = first.now_ns
        self._touching_since_ns = first.now_ns if first.touching else None
        self._squared_distance_s = 0.0
        self._force_s = 0.0
        self._last = first
        self._on_path_s = 0.0
        self._first_distance = first.distance or 0.0
        self._farthest = first.progress
        self._path = 0.0
        self._times_s = [0.0]
        self._speeds = [first.speed]

    @property
    def time_s(self) -> float:
        """Length of the travel so far [s]."""
        return (self._last_ns - self.begin_ns - self._paused_ns) / 1e9

    def add(self, seen: Observation) -> None:
        """Take the next frame; of one that is not later than the last, only its contacts."""
        for contact in seen.contacts:
            self._take_contact(contact)
        if not seen.contacts and not seen.touching:
            self._close_contact(seen.now_ns)
        if seen.now_ns <= self._last_ns:
            return
        seconds = (seen.now_ns - self._last_ns) / 1e9
        self._add_distance(seen, seconds)
        self._force_s += 0.5 * seconds * (seen.force + self._last.force)
        self._farthest = max(self._farthest, seen.progress, seen.progress_peak or 0.0)
        self._path += math.dist(seen.hip_world, self._last.hip_world)
        for play in self._plays:
            play.travel(seen, seconds)
        self._times_s.append((seen.now_ns - self.begin_ns - self._paused_ns) / 1e9)
        self._speeds.append(seen.speed)
        self._last, self._last_ns = seen, seen.now_ns

    def pause(self, now_ns: int, paused_ns: int) -> None:
        """Take a frame of a pause, `paused_ns` after the one before it, which does not count."""
        self._close_contact(self._last_ns)
        self._paused_ns += paused_ns
        self._last_ns = now_ns

    def _add_distance(self, seen: Observation, seconds: float) -> None:
        if seen.distance is None:
            return
        before = seen.distance if self._last.distance is None else self._last.distance
        self._on_path_s += seconds
        self._squared_distance_s += 0.5 * seconds * (seen.distance**2 + before**2)

    def row(self) -> dict[str, Any]:
        """Return all measures by column of the trial table."""
        columns = asdict(self.measures())
        for play in self._plays:
            columns |= play.measures
        return columns

    def measures(self) -> Measures:
        """Return the measures so far; a contact in progress counts up to the last frame."""
        open_ns = 0 if self._touching_since_ns is None else max(0, self._last_ns - self._touching_since_ns)
        seconds = self.time_s
        return Measures(
            time_s=seconds,
            path_error_rms_m=self._path_error(),
            path_error_max_m=self._largest_distance(),
            contacts=self.contacts,
            contact_time_s=(self._contact_ns + open_ns) / 1e9,
            smoothness=sparc(resample_speed(np.array(self._times_s), np.array(self._speeds)), RESAMPLE_HZ),
            force_mean_n=self._force_s / seconds if seconds > 0.0 else self._last.force,
            force_peak_n=self._last.force_peak,
            progress=self._farthest if self._plays else None,
            path_m=self._path,
        )

    def _path_error(self) -> float | None:
        return math.sqrt(self._squared_distance_s / self._on_path_s) if self._on_path_s > 0.0 else self._last.distance

    def _largest_distance(self) -> float | None:
        """Return the largest distance of every tick, the one at which the travel began included [m]."""
        peak = self._last.distance_peak
        return None if peak is None else max(peak, self._first_distance)

    def _take_contact(self, contact: Contact) -> None:
        if contact.t_ns < self.begin_ns:
            return
        if not contact.begins:
            self._partners -= 1
            if self._partners <= 0:
                self._close_contact(contact.t_ns)
            return
        self.contacts += 1
        self._partners += 1
        if self._touching_since_ns is None:  # one whose event comes a frame late counts from where the last ended
            self._touching_since_ns = max(contact.t_ns, self._parted_ns)

    def _close_contact(self, t_ns: int) -> None:
        self._partners = 0
        if self._touching_since_ns is not None:
            self._parted_ns = max(t_ns, self._touching_since_ns)
            self._contact_ns += self._parted_ns - self._touching_since_ns
            self._touching_since_ns = None
