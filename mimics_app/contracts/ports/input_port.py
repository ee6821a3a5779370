"""Ports of the input stage: window events, picking rays, and sources of input.

The window belongs to `rendering.visual`, the interpretation of its events to `inputs`; neither imports the other.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.messages.stage_messages import Aim, Experience, PointerState, SignalBlock
from mimics_app.contracts.messages.window_input import GamepadState, InputEvent

__all__ = ["PointerSource", "Ray", "RayFromWindow", "SignalSource", "Window", "WindowFrame"]


Ray = tuple[Vec3, Vec3]
"""(origin [m], direction of any length), both in the world."""

RayFromWindow = Callable[[float, float], Ray | None]
"""(right, up), each in [-1, 1] of the window -> the ray through that point; None outside every view."""


@dataclass(frozen=True, slots=True)
class WindowFrame:
    """Window events since the last frame, and the present state of the gamepad."""

    events: tuple[InputEvent, ...] = ()
    gamepad: GamepadState = field(default_factory=GamepadState)


class Window(Protocol):
    """A window, polled once per frame."""

    @property
    def gamepad(self) -> GamepadState:
        """State of the first gamepad at the last poll."""
        ...

    def poll(self) -> Sequence[InputEvent]:
        """Return the events since the last call, oldest first; never blocks."""
        ...


class PointerSource(Protocol):
    """Source of pointing and grasping: mouse, keys and gamepad together, a simulated person, or a recording."""

    def read(self, window: WindowFrame, now_ns: int) -> PointerState | None:
        """Process one frame; return None while there is no state yet."""
        ...

    def hold_at(self, point_world: Vec3) -> None:
        """Keep the cursor at this point [m], where the robot is driven, until the person moves it."""
        ...

    def aim(self, aim: Aim | None) -> None:
        """Set the next action of the hand in the scene; None: left to the person."""
        ...


@runtime_checkable
class SignalSource(Protocol):
    """Source of body signals."""

    @property
    def lost(self) -> str:
        """Why there are no more samples, in one line; "" while there are. The session continues without them."""
        return ""

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """Return the blocks since the last call; () for none."""
        ...

    def take_experience(self, experience: Experience) -> None:
        """Process the experience of this frame, from which simulated signals and movement signals are derived."""

    def close(self) -> None:
        """Release the device or file."""
