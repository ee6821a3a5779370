"""Figure of the reference gait: hip and knee at three speeds, beside the published tables it is compared with."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.system.machine import describe_machine
from mimics_app.lab.figure import Figure
from mimics_app.lab.haptic.gait_differences import gait_differences, knee_of, speed_of, thigh_of
from mimics_app.lab.panel import Panel
from mimics_app.lab.published_gait import HIP, KNEE, SPEED, TILT
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.drawing import document, legend
from mimics_app.world.content.motion.reference_gait import SAMPLES, knee_by_speed

__all__ = ["gait_figure"]

_COMMAND = "mimics lab gait"
_SIZE = (1080.0, 880.0)
_PANEL = (1060.0, 370.0)


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
        speed = speed_of(group)
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
    rows: list[dict[str, Any]] = [
        {"method": each.table, "x": each.kmh, "cost_ns": None, "error": each.degrees, "valid": True}
        for each in gait_differences()
    ]
    return Figure("figure", "gait", _COMMAND, machine, rows, svg, more=more)
