"""Arousal by the Kalman fusion; the load is arousal cut in three."""

from __future__ import annotations

from mimics_app.estimation.fusion import FusionEstimation

__all__ = ["build"]


def build(baseline_s: float) -> FusionEstimation:
    """Return the estimator with a calibration of this length [s]."""
    return FusionEstimation(baseline_s)
