"""The signal processing stage: one channel per signal, one frame of features per second."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.messages.feature_names import BREATH_RATE, RSA
from mimics_app.contracts.messages.stage_messages import FeatureFrame, SignalBlock
from mimics_app.dsp.channel import Channel, Event
from mimics_app.dsp.channel_kinds import channel_kind, check_rate

if TYPE_CHECKING:
    from mimics_app.dsp.channels.ecg import Ecg
    from mimics_app.dsp.channels.resp import Resp

__all__ = ["PhysioDsp"]


_WINDOW_S = 60.0
"""Window of the intervals [s]."""
_BREATHS, _LEAST_BREATHS, _LEAST_BEATS = 8, 3, 3
"""Newest breaths that are averaged, fewest of them, and fewest beats within one."""


def cross_signal_features(channels: Mapping[str, Channel], values: Mapping[str, float]) -> dict[str, float]:
    """Return features of two signals: respiratory sinus arrhythmia (RSA, peak to trough) [ms].

    Args:
        channels: Channels of the signals received so far, by name.
        values: Features of single signals.
    """
    if not {"ecg", "resp"} <= set(channels) or BREATH_RATE not in values:
        return {}
    ecg, resp = cast("Ecg", channels["ecg"]), cast("Resp", channels["resp"])
    swings = []
    times, lengths, _ = ecg.rhythm.intervals(ecg.seconds - _WINDOW_S)
    for end, _, _, whole in list(resp.breaths)[-_BREATHS:]:
        inside = lengths[(times > end - whole) & (times <= end)]
        if len(inside) >= _LEAST_BEATS:
            swings.append(float(np.ptp(inside)))
    return {RSA: 1e3 * float(np.mean(swings))} if len(swings) >= _LEAST_BREATHS else {}


_SECOND = 1_000_000_000
_SILENT_NS = 3 * _SECOND
"""Time without samples after which the quality of a signal is 0 [ns]."""


class PhysioDsp:
    """Causal streaming processing in constant memory.

    Args:
        on_event: Called with the name of a signal and each event detected in it.

    Attributes:
        on_event: The same; another may take its place.
        channels: The channels of the signals received so far, by name.
    """

    def __init__(self, on_event: Callable[[str, Event], None] = lambda name, event: None) -> None:
        self.on_event = on_event
        self.channels: dict[str, Channel] = {}
        self._only_recorded: set[str] = set()
        self._received_ns: dict[str, int] = {}
        self._frame = FeatureFrame(0)
        self._second = -1

    def process(self, signals: Sequence[SignalBlock], now_ns: int) -> FeatureFrame:
        """Process blocks and return the newest frame; there is a new one each second of the session.

        Raises:
            DeviceError: The rate of a signal is out of range, or has changed.
        """
        for block in signals:
            self._take(block, now_ns)
        if now_ns // _SECOND != self._second:
            self._second = now_ns // _SECOND
            self._frame = self._gather(now_ns)
        return self._frame

    def save(self) -> dict[str, Any]:
        """Return the whole state."""
        rest = {"received": dict(self._received_ns), "frame": self._frame, "second": self._second}
        channels = {name: (channel.rate, channel.save()) for name, channel in self.channels.items()}
        return copy.deepcopy({"channels": channels, **rest})

    def restore(self, saved: dict[str, Any]) -> None:
        """Set the state to one that `save` returned; the processing continues from it bit for bit."""
        self.channels = {}
        for name, (rate, state) in saved["channels"].items():
            channel = _open(name, rate)
            assert channel is not None  # it was processed when it was saved
            channel.restore(state)
            self.channels[name] = channel
        self._received_ns, self._frame, self._second = dict(saved["received"]), saved["frame"], saved["second"]

    def _take(self, block: SignalBlock, now_ns: int) -> None:
        if block.name in self._only_recorded or not len(block.values):
            return
        channel = self.channels.get(block.name) or _open(block.name, block.rate)
        if channel is None:
            self._only_recorded.add(block.name)
            return
        self.channels[block.name] = channel
        if channel.rate != block.rate:
            raise DeviceError(
                f'the rate of the signal "{block.name}" changed from {channel.rate:g} Hz to {block.rate:g} Hz',
                "set the amplifier to one rate",
            )
        self._received_ns[block.name] = now_ns
        for event in channel.push(block.values):
            self.on_event(block.name, event)

    def _gather(self, now_ns: int) -> FeatureFrame:
        values: dict[str, float] = {}
        quality: dict[str, float] = {}
        for name, channel in self.channels.items():
            silent = now_ns - self._received_ns[name] > _SILENT_NS
            quality[name] = 0.0 if silent else channel.found.quality
            if quality[name] > 0.0:
                values |= channel.found.features
        return FeatureFrame(now_ns, values | cross_signal_features(self.channels, values), quality)


def _open(name: str, rate: float) -> Channel | None:
    """Return the channel of a signal, None for one that is only recorded."""
    check_rate(name, rate)
    kind = channel_kind(name)
    return None if kind is None else kind(rate)
