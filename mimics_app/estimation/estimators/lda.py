"""Load by a linear discriminant that treats differences between people as noise."""

from __future__ import annotations

from mimics_app.estimation.discriminant import DiscriminantEstimation, train_discriminant
from mimics_app.estimation.load import Lda

__all__ = ["build"]


def build(baseline_s: float) -> DiscriminantEstimation:
    """Return the estimator with a calibration of this length [s]."""
    return train_discriminant(baseline_s, Lda)
