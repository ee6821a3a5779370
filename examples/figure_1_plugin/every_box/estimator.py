"""Estimator: who breathes deeply is calm."""

from __future__ import annotations

from mimics_app.contracts.messages.stage_messages import Estimate, UserState

CALM_MM = 4.0
"""Range of the belt that counts as calm [mm]."""


class ByStretch:
    """Arousal from the depth of the breath."""

    def __init__(self, baseline_s):
        self._state = UserState(-1)

    def update(self, features):
        """Return the state; None where the belt says nothing."""
        depth = features.values.get("stretch_range")
        arousal = None if depth is None else Estimate(max(-1.0, min(1.0, 1.0 - depth / CALM_MM)), 0.1)
        self._state = UserState(features.t_ns, arousal=arousal, quality=features.quality.get("stretch", 0.0))
        return self._state

    def update_from_result(self, result):
        """The result of a trial says nothing of the breath."""
        return self._state

    def recalibrate(self):
        """There is no baseline."""
