"""A person who presses on a surface, on a simulated robot, and how much the force shakes the hand."""

from __future__ import annotations

from typing import Any

import numpy as np

from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.scene_block import impedance_values
from mimics_app.world.components.robot import Impedance, Patient, Robot
from tests.support.haptic_bench import Bench
from tests.support.object_bench import bench_with, shape_below

BAND = (20.0, 300.0)
"""Frequencies at which a hand feels a force shake, and no person moves [Hz]."""

QUIET = 0.5
"""Root mean square of a force in that band over 100 ms that is quiet [N]."""

RATE = 1000
_WINDOW_S = 0.1
_PRESSED = 0.04
"""Distance behind the surface that the person aims at [m]."""


def press(
    device: str, stiffness: float, damping: float, *, seconds: float = 4.0,
    robot: dict[str, Any] | None = None, viscosity: float = 1.0, kind: ShapeKind = ShapeKind.WALL, **values: Any,
) -> tuple[np.ndarray, Bench]:  # fmt: skip
    """Samples of a stiff arm that is put on a fixed surface 20 mm below and pressed down, to and fro every second.

    Args:
        device: `simulated_impedance` or `simulated_hapticmaster`.
        stiffness: Of the surface [N/m].
        damping: Of the surface [N s/m].
        seconds: Length.
        robot: Fields of the robot component.
        viscosity: Damping rendered with every force of an impedance device [N s/m].
        kind: Shape whose upper side is the surface.
        values: Fields of SCENE; those of the surface by `surface__NAME`.
    """
    surface = {name[9:]: values.pop(name) for name in list(values) if name.startswith("surface__")}
    patient = Patient(arm_stiffness=800.0, tremor=0.0, aim_error=0.0)
    play = shape_below(kind, -0.02, stiffness=stiffness, damping=damping, **surface)
    plugin = build_device(Robot(device=device, **(robot or {})), patient, seed=3)
    bench = bench_with(play, plugin)
    if device == "simulated_impedance":
        bench.publish(**impedance_values(bench.scene, Impedance(damping=viscosity, device_damping=0.5)))
    limits = {"passivity": 1, "force_rate_limit": 2000.0, "force_limit": 60.0}
    bench.publish(**{**limits, **values})
    rows = [bench.advance(RATE)]  # the soft start
    for half in range(round(2 * seconds)):
        down = half % 4 != 3
        bench.send(target_world=(0.0, -0.02 - (_PRESSED if down else -0.02), 0.0), active=1)
        rows.append(bench.advance(RATE // 2))
    return np.concatenate(rows), bench


def shaking(rows: Any) -> np.ndarray:
    """Root mean square over the last 100 ms of the force on the user in BAND [N], by tick, ordered forces subtracted.

    0 within 100 ms, and the length of the window, after a contact begins or ends.
    """
    from scipy.signal import butter, sosfilt

    band = butter(2, [BAND[0], BAND[1]], "band", fs=RATE, output="sos")
    force = sosfilt(band, rows["f_user_world"] - rows["f_ordered"], axis=0)
    window = round(_WINDOW_S * RATE)
    square = np.cumsum(np.concatenate([np.zeros(window), (force**2).sum(axis=1)]))
    rms = np.sqrt(np.maximum(0.0, square[window:] - square[:-window]) / window)
    touching = (rows["touching"] > 0.0) | (rows["penetration"] > 0.0)
    changes = np.flatnonzero(np.diff(touching.astype(int))) + 1
    for tick in changes[np.diff(changes, prepend=-RATE) > window]:  # chatter is no begin of a contact
        rms[tick : tick + 2 * window] = 0.0
    return rms
