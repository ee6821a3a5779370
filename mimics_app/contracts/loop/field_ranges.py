"""Physical range of every number of the parameter block and of its rows, and which of them may be written in a session.

One table for `mimics check`, for a run, and for every write while it runs: a value outside is refused in all three.
Limits are not in it: nothing writes them (`contracts.loop.haptic.LIMITS`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from mimics_app.contracts.arrays import Records

__all__ = ["RANGES", "SCENE_RANGES", "Range", "range_of", "writable_names"]


class Range(NamedTuple):
    """Range of a field; of a vector, of each of its components.

    Attributes:
        least: Smallest value.
        most: Largest value.
        unit: SI unit, "" for none.
        written: Whether tasks, scenarios and plug-ins may write the field.
    """

    least: float
    most: float
    unit: str = ""
    written: bool = True

    def holds(self, values: Records) -> bool:
        """Return whether every value is finite and within the range."""
        return bool(np.all((values >= self.least) & (values <= self.most)))

    def __str__(self) -> str:
        return f"within {self.least:g} and {self.most:g} {self.unit}".rstrip()


_SHARE = Range(0.0, 1.0)
_STIFFNESS = Range(0.0, 1e6, "N/m")
_DAMPING = Range(0.0, 1e5, "N s/m")
_OBJECT_DAMPING = Range(0.0, 1e6, "N s/m")
_PLACE = Range(-1e3, 1e3, "m")
_TURN = Range(-2.0, 2.0)
_ANY = Range(-1e6, 1e6)


def _built(least: float, most: float, unit: str = "") -> Range:
    """Return the range of a field that is built with the scene and never written afterwards."""
    return Range(least, most, unit, written=False)


SCENE_RANGES: Mapping[str, Range] = {
    "virtual_mass": Range(1e-3, 1e6, "kg"),
    "virtual_damping": _DAMPING,
    "ball_radius_min": Range(0.0, 10.0, "m"),
    "ball_radius_max": Range(0.0, 10.0, "m"),
    "grasp_force_full": Range(0.0, 1e3, "N"),
    "target": Range(-1e3, 1e3, "m, rad"),
    "reference_cadence": Range(0.0, 3.0, "1/s"),
    "reference_speed": Range(0.0, 3.0, "m/s"),
    "reference_amplitude": _SHARE,
    "guidance": _SHARE,
    "cadence_rate": _built(0.0, 10.0, "1/s^2"),
    "speed_rate": _built(0.0, 10.0, "m/s^2"),
    "amplitude_rate": _built(0.0, 10.0, "1/s"),
    "guidance_rate": _built(0.0, 10.0, "1/s"),
    "natural_step": _built(0.0, 3.0, "m"),
    "longest_step": _built(0.0, 3.0, "m"),
    "controller_parameters": _built(-1e9, 1e9),
    "drive_rate": _built(0.0, 1e4, "1/s"),
    "drive_stiffness": _built(0.0, 1e6, "N/m"),
    "drive_damping": _built(0.0, 1e5, "N s/m"),
    "geometry": _built(-1e3, 1e3),
    "joint_inertia": _built(0.0, 1e6),
    "origin_world": _built(-1e3, 1e3, "m"),
}
"""Ranges of the fields of SCENE itself that are neither limits nor choices."""

RANGES: Mapping[str, Mapping[str, Range]] = {
    "shapes": {
        "enabled": _SHARE,
        "position": _built(-1e3, 1e3, "m"),
        "orientation": _built(-2.0, 2.0),
        "size": _built(0.0, 1e3, "m"),
        "rounding": _built(0.0, 1e3, "m"),
        "stiffness": Range(1e-6, 1e6, "N/m"),
        "damping": _OBJECT_DAMPING,
        "exponent": Range(0.0, 3.0),
        "friction_static": Range(0.0, 100.0),
        "friction_dynamic": Range(0.0, 100.0),
        "friction_stiffness": Range(0.0, 1e6, "N/m"),
        "texture_height": Range(0.0, 0.01, "m"),
        "texture_length": Range(0.0, 1e3, "m"),
    },
    "bodies": {
        "spawn": Range(0.0, 2.0**62),
        "mass": Range(1e-6, 1e6, "kg"),
        "inertia": _built(-1e12, 1e12, "kg m^2"),
        "centre": _built(-1e3, 1e3, "m"),
        "position": _PLACE,
        "orientation": _TURN,
        "velocity": Range(-1e3, 1e3, "m/s"),
        "omega": Range(-1e3, 1e3, "rad/s"),
        "gravity": Range(-1e6, 1e6, "m/s^2"),
        "damping_translation": _OBJECT_DAMPING,
        "damping_rotation": Range(0.0, 1e6, "N m s"),
        "force_aux": Range(-1e6, 1e6, "N"),
        "torque_aux": Range(-1e6, 1e6, "N m"),
        "grip": _SHARE,
        "crush_force": Range(0.0, 1e6, "N"),
    },
    "effects": {
        "enabled": _SHARE,
        "position": _PLACE,
        "direction": _ANY,
        "stiffness": _STIFFNESS,
        "damping": _OBJECT_DAMPING,
        "radius": Range(0.0, 1e6, "m"),
        "force": Range(0.0, 2e6, "N"),
        "frequency": Range(0.0, 400.0, "Hz"),
        "slip": Range(0.0, 1e6, "m"),
        "parameters": _ANY,
    },
    "points": {"offset": _built(-1e3, 1e3, "m"), "radius": _built(0.0, 10.0, "m")},
    "wires": {"gain": _built(-1e12, 1e12), "offset": _built(-1e6, 1e6)},
    "tunnels": {
        "centre": _built(-1e6, 1e6, "m"),
        "radius": _built(-1e6, 1e6, "m"),
        "arc_length": _built(0.0, 1e6, "m"),
        "normal": _built(-2.0, 2.0),
        "radius_scale": Range(0.0, 1e6),
        "stiffness": _STIFFNESS,
        "damping": _DAMPING,
        "drag": _DAMPING,
        "drag_growth": Range(0.0, 1e6, "N s/m per m"),
        "centring": _STIFFNESS,
        "advance": Range(0.0, 1e3, "N"),
    },
    "curves": {
        "shift": _built(-1.0, 1.0, "cycles"),
        "rest": _built(-1e3, 1e3, "m, rad"),
        "least": _built(0.0, 10.0, "m/s, m"),
        "guidance": _SHARE,
        "values": _built(-1e7, 1e7),
    },
}
"""Ranges of the fields of the rows beside SCENE, by table; integer fields without one are choices or indices."""


def range_of(table: str, field: str) -> Range | None:
    """Return the range of a field that may be written; None: it may not.

    Args:
        table: Table of the rows, "tunnel" for the task's own tunnel, "" for SCENE itself.
        field: Name of the field.
    """
    fields = SCENE_RANGES if not table else RANGES.get("tunnels" if table == "tunnel" else table, {})
    found = fields.get(field)
    return found if found is not None and found.written else None


def writable_names(table: str) -> list[str]:
    """Return the names of the fields of a table that may be written, see `range_of`."""
    fields = SCENE_RANGES if not table else RANGES["tunnels" if table == "tunnel" else table]
    return sorted(name for name, each in fields.items() if each.written)
