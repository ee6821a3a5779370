"""Figure of the reference gait: hip and knee at three speeds, beside the published tables that judge it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.system.machine import describe_machine
from mimics_app.lab.figure import Figure
from mimics_app.lab.panel import Panel
from mimics_app.lab.published_gait import HIP, KNEE, SPEED, TILT
from mimics_app.maths.gait_series import knee_series, leg_length, series_at, step_of, thigh_series
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.drawing import document, legend
from mimics_app.world.content.motion.reference_gait import NATURAL, SAMPLES, knee_by_speed
from mimics_app.world.content.motion.reference_gait import TILT as BOVI_TILT

__all__ = ["gait_figure", "knee_of", "most_aligned", "rms", "thigh_of"]

_COMMAND = "mimics lab gait"
_HEIGHT = 1.75
_GRAVITY = 9.81
_PHASE = np.arange(SAMPLES) / SAMPLES
_MOST_SHIFT = 0.045
"""Largest difference of the begins of two authors' cycles that is tried [cycles]."""
_SIZE = (1080.0, 880.0)
_PANEL = (1060.0, 370.0)
_FREE = "free"


def thigh_of(speed: float, phase: F8 = _PHASE) -> F8:
    """Return the thigh of the reference at a natural step, [degrees], for a speed [m/s] and a height of 1.75 m."""
    step = step_of(speed, _HEIGHT)
    return np.degrees(series_at(np.array([1.0, step, step * step]) @ thigh_series(_HEIGHT), phase))


def knee_of(speed: float, phase: F8 = _PHASE) -> F8:
    """Return the knee of the reference [degrees] at a speed [m/s] and a height of 1.75 m."""
    coefficients, least = knee_series(_HEIGHT)
    u = math.hypot(speed, least)
    return np.degrees(series_at(np.array([1.0, u, u * u]) @ coefficients, phase))


def rms(difference: F8) -> float:
    """Return the root mean square."""
    return float(np.sqrt((difference**2).mean()))


def most_aligned(speed: float) -> tuple[float, float]:
    """Return the smallest difference of the knee from Koopman's, [degrees], and the shift of the cycle for it."""
    other = knee_by_speed(speed)
    shifts = np.arange(0.0, _MOST_SHIFT + 1e-9, 0.005)
    found = [(rms(knee_of(speed, _PHASE - shift) - other), float(shift)) for shift in shifts]
    return min(found)


def _speed_of(group: str) -> float:
    """Return the speed of a group of the table for an adult of 1.75 m [m/s]."""
    return SPEED[group] * math.sqrt(_GRAVITY * leg_length(_HEIGHT))


def _rows() -> list[dict[str, Any]]:
    """Return the differences by author, joint and speed; x is the speed [km/h]."""
    rows = []
    for group in SPEED:
        speed = _speed_of(group)
        hip = np.array(HIP[group]) - np.array(TILT[group])
        rows += [
            _row("thigh, Schwartz 2008", speed, rms(thigh_of(speed) - hip)),
            _row("knee, Schwartz 2008", speed, rms(knee_of(speed) - np.array(KNEE[group]))),
        ]
    for speed in (0.5 / 3.6, *(_speed_of(group) for group in SPEED)):
        rows.append(_row("knee, Koopman 2014", speed, rms(knee_of(speed) - knee_by_speed(speed))))
        rows.append(_row("knee, Koopman 2014, cycles aligned", speed, most_aligned(speed)[0]))
    natural = _speed_of(_FREE)
    rows.append(_row("thigh, Bovi 2011", natural, rms(thigh_of(natural) - (np.array(NATURAL["hip"]) - BOVI_TILT))))
    rows.append(_row("knee, Bovi 2011", natural, rms(knee_of(natural) - np.array(NATURAL["knee"]))))
    return rows


def _row(method: str, speed: float, error: float) -> dict[str, Any]:
    return {"method": method, "x": 3.6 * speed, "cost_ns": None, "error": error, "valid": True}


def _points(values: Sequence[float] | F8) -> list[tuple[float, float]]:
    """Return a closed cycle as points of a panel."""
    return [(100.0 * k / SAMPLES, float(values[k % SAMPLES])) for k in range(SAMPLES + 1)]


def gait_figure() -> Figure:
    """Return the figure: lines are the reference, dots the table it is fitted to, dashed lines Koopman's knee."""
    x = Axis("cycle from heel contact [%]", 0.0, 100.0)
    thigh = Panel(6.0, 70.0, *_PANEL, x, Axis("thigh forward [degrees]", -25.0, 35.0))
    knee = Panel(6.0, 450.0, *_PANEL, x, Axis("knee flexion [degrees]", -5.0, 70.0))
    entries = []
    for k, group in enumerate(SPEED):
        speed = _speed_of(group)
        name = f"{3.6 * speed:.1f} km/h"
        thigh.line(_points(thigh_of(speed)), f"line s{k}", name)
        knee.line(_points(knee_of(speed)), f"line s{k}", name)
        knee.line(_points(knee_by_speed(speed)), f"line dashed s{k}", f"Koopman 2014, {name}")
        for panel, table in ((thigh, np.array(HIP[group]) - np.array(TILT[group])), (knee, np.array(KNEE[group]))):
            for at, angle in _points(table):
                panel.dot(at, angle, f"dot s{k}", f"Schwartz 2008, {name}", radius=2.5)
        entries.append(("line", f"line s{k}", name))
    entries.append(("line", "line dashed", "knee of Koopman 2014 (dots: Schwartz 2008)"))
    machine = str(describe_machine())
    parts = [legend(20.0, 52.0, entries), thigh.svg(), knee.svg()]
    title = "Reference gait of a person of 1.75 m"
    svg = str(document(*_SIZE, title, parts, [f"{_COMMAND}   on   {machine}"]))
    what = f"{title}: root mean square difference from published tables; x is the speed [km/h]"
    more = {"what": what, "unit": "degrees"}
    return Figure("figure", "gait", _COMMAND, machine, _rows(), svg, more=more)
