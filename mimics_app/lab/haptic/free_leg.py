"""Drifts of the models of a leg: energy of two free links, and distance from the object of a foot that slides on it."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec
from mimics_app.lab.haptic.lokomat_rig import Rig
from mimics_app.rendering.haptic.control.lokomat.constrained_shafts import (
    SHAFTS,
    SURFACE_SETTINGS,
    place_shafts,
    step_shafts,
)
from mimics_app.rendering.haptic.control.lokomat.foot_constraint import FOOT_SURFACE, find_surface
from mimics_app.rendering.haptic.control.lokomat.sagittal_outline import circle_outline, wall_outline
from mimics_app.rendering.haptic.kernels.leg_kinematics import place_foot
from mimics_app.rendering.haptic.kernels.lokomat.linkage import eta_of
from mimics_app.rendering.haptic.kernels.two_link import centrifugal, energy, mass_matrix, weight

__all__ = ["constraint_drift", "energy_drift"]

_SECONDS = 60.0
_DT = 1e-3
_START = (0.6, 0.9)  # [rad]
_STAGES = 4
_WEIGHTS = 6.0
"""Sum of the weights 1, 2, 2, 1 of the stages of the classical Runge-Kutta method."""
_SLIDE_TICKS = 400
_PRESS = 200.0  # [N]


@kernel
def _rate(links: Vec, state: Vec, out: Vec) -> None:
    """Time derivative of angles and velocities of a leg that hangs freely."""
    m11, m12, m22 = mass_matrix(links, math.cos(state[1]))
    c1, c2 = centrifugal(links, math.sin(state[1]), state[2], state[3])
    g1, g2 = weight(links, state[0], state[1])
    a, b, det = -c1 - g1, -c2 - g2, m11 * m22 - m12 * m12
    out[0], out[1] = state[2], state[3]
    out[2], out[3] = (m22 * a - m12 * b) / det, (m11 * b - m12 * a) / det


@kernel
def _swing(links: Vec, state: Vec, ticks: int, work: Mat) -> float:
    """Let a leg swing; return the largest change of its energy [J]."""
    start = energy(links, state[0], state[1], state[2], state[3])
    largest = 0.0
    now, rate, total = work[0], work[1], work[2]
    for _ in range(ticks):
        now[:] = state
        total[:] = 0.0
        for stage in range(_STAGES):
            _rate(links, now, rate)
            outer = stage == 0 or stage == _STAGES - 1
            total += (1.0 if outer else 2.0) * rate
            now[:] = state + (0.5 * _DT if stage < 2 else _DT) * rate
        state += _DT / _WEIGHTS * total
        largest = max(largest, abs(energy(links, state[0], state[1], state[2], state[3]) - start))
    return largest


def energy_drift(seconds: float = _SECONDS) -> float:
    """Return the largest change of the energy of an unforced leg over a time [s], relative to its energy of swing."""
    links = np.array(Rig().settings["position"]["links"][0])
    state = np.array([*_START, 0.0, 0.0])
    swing = energy(links, *state)
    return float(_swing(links, state, round(seconds / _DT), np.zeros((3, 4))) / swing)


def constraint_drift() -> float:
    """Return the largest distance [m] from the object of a virtual leg that is pressed on it and slides."""
    settings = Rig().settings
    frame, shafts = settings["frame"], settings["shafts"].copy()
    shafts["mass"], shafts["damping"] = (180.0, 120.0), 0.0
    rule = np.zeros(1, SURFACE_SETTINGS)
    place, theta = np.zeros(3), np.array([0.5, 0.8])
    place_foot(frame["geometry"][0], 0, theta, place)
    largest = 0.0
    for outline in (
        wall_outline((place[0] + 1e-4, 0.0), (-1.0, 0.0)),
        circle_outline((place[0] + 0.1001, place[2]), 0.1),
    ):
        leg, surface = np.zeros(1, SHAFTS), np.zeros(1, FOOT_SURFACE)
        eta = np.array([eta_of(frame["links"][0, joint], theta[joint]) for joint in range(2)])
        place_shafts(leg[0], frame[0], eta)
        for _ in range(_SLIDE_TICKS):
            find_surface(frame[0], outline[0], leg["theta"][0], surface[0])
            push = -_PRESS * surface["slope"][0] / np.abs(surface["slope"][0]).max()
            step_shafts(leg[0], frame[0], outline[0], shafts[0], rule[0], True, push, _DT)
            if leg["touching"][0]:
                find_surface(frame[0], outline[0], leg["theta"][0], surface[0])
                largest = max(largest, abs(float(surface["distance"][0])))
    return largest
