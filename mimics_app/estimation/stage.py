"""The estimation stage of a scene without body signals."""

from __future__ import annotations

from mimics_app.contracts.messages import FeatureFrame, TrialResult, UserState

__all__ = ["NullEstimation"]


class NullEstimation:
    """Estimator whose state is always unknown."""

    def update(self, features: FeatureFrame) -> UserState:
        """Return an unknown state at the time of the features."""
        return UserState(features.t_ns)

    def judge(self, result: TrialResult) -> UserState:
        """Return an unknown state at the time of the result."""
        return UserState(result.t_ns)
