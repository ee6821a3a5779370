"""Command interpreter of the emulated HapticMaster: states, effects, and answers in the machine's format.

States: the machine starts in "off"; `set state init` calibrates it by moving to the ends of its axes and leaves it in
"stop"; from there "force" and "position" are reached; "home" moves to the centre and then to "stop".
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from mimics_app.contracts.loop.loop_ports import (
    COMMAND_LENGTH,
    DATA_GRASP,
    DATA_LENGTH,
    INBOX_ACTIVE,
    INBOX_GRASP,
    INBOX_LENGTH,
    INBOX_TARGET,
    INBOX_TRIAL,
    DevicePlugin,
)
from mimics_app.rendering.haptic.devices.emulators import hapticmaster_machine as machine
from mimics_app.rendering.haptic.kernels.robot import HANDLE

__all__ = ["HapticMasterModel"]

_MOST_EFFECTS = 32
_INIT_STEPS = 50
"""Duration of the calibration [ms]; a real machine needs half a minute."""

_KINDS = {
    "spring": machine.SPRING,
    "damper": machine.DAMPER,
    "biasforce": machine.BIAS,
    "block": machine.BLOCK,
    "sphere": machine.SPHERE,
    "cylinder": machine.CYLINDER,
    "flatplane": machine.PLANE,
}

_PROPERTIES = {
    "pos": (machine.POS, 3),
    "vel": (machine.VEL, 3),
    "stiffness": (machine.STIFFNESS, 1),
    "dampfactor": (machine.DAMP, 1),
    "maxforce": (machine.MAX_FORCE, 1),
    "deadband": (machine.DEADBAND, 1),
    "direction": (machine.DIRECTION, 3),
    "size": (machine.SIZE, 3),
    "radius": (machine.SIZE, 1),
    "length": (machine.SIZE + 1, 1),
    "force": (machine.FORCE, 3),
    "dampcoef": (machine.FORCE, 3),
    "normal": (machine.FORCE, 3),
    "friction": (machine.FRICTION, 1),
}

_STATES = ("init", "off", "force", "position", "home", "stop")


class _Refused(Exception):
    """Invalid command; the message follows "--- ERROR: " in the answer."""


class HapticMasterModel:
    """Interpreter of commands, with motion in steps of a millisecond.

    Attributes:
        state: Answer to `get state`.
        inertia: Virtual mass [kg].

    Args:
        plugin: Simulated robot and person, built for RATE ticks per second.
        calibrated: False: it must be calibrated first, as after switching on.
    """

    def __init__(self, plugin: DevicePlugin, *, calibrated: bool = True) -> None:
        self.state = "stop" if calibrated else "off"
        self.plugin = plugin
        self._calibrated = calibrated
        self._machine = np.zeros(machine.MACHINE_LENGTH)
        self._machine[machine.INERTIA] = 3.0
        self._effects = np.zeros((_MOST_EFFECTS, machine.EFFECT))
        self._rows: dict[str, int] = {}
        self._inbox, self._data = np.zeros(INBOX_LENGTH), np.zeros(DATA_LENGTH)
        self._command = np.zeros(COMMAND_LENGTH)
        self._steps = 0
        self._inner = 0
        self._init_left = 0
        self._gets: dict[str, Callable[[], object]] = {
            "os": lambda: "Linux",
            "state": lambda: self.state,
            "emulator": lambda: '"mimics"',
            "inertia": lambda: float(self._machine[machine.INERTIA]),
            "coulombfriction": lambda: float(self._machine[machine.COULOMB]),
            "position_calibrated": lambda: self._calibrated,
            "force_calibrated": lambda: True,
            "emergencybuttonpushed": lambda: False,
            "emergencyrelay": lambda: True,
            "workspace_r": lambda: "[0.28,0.64]",
            "workspace_phi": lambda: "[-0.5,0.5]",
            "workspace_z": lambda: "[-0.2,0.2]",
            "measpos": lambda: self.plugin.memory[HANDLE : HANDLE + 3],
            "modelpos": lambda: self.plugin.memory[HANDLE : HANDLE + 3],
            "modelvel": lambda: self.plugin.memory[HANDLE + 3 : HANDLE + 6],
            "measforce": lambda: self._machine[machine.MEASURED : machine.MEASURED + 3],
            "grasp": lambda: float(self._data[DATA_GRASP]),
        }

    @property
    def inertia(self) -> float:
        """Virtual mass [kg]."""
        return float(self._machine[machine.INERTIA])

    def force_at(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return the force of all effects on a handle at x with velocity v [N], shape [3]."""
        total = np.zeros(3)
        machine.effects_force(self._effects, self.inertia, x, v, total)
        return total

    def step(self) -> None:
        """Advance by one millisecond: two or three controller steps."""
        self._steps += 1
        due = self._steps * machine.RATE // 1000
        machine.step_machine(
            self._machine,
            self.plugin.memory,
            self._effects,
            self._inbox,
            self._data,
            self._command,
            self.state == "force",
            self._inner,
            due - self._inner,
        )
        self._inner = due
        if self.state == "init":
            self._init_left -= 1
            if self._init_left <= 0:
                self.state, self._calibrated = "stop", True

    def release(self) -> None:
        """Stop after the client is gone; the behaviour of a real machine is not known."""
        self.state = "stop" if self._calibrated else "off"
        self._remove("all")

    def answer(self, text: str) -> str:
        """Return the answers to commands joined by ";", each terminated by ";"."""
        return "".join(f"{self._answer_one(one.strip())};" for one in text.split(";") if one.strip())

    def _answer_one(self, command: str) -> str:
        words = command.split(" ", 3)
        try:
            if words[0] == "get" and len(words) == 2:
                return self._get(words[1])
            if words[0] == "create" and len(words) == 3:
                return self._create(words[1], words[2])
            if words[0] == "remove" and len(words) == 2:
                return self._remove(words[1])
            if words[0] == "set" and len(words) >= 3:
                return self._set(words[1], words[2], words[3] if len(words) > 3 else "")
            if command == "calibrateforcesensor":
                return '"Force sensor calibrated"'
            raise _Refused(f"unknown command '{command}'")
        except _Refused as reason:
            return f"--- ERROR: {reason}"

    def _get(self, name: str) -> str:
        if name not in self._gets:
            raise _Refused(f"unknown parameter '{name}'")
        value = self._gets[name]()
        if isinstance(value, bool):
            return "true" if value else "false"
        if isinstance(value, np.ndarray):
            return "[" + ",".join(f"{number:.9g}" for number in value) + "]"
        return f"{value:.9g}" if isinstance(value, float) else str(value)

    def _create(self, kind: str, name: str) -> str:
        if kind not in _KINDS:
            raise _Refused(f"'{kind}' cannot be created")
        if name in self._rows:
            raise _Refused(f"'{name}' exists")
        free = [row for row in range(_MOST_EFFECTS) if self._effects[row, 0] == 0.0]
        if not free:
            raise _Refused("too many effects")
        self._rows[name] = free[0]
        self._effects[free[0], 0] = _KINDS[kind]
        return f'"Effect {name} created"'

    def _remove(self, name: str) -> str:
        for gone in list(self._rows) if name == "all" else [name]:
            if gone not in self._rows:
                raise _Refused(f"no effect '{gone}'")
            self._effects[self._rows.pop(gone)] = 0.0
        return '"Removed"'

    def _set(self, name: str, what: str, value: str) -> str:
        if name == "state":
            return self._set_state(what)
        if name == "inertia":
            self._machine[machine.INERTIA] = _number(what, smallest=0.5)
            return '"Inertia set"'
        if name == "coulombfriction":
            self._machine[machine.COULOMB] = _number(what, smallest=0.0)
            return '"Coulomb friction set"'
        if name == "person":
            return self._show(_vector(what, 6))
        if name not in self._rows:
            raise _Refused(f"no effect '{name}'")
        row = self._effects[self._rows[name]]
        if what in ("enable", "disable"):
            row[machine.ENABLED] = float(what == "enable")
            return f'"Effect {what}d"'
        if what not in _PROPERTIES:
            raise _Refused(f"'{name}' has no '{what}'")
        column, count = _PROPERTIES[what]
        row[column : column + count] = _vector(value, 3) if count == 3 else _number(value, smallest=0.0)
        return f'"{what} set"'

    def _set_state(self, state: str) -> str:
        if state not in _STATES:
            raise _Refused(f"unknown state '{state}'")
        if state == "init":
            self.state, self._init_left = "init", _INIT_STEPS
            return '"Initializing"'
        if not self._calibrated and state != "off":
            raise _Refused("not calibrated")
        self.state = "stop" if state == "home" else state
        return f'"State {state} set"'

    def _show(self, seen: np.ndarray) -> str:
        """Set the simulated person's inputs: active, trial, target, grasp. No real machine has this command."""
        self._inbox[INBOX_ACTIVE], self._inbox[INBOX_TRIAL] = seen[0], seen[1]
        self._inbox[INBOX_TARGET : INBOX_TARGET + 3] = seen[2:5]
        self._inbox[INBOX_GRASP] = seen[5]
        return '"Shown"'


def _number(text: str, smallest: float) -> float:
    try:
        value = float(text)
    except ValueError:
        raise _Refused(f"'{text}' is not a number") from None
    if not (math.isfinite(value) and value >= smallest):
        raise _Refused(f"{value:g} is out of range")
    return value


def _vector(text: str, count: int) -> np.ndarray:
    parts = text.strip().removeprefix("[").removesuffix("]").split(",")
    if len(parts) != count:
        raise _Refused(f"'{text}' is not a vector of {count}")
    return np.array([_number(part, smallest=-1e9) for part in parts])
