"""Registry of the estimators of the person's state."""

from __future__ import annotations

from collections.abc import Callable

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.ports.stages import Estimation
from mimics_app.estimation.discriminant import DiscriminantEstimation
from mimics_app.estimation.fusion import FusionEstimation
from mimics_app.estimation.load import AdaptiveLda, Lda, train_load
from mimics_app.estimation.load_people import shipped_people

__all__ = ["DEFAULT", "ESTIMATORS", "build_estimation", "check_estimator"]


def _discriminant(kind: type[Lda]) -> Callable[[float], Estimation]:
    def build(baseline_s: float) -> Estimation:
        people = shipped_people()
        return DiscriminantEstimation(FusionEstimation(baseline_s), kind(train_load(people.features, people.classes)))

    return build


ESTIMATORS: dict[str, Callable[[float], Estimation]] = {
    "fusion": FusionEstimation,
    "lda": _discriminant(Lda),
    "adaptive_lda": _discriminant(AdaptiveLda),
}
"""Estimators by name, each called with the length of the calibration [s]. All estimate arousal, valence and effort by
the Kalman fusion and differ in the load."""

DEFAULT = "adaptive_lda"
"""Default estimator: the most accurate on the load of unseen people (chart "load of the person")."""


def check_estimator(name: str) -> None:
    """Check that an estimator exists; "" is the default.

    Raises:
        UsageError: There is none of this name.
    """
    if name and name not in ESTIMATORS:
        raise UsageError(f'there is no estimator "{name}"', nearest(name, ESTIMATORS))


def build_estimation(name: str, baseline_s: float) -> Estimation:
    """Build an estimator by its name, "" for the default.

    Raises:
        UsageError: There is none of this name.
        SceneError: Its training data are missing from the installation.
    """
    check_estimator(name)
    return ESTIMATORS[name or DEFAULT](baseline_s)
