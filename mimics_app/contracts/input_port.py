"""What the input stage needs of the outside: a window's events, a ray through its picture, sources of input.

The window belongs to `rendering.visual`, the meaning of its events to `inputs`; neither imports the other.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.messages import Aim, Experience, PointerState, SignalBlock
from mimics_app.contracts.window_input import GamepadState, InputEvent

__all__ = ["PointerSource", "Ray", "RayFromWindow", "SignalSource", "Window", "WindowFrame"]


Ray = tuple[Vec3, Vec3]
"""(origin [m], direction of any length), both in the world."""

RayFromWindow = Callable[[float, float], Ray | None]
"""(right, up), each in [-1, 1] of the window -> the ray through that place; None where no view is drawn there."""


@dataclass(frozen=True, slots=True)
class WindowFrame:
    """What happened at the window since the last frame, and the gamepad as it stands."""

    events: tuple[InputEvent, ...] = ()
    gamepad: GamepadState = field(default_factory=GamepadState)


class Window(Protocol):
    """Whatever has a window: drained once a frame."""

    @property
    def gamepad(self) -> GamepadState:
        """The first gamepad as of the last poll."""
        ...

    def poll(self) -> Sequence[InputEvent]:
        """Events since the last call, oldest first. Never blocks."""
        ...


class PointerSource(Protocol):
    """One method to point and grasp: mouse, keys and gamepad together, a simulated person, a recorded one."""

    def read(self, window: WindowFrame, now_ns: int) -> PointerState | None:
        """Take one frame; None when this source has nothing to say yet."""
        ...

    def hold_at(self, point_world: Vec3) -> None:
        """The robot is being driven: rest the cursor at this point [m] until the person moves it."""
        ...

    def aim(self, aim: Aim | None) -> None:
        """What the scene asks the hand to do next; None where it leaves that to the person."""
        ...


class SignalSource(Protocol):
    """One recorder of body signals."""

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """Blocks that arrived since the last call; () when none did."""
        ...

    def feel(self, experience: Experience) -> None:
        """What the person went through in this frame: a simulated person answers to it, a movement is read from it."""

    def close(self) -> None:
        """Let go of what is behind it."""
