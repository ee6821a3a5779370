"""Second order sections (biquads), one sample at a time."""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import kernel

__all__ = ["Floats", "run_sections", "start_steady"]

Floats = np.ndarray[tuple[int, ...], np.dtype[np.float64]]


@kernel
def run_sections(value: float, sos: Floats, z: Floats) -> float:
    """Return one sample filtered by second order sections [s, 6] with state [s, 2]."""
    for s in range(sos.shape[0]):
        y = sos[s, 0] * value + z[s, 0]
        z[s, 0] = sos[s, 1] * value - sos[s, 4] * y + z[s, 1]
        z[s, 1] = sos[s, 2] * value - sos[s, 5] * y
        value = y
    return value


@kernel
def start_steady(value: float, sos: Floats, z: Floats) -> None:
    """Set the state to its steady state for a constant input."""
    for s in range(sos.shape[0]):
        gain = (sos[s, 0] + sos[s, 1] + sos[s, 2]) / (1.0 + sos[s, 4] + sos[s, 5])
        y = gain * value
        z[s, 1] = sos[s, 2] * value - sos[s, 5] * y
        z[s, 0] = sos[s, 1] * value - sos[s, 4] * y + z[s, 1]
        value = y
