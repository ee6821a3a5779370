"""Load by a linear discriminant whose class means follow the person."""

from __future__ import annotations

from mimics_app.estimation.discriminant import DiscriminantEstimation, train_discriminant
from mimics_app.estimation.load import AdaptiveLda

__all__ = ["build"]


def build(baseline_s: float) -> DiscriminantEstimation:
    """Return the estimator with a calibration of this length [s]."""
    return train_discriminant(baseline_s, AdaptiveLda)
