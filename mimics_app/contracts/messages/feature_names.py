"""Names of the features of body signals and movement, by which the stages exchange them."""

from __future__ import annotations

__all__ = [
    "BREATH_DEPTH",
    "BREATH_RATE",
    "BREATH_RATIO",
    "BREATH_VARIABILITY",
    "EMG",
    "EMG_ACTIVE",
    "EMG_FATIGUE",
    "EMG_INTEGRATED",
    "EMG_MEDIAN_HZ",
    "HAND_POWER",
    "HEART_RATE",
    "HF",
    "HRV_WINDOW_S",
    "LEG_POWER",
    "LF",
    "LF_HF",
    "PHASIC",
    "PNN50",
    "RMSSD",
    "RSA",
    "SCL",
    "SCL_SLOPE",
    "SCR_RATE",
    "SCR_SUM",
    "SDNN",
]

HEART_RATE = "heart_rate"
RMSSD = "rmssd"
SDNN = "sdnn"
PNN50 = "pnn50"
HRV_WINDOW_S = "hrv_window_s"
LF = "lf"
HF = "hf"
LF_HF = "lf_hf"
RSA = "rsa"
SCL = "scl"
PHASIC = "phasic"
SCR_RATE = "scr_rate"
SCR_SUM = "scr_sum"
SCL_SLOPE = "scl_slope"
EMG = "emg"
EMG_INTEGRATED = "emg_integrated"
EMG_ACTIVE = "emg_active"
EMG_MEDIAN_HZ = "emg_median_hz"
EMG_FATIGUE = "emg_fatigue"
BREATH_RATE = "breath_rate"
BREATH_DEPTH = "breath_depth"
BREATH_RATIO = "breath_ratio"
BREATH_VARIABILITY = "breath_variability"
HAND_POWER = "hand_power"
LEG_POWER = "leg_power"
