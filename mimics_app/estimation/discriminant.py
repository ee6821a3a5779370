"""The state, its load by a discriminant: from body signals all the time, with the success of a trial when it ends."""

from __future__ import annotations

from dataclasses import replace

from mimics_app.contracts.messages import FeatureFrame, TrialResult, UserState
from mimics_app.estimation.fusion import FusionEstimation
from mimics_app.estimation.load import Lda
from mimics_app.estimation.trial_view import TrialView

__all__ = ["DiscriminantEstimation"]


class DiscriminantEstimation:
    """Arousal, valence and effort as the Kalman fusion estimates them; the load from a discriminant trained on many.

    Args:
        fusion: Calibrates, explains the heart by work, and says when nothing is known.
        lda: Fixed, or following the person. In a session nobody is asked: it learns by how likely each class is.
    """

    def __init__(self, fusion: FusionEstimation, lda: Lda) -> None:
        self._fusion, self._lda = fusion, lda
        self._view = TrialView()
        self._state = UserState(-1)
        self._seen_ns = -1

    def update(self, features: FeatureFrame) -> UserState:
        """The state as of these features; the same for the same frame, but for a trial that ended since."""
        if features.t_ns != self._seen_ns:
            self._seen_ns = features.t_ns
            self._state = self._fusion.update(features)
            if self._state.load is not None:
                self._view.see(self._fusion.seen)
                self._state = replace(self._state, load=self._load(None))
        return self._state

    def judge(self, result: TrialResult) -> UserState:
        """The state with the success of a trial; steps and practice say nothing."""
        if self._state.load is None or result.practice or result.outcome == "step":
            return self._state
        self._state = replace(self._state, t_ns=result.t_ns, load=self._load(result.performance))
        self._lda.learn(self._view.features(result.performance), None)
        return self._state

    def _load(self, success: float | None) -> tuple[float, float, float]:
        low, right, high = self._lda.probabilities(self._view.features(success)).tolist()
        return low, right, high
