"""Units of the features of body signals and movement."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["FEATURE_UNITS"]

FEATURE_UNITS: Mapping[str, str] = {
    "heart_rate": "1/min",
    "rmssd": "ms",
    "sdnn": "ms",
    "pnn50": "%",
    "hrv_window_s": "s",
    "lf": "ms²",
    "hf": "ms²",
    "lf_hf": "1",
    "rsa": "ms",
    "scl": "µS",
    "phasic": "µS",
    "scr_rate": "1/min",
    "scr_sum": "µS/min",
    "scl_slope": "µS/min",
    "emg": "mV",
    "emg_integrated": "mV·s",
    "emg_active": "1",
    "emg_median_hz": "Hz",
    "emg_fatigue": "Hz/min",
    "breath_rate": "1/min",
    "breath_depth": "1",
    "breath_ratio": "1",
    "breath_variability": "1",
    "hand_speed": "m/s",
    "hand_peaks_per_s": "1/s",
    "hand_evenness": "1",
    "hand_power": "W",
    "head_speed": "rad/s",
    "head_peaks_per_s": "1/s",
    "head_evenness": "1",
}
"""Unit of each feature by its name; "1": a ratio, a flag, or the unit of a signal without one, as breath's."""
