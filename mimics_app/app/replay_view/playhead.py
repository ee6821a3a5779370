"""The time that a replay shows, and how it advances."""

from __future__ import annotations

__all__ = ["SPEEDS", "Playhead"]

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
"""Speeds of a replay, in session time per time of the person who looks on."""


class Playhead:
    """Time of a replay between its first frame and its last.

    Args:
        length_ns: Time of the last frame [ns].
        speed: The first speed, one of `SPEEDS`.

    Attributes:
        time_ns: The time that is shown, from 0 to `length_ns` [ns].
        playing: Whether it advances on its own; it stops at the end.
    """

    def __init__(self, length_ns: int, speed: float = 1.0) -> None:
        self.length_ns = length_ns
        self.time_ns = 0
        self.playing = True
        self._speed = SPEEDS.index(speed)

    @property
    def speed(self) -> float:
        """Session time per time of the person who looks on."""
        return SPEEDS[self._speed]

    @property
    def share(self) -> float:
        """Share of the run that was shown, 0 to 1."""
        return self.time_ns / self.length_ns if self.length_ns else 1.0

    def advance(self, elapsed_ns: int) -> None:
        """Advance while a time has passed for the person who looks on [ns]."""
        if self.playing:
            self.seek(self.time_ns + round(self.speed * elapsed_ns))
            self.playing = self.time_ns < self.length_ns

    def seek(self, time_ns: int) -> None:
        """Show another time [ns]; one outside of the run is its nearest end."""
        self.time_ns = min(max(0, time_ns), self.length_ns)

    def toggle(self) -> None:
        """Pause or resume; at the end restart."""
        if not self.playing and self.time_ns >= self.length_ns:
            self.time_ns = 0
        self.playing = not self.playing

    def change_speed(self, steps: int) -> None:
        """Advance faster or slower by a number of steps of `SPEEDS`."""
        self._speed = min(max(0, self._speed + steps), len(SPEEDS) - 1)
