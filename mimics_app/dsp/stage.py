"""The signal processing stage: each signal has its channel; once a second what all of them found becomes a frame."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.messages import FeatureFrame, SignalBlock
from mimics_app.dsp.channel import Channel, Event
from mimics_app.dsp.ecg import Ecg
from mimics_app.dsp.emg import Emg
from mimics_app.dsp.gsr import Gsr
from mimics_app.dsp.movement import Power, Speed
from mimics_app.dsp.resp import Resp

__all__ = ["CHANNELS", "NullDsp", "PhysioDsp"]

CHANNELS: dict[str, Callable[[float], Channel]] = {c.name: c for c in (Ecg, Gsr, Emg, Resp, Speed, Power)}
"""What becomes of a signal, by its name; signals of other names are recorded and left alone."""

_SECOND = 1_000_000_000
_SILENT_NS = 3 * _SECOND
"""A signal of which nothing came for so long says nothing any more."""


class NullDsp:
    """Finds no features, whatever arrives."""

    def process(self, signals: Sequence[SignalBlock], now_ns: int) -> FeatureFrame:
        """A frame without features, of this time."""
        return FeatureFrame(now_ns)


class PhysioDsp:
    """Streams, causal, in constant memory.

    Args:
        on_event: Called with the name of a signal and each event found in it.
    """

    def __init__(self, on_event: Callable[[str, Event], None] = lambda name, event: None) -> None:
        self._on_event = on_event
        self._channels: dict[str, Channel] = {}
        self._heard: dict[str, int] = {}
        self._frame = FeatureFrame(0)
        self._second = -1

    @property
    def channels(self) -> dict[str, Channel]:
        """The signals that came so far, by name."""
        return self._channels

    def process(self, signals: Sequence[SignalBlock], now_ns: int) -> FeatureFrame:
        """Take blocks; the newest frame, a new one each second of the session.

        Raises:
            DeviceError: A signal comes too slowly to be read, or changes its rate.
        """
        for block in signals:
            self._take(block, now_ns)
        if now_ns // _SECOND != self._second:
            self._second = now_ns // _SECOND
            self._frame = self._gather(now_ns)
        return self._frame

    def save(self) -> dict[str, Any]:
        """All that is remembered."""
        rest = {"heard": dict(self._heard), "frame": self._frame, "second": self._second}
        channels = {name: (channel.rate, channel.save()) for name, channel in self._channels.items()}
        return copy.deepcopy({"channels": channels, **rest})

    def restore(self, saved: dict[str, Any]) -> None:
        """Go back to what `save` gave; what follows is the same, bit for bit."""
        self._channels = {}
        for name, (rate, state) in saved["channels"].items():
            self._channels[name] = CHANNELS[name](rate)
            self._channels[name].restore(state)
        self._heard, self._frame, self._second = dict(saved["heard"]), saved["frame"], saved["second"]

    def _take(self, block: SignalBlock, now_ns: int) -> None:
        if block.name not in CHANNELS or not len(block.values):
            return
        channel = self._channels.get(block.name)
        if channel is None:
            channel = self._channels[block.name] = _open(block)
        elif channel.rate != block.rate:
            raise DeviceError(
                f'the signal "{block.name}" came at {channel.rate:g} Hz and now at {block.rate:g} Hz',
                "set the amplifier to one rate",
            )
        self._heard[block.name] = now_ns
        for event in channel.push(block.values):
            self._on_event(block.name, event)

    def _gather(self, now_ns: int) -> FeatureFrame:
        values: dict[str, float] = {}
        quality: dict[str, float] = {}
        for name, channel in self._channels.items():
            silent = now_ns - self._heard[name] > _SILENT_NS
            quality[name] = 0.0 if silent else channel.found.quality
            if quality[name] > 0.0:
                values |= channel.found.features
        return FeatureFrame(now_ns, values | self._of_two(values), quality)

    def _of_two(self, values: dict[str, float]) -> dict[str, float]:
        """What needs two signals: the heart's answer to the breath (RSA, peak to trough) [ms]."""
        ecg, resp = self._channels.get("ecg"), self._channels.get("resp")
        if not isinstance(ecg, Ecg) or not isinstance(resp, Resp) or "breath_rate" not in values:
            return {}
        swings = []
        times, lengths, _ = ecg.rhythm.intervals(ecg.seconds - 60.0)
        for end, _, _, whole in list(resp.breaths)[-8:]:
            inside = lengths[(times > end - whole) & (times <= end)]
            if len(inside) >= 3:
                swings.append(float(np.ptp(inside)))
        return {"rsa": 1e3 * float(np.mean(swings))} if len(swings) >= 3 else {}


def _open(block: SignalBlock) -> Channel:
    lowest = getattr(CHANNELS[block.name], "lowest_rate", 0.0)
    if not lowest <= block.rate <= 20_000.0:
        raise DeviceError(
            f'the signal "{block.name}" comes at {block.rate:g} Hz, too slow or too fast to be read',
            f"between {lowest:g} and 20000 Hz",
        )
    return CHANNELS[block.name](block.rate)
