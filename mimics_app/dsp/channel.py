"""What the processing of every signal has in common: any block size gives the same, second by second."""

from __future__ import annotations

import copy
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from mimics_app.dsp.filters import Floats

__all__ = ["Channel", "Event", "Found"]


@dataclass(frozen=True, slots=True)
class Event:
    """Something in a signal.

    Attributes:
        t_s: When it was, in seconds of the signal since its first sample.
        known_s: When it was known: no sample after that was looked at.
        kind: "r_peak", "scr", "emg_onset", "breath" ...
        value: RR [s], amplitude [uS], envelope [mV], depth ...
        quality: Of the signal then, 0 to 1.
    """

    t_s: float
    known_s: float
    kind: str
    value: float
    quality: float


@dataclass(frozen=True, slots=True)
class Found:
    """What the seconds up to now say: features by name, and the quality of the last one."""

    features: dict[str, float] = field(default_factory=dict)
    quality: float = 0.0


class Channel(ABC):
    """One signal, fed in blocks of any size, NaN where the sensor gave nothing.

    Args:
        rate: Of the signal [Hz].

    Attributes:
        name: Of the signal.
        latency_s: From an event to when it is known, at most, in clean signals.
        lowest_rate: Below it the signal cannot be read [Hz].
        phase: Share of a second by which its seconds begin before the signal does: not all signals look back at once.
        found: As of the last whole second.
    """

    name: ClassVar[str]
    latency_s: ClassVar[float]
    lowest_rate: ClassVar[float]
    phase: ClassVar[float] = 0.0

    def __init__(self, rate: float) -> None:
        self.rate = rate
        self.samples = 0
        self.found = Found()
        self._length = max(round(rate), 1)
        self._shift = round(self.phase * self._length)
        self._raw = np.full(self._length, np.nan)
        self._last_level = np.nan

    @property
    def seconds(self) -> float:
        """Length of the signal so far [s]."""
        return self.samples / self.rate

    def push(self, values: Floats) -> list[Event]:
        """Take samples, shape [n]; the events that are known now, in the order in which they became known."""
        events: list[Event] = []
        begin = 0
        while begin < len(values):
            filled = self._place
            piece = np.ascontiguousarray(values[begin : begin + self._length - filled], float)
            self._raw[filled : filled + len(piece)] = piece
            events += self._take(piece)
            self.samples += len(piece)
            begin += len(piece)
            if self._place == 0:
                self.found = self._look_back(self._raw)
        return events

    @property
    def _place(self) -> int:
        """Where in its second the next sample stands."""
        return (self.samples + self._shift) % self._length

    def save(self) -> dict[str, Any]:
        """All that is remembered; `restore` goes on from there, bit for bit."""
        return copy.deepcopy(self.__dict__)

    def restore(self, saved: dict[str, Any]) -> None:
        """Go back to what `save` gave."""
        self.__dict__.update(copy.deepcopy(saved))

    @abstractmethod
    def _take(self, piece: Floats) -> list[Event]:
        """New samples within one second; `samples` still counts those before."""

    @abstractmethod
    def _look_back(self, raw: Floats) -> Found:
        """A second is over; its samples as they came."""

    def _contact(self, raw: Floats, *, steps: float = np.inf) -> float:
        """Share of a second in which the sensor was on, not at a rail, not flat; 0 after a jump larger than `steps`."""
        good = np.isfinite(raw)
        if good.sum() < 2:
            return 0.0
        values = raw[good]
        low, high = values.min(), values.max()
        if high == low:
            return 0.0
        railed = int(np.count_nonzero((values == low) | (values == high)))
        railed = railed if railed > 0.02 * len(values) + 3 else 0
        jump = 0.0 if np.isnan(self._last_level) else abs(float(np.median(values)) - self._last_level)
        self._last_level = float(np.median(values))
        return 0.0 if jump > steps else float((len(values) - railed) / len(raw))
