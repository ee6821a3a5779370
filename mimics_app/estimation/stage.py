"""The estimation stage of a scene that knows nothing of the person's state."""

from __future__ import annotations

from mimics_app.contracts.messages import FeatureFrame, TrialResult, UserState

__all__ = ["NullEstimation"]


class NullEstimation:
    """Claims nothing: every state stays None."""

    def update(self, features: FeatureFrame) -> UserState:
        """An unknown state, of the features' time."""
        return UserState(features.t_ns)

    def judge(self, result: TrialResult) -> UserState:
        """Still unknown, of the result's time."""
        return UserState(result.t_ns)
