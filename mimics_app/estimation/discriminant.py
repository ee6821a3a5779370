"""Estimator whose load comes from a linear discriminant of body signals and of the success of each trial."""

from __future__ import annotations

from dataclasses import replace

from mimics_app.contracts.messages.stage_messages import FeatureFrame, TrialResult, UserState
from mimics_app.estimation.fusion import FusionEstimation
from mimics_app.estimation.load import Lda, train_load
from mimics_app.estimation.load_people import shipped_people
from mimics_app.estimation.trial_view import TrialView

__all__ = ["DiscriminantEstimation", "train_discriminant"]


class DiscriminantEstimation:
    """Arousal, valence and effort by the Kalman fusion, load by a discriminant trained on many people.

    Args:
        fusion: Fusion, which also provides the features relative to rest and decides when the state is unknown.
        lda: Fixed or adaptive discriminant. It adapts without labels, weighted by the probability of each class.
    """

    def __init__(self, fusion: FusionEstimation, lda: Lda) -> None:
        self._fusion, self._lda = fusion, lda
        self._view = TrialView()
        self._state = UserState(-1)
        self._seen_ns = -1

    def update(self, features: FeatureFrame) -> UserState:
        """Return the state after a frame of features; for the same frame the same, updated by trials that ended."""
        if features.t_ns != self._seen_ns:
            self._seen_ns = features.t_ns
            self._state = self._fusion.update(features)
            if self._state.load is not None:
                self._view.see(self._fusion.seen)
                self._state = replace(self._state, load=self._load(None))
        return self._state

    def update_from_result(self, result: TrialResult) -> UserState:
        """Return the state updated by the success of a trial; steps and practice do not count."""
        if self._state.load is None or result.practice or result.outcome == "step":
            return self._state
        self._state = replace(self._state, t_ns=result.t_ns, load=self._load(result.performance))
        self._lda.learn(self._view.features(result.performance), None)
        return self._state

    def recalibrate(self) -> None:
        """Measure the baseline anew; until then the state is unknown."""
        self._fusion.recalibrate()

    def _load(self, success: float | None) -> tuple[float, float, float]:
        low, right, high = self._lda.probabilities(self._view.features(success)).tolist()
        return low, right, high


def train_discriminant(baseline_s: float, kind: type[Lda]) -> DiscriminantEstimation:
    """Return an estimator trained on the people shipped with the product.

    Args:
        baseline_s: Length of the calibration [s].
        kind: Fixed or adaptive discriminant.

    Raises:
        SceneError: The people are missing from the installation.
    """
    people = shipped_people()
    return DiscriminantEstimation(FusionEstimation(baseline_s), kind(train_load(people.features, people.classes)))
