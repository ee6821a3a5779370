"""The signal processing stage of a scene that measures no body signals."""

from __future__ import annotations

from collections.abc import Sequence

from mimics_app.contracts.messages import FeatureFrame, SignalBlock

__all__ = ["NullDsp"]


class NullDsp:
    """Finds no features, whatever arrives."""

    def process(self, signals: Sequence[SignalBlock], now_ns: int) -> FeatureFrame:
        """A frame without features, of this time."""
        return FeatureFrame(now_ns)
