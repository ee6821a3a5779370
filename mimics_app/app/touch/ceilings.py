"""The operator's ceiling of this machine: how far the limits of any scene may go.

The settings file `limits.json` keeps it, `mimics limits` sets it. Until an operator sets one, a conservative one holds.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import msgspec

from mimics_app.app.terminal.user_files import change_config, read_strictly
from mimics_app.contracts.errors import UsageError, require_choice
from mimics_app.world.components.robot import Safety

__all__ = ["CEILINGS", "FILE", "Bound", "asked_of", "notes_on", "read_ceiling", "set_ceiling"]

FILE = "limits"
"""Name of the settings file."""


class Bound(NamedTuple):
    """Ceiling of one limit, or its floor where the safe side is above.

    Attributes:
        conservative: Value of a machine whose operator has set none.
        farthest: Farthest value that an operator may set.
        unit: SI unit, "" for none.
        meaning: What is limited.
    """

    conservative: float
    farthest: float
    unit: str
    meaning: str

    @property
    def is_floor(self) -> bool:
        """Whether the safe side is above."""
        return self.farthest < self.conservative

    def held(self, asked: float, ceiling: float) -> float:
        """Return the value in force where a scene asks for one."""
        return max(asked, ceiling) if self.is_floor else min(asked, ceiling)

    def shown(self, value: float) -> str:
        """Return a value with its unit."""
        return f"{value:g} {self.unit}".rstrip()


CEILINGS: Mapping[str, Bound] = {
    "force_limit": Bound(80.0, 500.0, "N", "virtual force on the person"),
    "force_rate_limit": Bound(2000.0, 1e6, "N/s", "change of that force"),
    "power_limit": Bound(60.0, 1e4, "W", "power of that force"),
    "energy_limit": Bound(1.0, 100.0, "J", "energy that one contact may generate before a stop"),
    "velocity_limit": Bound(2.5, 10.0, "m/s", "measured velocity before a stop"),
    "drive_speed": Bound(0.1, 0.25, "m/s", "velocity of the drive to a start"),
    "max_velocity": Bound(1.5, 100.0, "m/s", "velocity of the command"),
    "max_acceleration": Bound(50.0, 1e4, "m/s^2", "acceleration of the virtual mass"),
    "measured_force_limit": Bound(250.0, 1e4, "N", "measured force before a stop"),
    "position_jump": Bound(0.001, 10.0, "m", "jump of a position before a stop"),
    "workspace_margin": Bound(0.01, 1.0, "m, rad", "distance beyond the joint limits before a stop"),
    "ramp_time_s": Bound(0.2, 0.0, "s", "soft start, at least"),
    "ramp_force": Bound(20.0, 1e3, "N", "force at which the soft start may begin"),
    "tank_size": Bound(5.0, 1e3, "J", "energy that assistance and effects can draw on"),
    "tank_refill": Bound(1.0, 1e3, "W", "constant power into it"),
    "tank_return": Bound(0.9, 1.0, "", "share of the virtual damping's losses that flows into it"),
    "passivity": Bound(1.0, 0.0, "", "1: energy that a contact generates is dissipated"),
    "passivity_damping": Bound(300.0, 1e5, "N s/m", "damping that dissipates it"),
    "stiffness_cap": Bound(1.0, 0.0, "", "1: contacts are no stiffer than stable"),
    "cap_margin": Bound(0.2, 0.0, "", "stability margin that they keep, at least"),
    "arm_damping": Bound(10.0, 1e5, "N s/m", "damping that the arm is assumed to have"),
    "late_hold_s": Bound(0.002, 1.0, "s", "lateness before the output is held"),
    "late_damp_s": Bound(0.010, 1.0, "s", "lateness before the force ramps down"),
    "late_stop_s": Bound(0.050, 1.0, "s", "lateness before a stop"),
    "missed_stop": Bound(20.0, 1000.0, "", "missed ticks in a row before a stop"),
    "stale_warn_s": Bound(0.003, 1.0, "s", "age of device data that is counted as stale"),
    "stale_stop_s": Bound(0.020, 1.0, "s", "age of device data before a stop"),
}
"""All limits of `safety` and the two of `admittance`, by the name that they have in a scene."""

_WORDS = {"cap": 1.0, "warn": 0.0}


def asked_of(safety: Safety) -> dict[str, float]:
    """Return the limits of a component as numbers, by name."""
    return {name: _number(value) for name, value in msgspec.structs.asdict(safety).items()}


def notes_on(asked: Mapping[str, float], held: Mapping[str, float]) -> list[str]:
    """Return a line for each limit that a scene sets beyond its usual value, the default of `safety`.

    Args:
        asked: Limits that the scene asks for.
        held: Those in force.
    """
    usual = asked_of(Safety())
    lines = []
    for name, bound in CEILINGS.items():
        most = usual.get(name, bound.conservative)
        if bound.held(asked[name], most) == asked[name]:
            continue
        force = "in force" if held[name] == asked[name] else f"held at {bound.shown(held[name])} on this machine"
        lines.append(f"{name} {bound.shown(asked[name])}, usually {bound.shown(most)}: {force}")
    return lines


def _number(value: object) -> float:
    return _WORDS[value] if isinstance(value, str) else float(value)  # type: ignore[arg-type]


def read_ceiling() -> dict[str, float]:
    """Return the ceiling of this machine, a value for each of CEILINGS.

    Raises:
        UsageError: The settings file is damaged, or has a name or value that is none.
    """
    kept = read_strictly(FILE)
    for name, value in kept.items():
        _check(name, value)
    return {name: float(kept.get(name, bound.conservative)) for name, bound in CEILINGS.items()}  # type: ignore[arg-type]


def set_ceiling(name: str, value: float | None) -> None:
    """Keep a ceiling of this machine; None: the conservative one again.

    Raises:
        UsageError: The limit is unknown, or the value is beyond what an operator may set.
    """
    _check(name, CEILINGS[name].conservative if value is None and name in CEILINGS else value)

    def change(kept: Mapping[str, object]) -> Mapping[str, object]:
        others = {other: each for other, each in kept.items() if other != name}
        return others if value is None else {**others, name: value}

    change_config(FILE, change)


def _check(name: str, value: object) -> None:
    require_choice(name, CEILINGS, "limit")
    bound = CEILINGS[name]
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value) or value < 0:
        raise UsageError(f'the ceiling of "{name}" is {value!r}; it must be a number of 0 or more')
    if bound.held(float(value), bound.farthest) != value:
        side = "below" if bound.is_floor else "above"
        raise UsageError(f'the ceiling of "{name}" is {value:g}; it may not be {side} {bound.shown(bound.farthest)}')
