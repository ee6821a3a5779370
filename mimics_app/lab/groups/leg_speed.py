"""Speed of a leg's joints that combined control damps by: cost against the rattle of a leg that hangs."""

from __future__ import annotations

import numpy as np

from mimics_app.lab.haptic.lokomat_rig import COMBINED, Person, Rig
from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.rendering.haptic.kernels.leg_kinematics import SHANK, THIGH

__all__: list[str] = []

_CALLS, _LEGS = 2000, 2
_SECONDS, _STILL = 6.0, 4000
"""Length of a run [s], and the tick from which on tissue has drawn the leg to rest."""

_BAND = 20.0, 300.0
"""Of a vibration [Hz]."""


def _rig(step: float, person: str) -> Rig:
    rig = Rig({"person": person})
    rig.settings["encoder"] = step
    return rig


def _cost_us(step: float) -> float:
    """Return the cost of the control of a leg [us] with the window of encoders of a step [rad]; 0: without."""
    rig = _rig(step, "healthy")
    return shortest_us(lambda: rig.control(COMBINED, _CALLS), _LEGS * _CALLS)


def _rattle(step: float) -> float:
    """Return the greatest force at the foot within the band [N] that makes the torque of the hip's rod."""
    rig = _rig(step, "spastic")
    torque = rig.run(COMBINED, Person(preset=True), _SECONDS)["hip"][_STILL:]
    spectrum, hertz = np.fft.rfft(torque - torque.mean()), np.fft.rfftfreq(len(torque), 1.0 / rig.rate)
    spectrum[(hertz < _BAND[0]) | (hertz > _BAND[1])] = 0.0
    reach = float(rig.settings["frame"]["geometry"][0, [THIGH, SHANK]].sum())
    return float(np.abs(np.fft.irfft(spectrum, len(torque))).max()) / reach


compare(
    __name__,
    "a leg hangs at rest; error: greatest force at its foot between 20 and 300 Hz",
    "N",
    [
        Rival(
            "window",
            "slope of the last 16 readings that lie within a step of a line (Janabi-Sharifi, Hayward and Chen, 2000)",
            "encoders whose step is known",
            {"encoder": 2e-5},
            (2e-5,),
        ),
        Rival(
            "filter",
            "the device's own: difference of two readings through a low pass of 60 Hz",
            "encoders of steps too fine to matter, tachometers",
            {"encoder": 0.0},
            (0.0,),
        ),
    ],
    Probes(_cost_us, _rattle, reference_us),
    default="window",
    few="a longer window delays damping until the leg swings on its drives",
)
