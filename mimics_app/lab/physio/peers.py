"""Detectors of others that are installed beside the product, for charts: NeuroKit2's, whole-array, not causal."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

__all__ = ["neurokit_detectors"]

Floats = NDArray[np.float64]

_METHODS = ("neurokit", "pantompkins1985", "hamilton2002", "elgendi2010", "engzeemod2012")


def neurokit_detectors() -> dict[str, Callable[[Floats, float], Floats]]:
    """Times of the R peaks [s] from an ECG [mV] at a rate [Hz], by method; none where NeuroKit2 is not installed."""
    try:
        import neurokit2
    except ImportError:
        return {}

    def detector(method: str) -> Callable[[Floats, float], Floats]:
        def find(values: Floats, rate: float) -> Floats:
            whole = round(rate)
            cleaned = neurokit2.ecg_clean(values, sampling_rate=whole, method=method)
            _, found = neurokit2.ecg_peaks(cleaned, sampling_rate=whole, method=method)
            return np.asarray(found["ECG_R_Peaks"], float) / rate

        return find

    return {f"NeuroKit2 {method}": detector(method) for method in _METHODS}
