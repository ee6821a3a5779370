"""How a window tells the input stage what a person did, and what a source of input looks like.

The window belongs to `rendering.visual`, the meaning of its events to `inputs`; neither imports the other. What
crosses is a list of `InputEvent` per frame and one plain callable that turns a place in the picture into a ray.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

from mimics_app.contracts.messages import PointerState, SignalBlock

__all__ = ["EventKindName", "EventSource", "InputEvent", "PointerSource", "Ray", "RayFromWindow", "SignalSource"]

EventKindName = Literal["key", "button", "wheel", "pointer", "axis", "resize", "focus", "close"]

Ray = tuple[tuple[float, float, float], tuple[float, float, float]]
"""(origin [m], unit direction), both in the world."""

RayFromWindow = Callable[[float, float], Ray | None]
"""(x, y) as shares of the window, origin top left, -> the ray through that place; None where no view is drawn."""


@dataclass(frozen=True, slots=True)
class InputEvent:
    """One thing that happened at a window, a keyboard or a gamepad since the last poll.

    Attributes:
        kind: What changed; it gives `name` and `value` their meaning.
        name: By kind:
            key      lower-case name without modifiers: "a", "7", "space", "escape", "enter", "tab", "left", "right",
                     "up", "down", "page_up", "page_down", "left_shift", "f1", "plus" (also keypad), "minus", "home" ...
            button   "mouse_left", "mouse_right", "mouse_middle"; gamepad "pad_a", "pad_b", "pad_x", "pad_y",
                     "pad_start", "pad_back", "pad_left_bumper", "pad_right_bumper", "pad_up", "pad_down", "pad_left",
                     "pad_right", "pad_left_thumb", "pad_right_thumb"
            wheel    "y" (away from the person is positive) or "x"
            pointer  "x" or "y"; a move gives both, x first
            axis     "left_x", "left_y", "right_x", "right_y", "left_trigger", "right_trigger"
            resize   "width" or "height"
            focus    "window"
            close    "window"
        value: By kind: key, button 1 pressed, 0 released (no repeats); wheel notches; pointer share of the window,
            0 left or top, 1 right or bottom; axis sticks -1 to 1 with +x right and **+y up**, triggers 0 to 1;
            resize framebuffer pixels; focus 1 gained, 0 lost; close 1.
    """

    kind: EventKindName
    name: str
    value: float


class EventSource(Protocol):
    """Whatever has a window: drained once a frame."""

    def poll(self) -> Sequence[InputEvent]:
        """Events since the last call, oldest first. Never blocks."""
        ...


class PointerSource(Protocol):
    """One way to point and grasp: a mouse, keys, a gamepad, a simulated person, a recorded one."""

    def read(self, events: Sequence[InputEvent], now_ns: int) -> PointerState | None:
        """Take one frame's events; None when this source has nothing to say yet."""
        ...

    def hold_at(self, point_world: tuple[float, float, float]) -> None:
        """The robot is being driven: rest the cursor at this point [m] until the person moves it."""
        ...


class SignalSource(Protocol):
    """One recorder of body signals."""

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """Blocks that arrived since the last call; () when none did."""
        ...
