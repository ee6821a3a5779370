"""Residual torque of a gait orthosis: what its rods exert on legs that swing freely, beyond its own weight.

D2.1 4.3.1 calls a control transparent by its zero impedance mode: weight and friction of the orthosis are compensated,
nothing is rendered, and what a person still feels is this torque.
"""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.loop.loop_fields import contacts_in, point_rows
from mimics_app.recording.run import Run

__all__ = ["residual_torques"]

_LEGS = ("left", "right")
_JOINTS = ("hip", "knee")


def residual_torques(run: Run) -> dict[str, tuple[float, float]]:
    """Return the root mean square of the residual torque of both hips and both knees [N m], left and right.

    Args:
        run: A run; its samples are read only where a controller of the orthosis recorded them.

    Returns:
        By joint; {} for a device without legs, for a run that never was ACTIVE, and for one in which a guidance, a
        hard or a soft object acted on a leg.
    """
    columns = {name: i for i, (name, _) in enumerate(run.layout.extent.numbers)}
    if f"{_LEGS[0]}_{_JOINTS[0]}_residual" not in columns:
        return {}
    samples = run.haptic
    active = samples[samples["state"] == SafetyState.ACTIVE]
    numbers = active["numbers"]
    loads = [columns[f"{leg}_{name}"] for leg in _LEGS for name in ("f_x", "guidance")]
    touched = any(point_rows(active, point)["f_user_world"].any() for point in range(contacts_in(active)))
    if len(active) == 0 or touched or numbers[:, loads].any():
        return {}
    rms = {
        (leg, joint): float(np.sqrt(np.mean(numbers[:, columns[f"{leg}_{joint}_residual"]] ** 2)))
        for leg in _LEGS
        for joint in _JOINTS
    }
    return {joint: (rms["left", joint], rms["right", joint]) for joint in _JOINTS}
