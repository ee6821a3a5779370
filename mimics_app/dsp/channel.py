"""Base class of the signal processing: events sample by sample, features once a second, whatever the block size."""

from __future__ import annotations

import copy
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from mimics_app.dsp.filters import Floats

__all__ = ["Channel", "Event", "FeatureSet"]

_LARGEST = 2.0**24
"""Largest sample in any unit: counts of a 24-bit converter fit, a damaged number or an infinity does not."""


@dataclass(frozen=True, slots=True)
class Event:
    """An event in a signal.

    Attributes:
        t_s: Time of the event since the signal's first sample [s].
        known_s: Time at which it was detected; no later sample was used [s].
        kind: "r_peak", "scr", "emg_onset", "breath" ...
        value: RR [s], amplitude [uS], envelope [mV], depth ...
        quality: Signal quality at that time, 0 to 1.
    """

    t_s: float
    known_s: float
    kind: str
    value: float
    quality: float


@dataclass(frozen=True, slots=True)
class FeatureSet:
    """Features by name as of the last whole second, and the signal quality in it."""

    features: dict[str, float] = field(default_factory=dict)
    quality: float = 0.0


class Channel(ABC):
    """Processing of one signal, fed in blocks of any size, NaN where the sensor gave nothing.

    Args:
        rate: Sampling rate [Hz].

    Attributes:
        name: Name of the signal.
        unit: Its unit, "1" where it has none.
        features: Unit of each of its features, by name.
        latency_s: Longest time from an event to its detection, in clean signals [s].
        lowest_rate: Lowest sampling rate that can be processed [Hz].
        phase: Share of a second by which its seconds begin before the signal does, so that the signals of a session do
            not compute their features in the same frame.
        found: Features and quality as of the last whole second.
    """

    name: ClassVar[str]
    unit: ClassVar[str]
    features: ClassVar[Mapping[str, str]]
    latency_s: ClassVar[float]
    lowest_rate: ClassVar[float]
    phase: ClassVar[float] = 0.0

    def __init__(self, rate: float) -> None:
        self.rate = rate
        self.samples = 0
        self.found = FeatureSet()
        self._length = max(round(rate), 1)
        self._shift = round(self.phase * self._length)
        self._raw = np.full(self._length, np.nan)
        self._last_level = np.nan

    @property
    def seconds(self) -> float:
        """Length of the signal so far [s]."""
        return self.samples / self.rate

    def push(self, values: Floats) -> list[Event]:
        """Process samples, shape [n], and return the events detected in them, in the order of their detection."""
        events: list[Event] = []
        begin = 0
        while begin < len(values):
            filled = self._place
            piece = np.array(values[begin : begin + self._length - filled], float)
            piece[~(np.abs(piece) <= _LARGEST)] = np.nan
            self._raw[filled : filled + len(piece)] = piece
            events += self._take(piece)
            self.samples += len(piece)
            begin += len(piece)
            if self._place == 0:
                self.found = self._evaluate(self._raw)
        return events

    @property
    def _place(self) -> int:
        """Index of the next sample within its second."""
        return (self.samples + self._shift) % self._length

    def save(self) -> dict[str, Any]:
        """Return the whole state; after `restore` the processing continues from it bit for bit."""
        return copy.deepcopy(self.__dict__)

    def restore(self, saved: dict[str, Any]) -> None:
        """Set the state to one that `save` returned."""
        self.__dict__.update(copy.deepcopy(saved))

    @abstractmethod
    def _take(self, piece: Floats) -> list[Event]:
        """Process samples within one second and return the events; `samples` counts only those before."""

    @abstractmethod
    def _evaluate(self, raw: Floats) -> FeatureSet:
        """Compute the features at the end of a second; `raw` holds its samples as received, shape [rate]."""

    def _contact(self, raw: Floats, *, steps: float = np.inf) -> float:
        """Return the share of valid samples: not missing, clipped or flat; 0 after a jump larger than `steps`."""
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
