"""Features of two signals together."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, cast

import numpy as np

from mimics_app.contracts.messages.feature_names import BREATH_RATE, RSA
from mimics_app.dsp.channel import Channel

if TYPE_CHECKING:
    from mimics_app.dsp.channels.ecg import Ecg
    from mimics_app.dsp.channels.resp import Resp

__all__ = ["cross_signal_features"]

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
