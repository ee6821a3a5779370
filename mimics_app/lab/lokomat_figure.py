"""Figures of the gait orthosis: the wall of D2.1 Figure 55, and transparency against the stiffness of objects."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.contracts.system.machine import describe_machine
from mimics_app.lab.figure import Figure, write_figure
from mimics_app.lab.haptic.leg_runs import SPEEDS, foot_on_wall, residual_torque
from mimics_app.lab.haptic.lokomat_rig import COMBINED, CONTROLS, IMPEDANCE, Rig
from mimics_app.lab.panel import Panel
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.drawing import document, legend
from mimics_app.rendering.haptic.control.lokomat.position_control import foot_stiffness

__all__ = ["transparency_figure", "wall_figure", "write_figures"]

_COMMAND = "mimics bench lokomat --charts docs/charts"
_SIZE = (1080.0, 640.0)
_PANEL = (1060.0, 250.0)
_THINNED = 4
"""Ticks from one point of a line to the next."""

_WALL_STIFFNESS = (1000.0, 2000.0, 4000.0, 8000.0, 20_000.0, 40_000.0)  # [N/m]
_BANDWIDTHS = (20.0, 40.0, 60.0, 80.0)  # [rad/s]
_HIP_LEG, _KNEE_LEG = 480.0, 132.0
"""Mass of leg and orthosis as the hip and the knee shaft move it, in the middle of the swing [kg]."""

_MASS_RATIOS = (0.5, 0.7, 1.0, 1.4, 2.0)
"""Virtual masses tried, as shares of these."""

_POSE = np.array([0.35, 0.55])
"""Pose on the wall [rad]."""

_NOTICED = 25.0
"""Residual torque of the knee from which a control counts as unstable [N m]: it shakes, or runs to its limits."""


def wall_figure() -> Figure:
    """Return the figure of a foot that presses on a wall under the combined control: x_real, x_des, and F_x."""
    rows, stiffness, _ = foot_on_wall(COMBINED)
    t = rows["t"][::_THINNED]
    x = Axis("time [s]", 0.0, 3.0)
    place = Panel(6.0, 70.0, *_PANEL, x, Axis("foot behind the wall [mm]", -60.0, 40.0))
    force = Panel(6.0, 340.0, *_PANEL, x, Axis("force of the wall on the foot [N]", -120.0, 10.0))
    for name, kind in (("x_real", "line s0"), ("x_des", "line dashed s1")):
        place.line(list(zip(t.tolist(), (1e3 * rows[name][::_THINNED]).tolist(), strict=True)), kind, name)
    force.line(list(zip(t.tolist(), rows["f_x"][::_THINNED].tolist(), strict=True)), "line s2", "F_x")
    entries = [("line", "line s0", "x_real"), ("line", "line dashed s1", "x_des"), ("line", "line s2", "F_x")]
    machine, title = str(describe_machine()), "Foot against a vertical wall at 0 m (D2.1 Figure 55)"
    parts = [legend(20.0, 52.0, entries), place.svg(), force.svg()]
    svg = str(document(*_SIZE, title, parts, [f"{_COMMAND}   on   {machine}"]))
    end = float(rows["x_real"][-500:].mean())
    table = [{"method": "combined", "x": stiffness, "cost_ns": None, "error": end, "valid": True}]
    more = {"what": f"{title}: penetration at rest; x is the stiffness K_x [N/m]", "unit": "m"}
    return Figure("figure", "lokomat_wall", _COMMAND, machine, table, svg, more=more)


def _residual(rig: Rig, kind: int) -> tuple[float, float]:
    """Return the largest residual torques of hip and knee over the three speeds [N m]."""
    torques = np.array([residual_torque(rig, kind, hz) for hz in SPEEDS.values()])
    return float(torques[:, 0].max()), float(torques[:, 1].max())


def _combined(rig: Rig) -> list[dict[str, Any]]:
    """Return the rows of the combined control: for each bandwidth the most transparent virtual mass."""
    rows = []
    for bandwidth in _BANDWIDTHS:
        rig.settings["position"]["bandwidth"] = bandwidth
        found = []
        for ratio in _MASS_RATIOS:
            rig.settings["shafts"]["mass"] = ratio * _HIP_LEG, ratio * _KNEE_LEG
            found.append(_residual(rig, COMBINED))
        hip, knee = min(found)
        stiffness = foot_stiffness(rig.settings["position"][0], rig.settings["frame"][0], _POSE, -1.0, 0.0)
        rows.append(_row("combined", stiffness, hip, knee))
    return rows


def _row(method: str, stiffness: float, hip: float, knee: float) -> dict[str, Any]:
    torques = {"hip_nm": hip, "knee_nm": knee}
    return {"method": method, "x": stiffness, "cost_ns": None, "error": hip, "valid": knee < _NOTICED} | torques


def transparency_figure() -> Figure:
    """Return the figure of residual torque in free swing against the stiffness of an object, both controls."""
    pure = _residual(Rig(), IMPEDANCE)
    rows = [_row("impedance", stiffness, *pure) for stiffness in _WALL_STIFFNESS] + _combined(Rig())
    x = Axis("stiffness of the object at the foot [N/m]", 500.0, 60_000.0, log=True)
    panel = Panel(6.0, 70.0, 1060.0, 520.0, x, Axis("residual torque in free swing [N m]", 0.3, 300.0, log=True))
    entries = []
    for k, name in enumerate(CONTROLS):
        for joint, kind in (("hip", f"line s{k}"), ("knee", f"line dashed s{k}")):
            points = [(row["x"], row[f"{joint}_nm"]) for row in rows if row["method"] == name]
            panel.line(points, kind, f"{name}, {joint}")
            entries.append(("line", kind, f"{name}, {joint}"))
    machine, title = str(describe_machine()), "Transparency against the stiffness of objects"
    parts = [legend(20.0, 52.0, entries), panel.svg()]
    svg = str(document(*_SIZE, title, parts, [f"{_COMMAND}   on   {machine}"]))
    more = {"what": f"{title}: largest RMS of three speeds; x is the stiffness [N/m]", "unit": "N m"}
    return Figure("figure", "lokomat_transparency", _COMMAND, machine, rows, svg, more=more)


def write_figures(folder: Path) -> list[str]:
    """Write both figures to a folder; return the names of the files."""
    return [str(file) for figure in (wall_figure(), transparency_figure()) for file in write_figure(figure, folder)]
