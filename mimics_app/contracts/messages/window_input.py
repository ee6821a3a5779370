"""Input events of a window as plain data, independent of the window library."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

__all__ = ["GamepadState", "InputEvent", "InputKind"]

InputKind = Literal["key", "text", "button", "move", "wheel", "pad", "resize", "close"]


@dataclass(frozen=True, slots=True)
class InputEvent:
    """One event of a window.

    Attributes:
        kind: "key", "text" (a character typed with one or more keys), "button" (mouse), "move" (pointer), "wheel",
            "pad" (gamepad button), "resize" or "close".
        name: Key ("a", "space", "escape", "up", "f11", ...), the character, mouse button ("left", "right", "middle") or
            gamepad button ("a", "b", "start", "dpad_up", ...); "" for the other kinds.
        pressed: True on press and on key repeat, False on release.
        repeat: True when a held key repeats.
        x: Pointer to the right in [-1, 1] of the window; for "wheel" the sideways steps, for "resize" the width [px].
        y: Pointer upwards in [-1, 1]; for "wheel" the steps away from the person, for "resize" the height [px].
    """

    kind: InputKind
    name: str = ""
    pressed: bool = False
    repeat: bool = False
    x: float = 0.0
    y: float = 0.0


@dataclass(frozen=True, slots=True)
class GamepadState:
    """Axes and held buttons of the first gamepad.

    Attributes:
        name: The gamepad's name; "" when none is connected.
        axes: left_x, left_y, right_x, right_y in [-1, 1] (right and down positive), left_trigger, right_trigger in
            [0, 1] (0 released).
        buttons: Names of the buttons held.
    """

    name: str = ""
    axes: Mapping[str, float] = field(default_factory=dict)
    buttons: frozenset[str] = frozenset()

    @property
    def connected(self) -> bool:
        """Whether a gamepad is connected."""
        return bool(self.name)
