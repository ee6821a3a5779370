"""The signal processing stage: one channel per signal, one frame of features per second."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.messages.stage_messages import FeatureFrame, SignalBlock
from mimics_app.dsp.channel import Channel, Event
from mimics_app.dsp.ecg import Ecg
from mimics_app.dsp.emg import Emg
from mimics_app.dsp.gsr import Gsr
from mimics_app.dsp.movement import Head, Power, Speed
from mimics_app.dsp.resp import Resp

__all__ = ["CHANNELS", "PhysioDsp", "check_rate"]

CHANNELS: dict[str, Callable[[float], Channel]] = {c.name: c for c in (Ecg, Gsr, Emg, Resp, Speed, Power, Head)}
"""Processing of each signal by its name; signals of other names are recorded and not processed."""

_SECOND = 1_000_000_000
_SILENT_NS = 3 * _SECOND
"""Time without samples after which the quality of a signal is 0 [ns]."""


class PhysioDsp:
    """Causal streaming processing in constant memory.

    Args:
        on_event: Called with the name of a signal and each event detected in it.

    Attributes:
        channels: The channels of the signals received so far, by name.
    """

    def __init__(self, on_event: Callable[[str, Event], None] = lambda name, event: None) -> None:
        self._on_event = on_event
        self.channels: dict[str, Channel] = {}
        self._heard: dict[str, int] = {}
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
        rest = {"heard": dict(self._heard), "frame": self._frame, "second": self._second}
        channels = {name: (channel.rate, channel.save()) for name, channel in self.channels.items()}
        return copy.deepcopy({"channels": channels, **rest})

    def restore(self, saved: dict[str, Any]) -> None:
        """Set the state to one that `save` returned; the processing continues from it bit for bit."""
        self.channels = {}
        for name, (rate, state) in saved["channels"].items():
            self.channels[name] = CHANNELS[name](rate)
            self.channels[name].restore(state)
        self._heard, self._frame, self._second = dict(saved["heard"]), saved["frame"], saved["second"]

    def _take(self, block: SignalBlock, now_ns: int) -> None:
        if block.name not in CHANNELS or not len(block.values):
            return
        channel = self.channels.get(block.name)
        if channel is None:
            channel = self.channels[block.name] = _open(block)
        elif channel.rate != block.rate:
            raise DeviceError(
                f'the rate of the signal "{block.name}" changed from {channel.rate:g} Hz to {block.rate:g} Hz',
                "set the amplifier to one rate",
            )
        self._heard[block.name] = now_ns
        for event in channel.push(block.values):
            self._on_event(block.name, event)

    def _gather(self, now_ns: int) -> FeatureFrame:
        values: dict[str, float] = {}
        quality: dict[str, float] = {}
        for name, channel in self.channels.items():
            silent = now_ns - self._heard[name] > _SILENT_NS
            quality[name] = 0.0 if silent else channel.found.quality
            if quality[name] > 0.0:
                values |= channel.found.features
        return FeatureFrame(now_ns, values | self._of_two(values), quality)

    def _of_two(self, values: dict[str, float]) -> dict[str, float]:
        """Return features of two signals: respiratory sinus arrhythmia (RSA, peak to trough) [ms]."""
        ecg, resp = self.channels.get("ecg"), self.channels.get("resp")
        if not isinstance(ecg, Ecg) or not isinstance(resp, Resp) or "breath_rate" not in values:
            return {}
        swings = []
        times, lengths, _ = ecg.rhythm.intervals(ecg.seconds - 60.0)
        for end, _, _, whole in list(resp.breaths)[-8:]:
            inside = lengths[(times > end - whole) & (times <= end)]
            if len(inside) >= 3:
                swings.append(float(np.ptp(inside)))
        return {"rsa": 1e3 * float(np.mean(swings))} if len(swings) >= 3 else {}


def check_rate(name: str, rate: float) -> None:
    """Check that a signal can be processed at a rate [Hz]; one that is only recorded has any.

    Raises:
        DeviceError: It cannot.
    """
    lowest = getattr(CHANNELS[name], "lowest_rate", 0.0) if name in CHANNELS else 0.0
    if not lowest <= rate <= 20_000.0:
        raise DeviceError(
            f'the rate of the signal "{name}" is {rate:g} Hz, which cannot be processed',
            f"set a rate from {lowest:g} to 20000 Hz",
        )


def _open(block: SignalBlock) -> Channel:
    check_rate(block.name, block.rate)
    return CHANNELS[block.name](block.rate)
