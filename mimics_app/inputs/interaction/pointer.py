"""Mouse, keyboard and gamepad as one pointing device: a cursor on the frontal plane and a grasp force."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.messages.stage_messages import Aim, PointerState
from mimics_app.contracts.ports.input_port import RayFromWindow, WindowFrame
from mimics_app.inputs.interaction.plane import FrontalPlane
from mimics_app.inputs.interaction.window_reach import levered, pointed

__all__ = ["GraspControl", "Pointer", "PointerSettings", "StickResponse"]

_ARROWS = {"left": (-1.0, 0.0), "right": (1.0, 0.0), "down": (0.0, -1.0), "up": (0.0, 1.0)}
_SLOW_KEYS = ("left_shift", "right_shift")
_LONGEST_FRAME_S = 0.1
"""Longest frame that the cursor moves through [s]: it must not leap after a stall."""


_TRIGGER_DEAD_ZONE = 0.05
_HOLD_KEY = "g"
_HOLD_BUTTON = "left"
_BUTTON_SHARE = 0.5
"""Grasp force of the mouse button, as a share of the largest: a firm but easy grip."""
_TAP_S = 0.2
"""Shortest squeeze by a key or button [s]: in a click of 0.05 to 0.12 s the force would hardly begin to rise."""
_MORE, _LESS = ("page_up", "equal", "kp_add"), ("page_down", "minus", "kp_subtract")


@dataclass(frozen=True, slots=True)
class StickResponse:
    """Response curve of a gamepad stick.

    The dead zone is a disc, not a cross, so that a diagonal push stays diagonal; beyond it the response rises
    continuously from 0 to 1 at the rim.

    Attributes:
        dead_zone: Deflection that counts as none, 0 to below 1.
        exponent: 1: linear; larger: finer near the centre.
    """

    dead_zone: float = 0.15
    exponent: float = 1.6

    def __post_init__(self) -> None:
        if not 0.0 <= self.dead_zone < 1.0:
            raise ValueError(f"dead_zone is {self.dead_zone}, must be at least 0 and below 1")
        if not self.exponent > 0.0:
            raise ValueError(f"exponent is {self.exponent}, must be above 0")

    def answer(self, x: float, y: float) -> tuple[float, float]:
        """Return the velocity as a share of the largest, length at most 1, for a deflection in [-1, 1]^2."""
        deflection = math.hypot(x, y)
        if not deflection > self.dead_zone:
            return 0.0, 0.0
        share = min((deflection - self.dead_zone) / (1.0 - self.dead_zone), 1.0) ** self.exponent
        return share * x / deflection, share * y / deflection


@dataclass(frozen=True, slots=True)
class PointerSettings:
    """Settings of the pointing device.

    Attributes:
        speed: Speed of the cursor with an arrow key held or a stick at its rim [m/s].
        slow: Factor on the speed while Shift is held.
        stick: Dead zone and response curve.
        grasp_full: Largest grasp force [N].
    """

    speed: float = 0.12
    slow: float = 0.25
    stick: StickResponse = field(default_factory=StickResponse)
    grasp_full: float = 20.0


@dataclass(slots=True)
class _Press:
    """A key or button that squeezes while it is down, and for a while after a tap, which one frame may hold whole."""

    down: bool = False
    rest_s: float = 0.0

    def take(self, *, pressed: bool) -> None:
        self.down = pressed
        if pressed:
            self.rest_s = _TAP_S

    def squeezes(self, seconds: float) -> bool:
        """Return whether it squeezes in a frame of `seconds` [s]."""
        squeezes = self.down or self.rest_s > 0.0
        self.rest_s = max(self.rest_s - seconds, 0.0)
        return squeezes


class GraspControl:
    """Grasp force from 0 to `full` [N].

    The wheel, + and - set a level that remains; the left mouse button, G and the triggers squeeze beyond it while they
    are pressed: the button up to half the largest force, G up to all of it.

    Args:
        full: Largest grasp force [N].
        step: Change by one wheel notch or key press [N].
        rise: Rate of rise and fall of the force by button and G [N/s].
    """

    def __init__(self, full: float, step: float | None = None, rise: float | None = None) -> None:
        self._full = full
        self._step = full / 20.0 if step is None else step
        self._rise = 2.0 * full if rise is None else rise
        self._level = 0.0
        self._squeeze = 0.0
        self._key, self._button = _Press(), _Press()

    def read(self, window: WindowFrame, seconds: float) -> float:
        """Return the grasp force [N] after one frame of `seconds` [s]."""
        for event in window.events:
            if event.kind == "wheel":
                self._change(event.y)
            elif event.kind == "key" and event.pressed and event.name in _MORE:
                self._change(1.0)
            elif event.kind == "key" and event.pressed and event.name in _LESS:
                self._change(-1.0)
            elif event.kind == "key" and event.name == _HOLD_KEY:
                self._key.take(pressed=event.pressed)
            elif event.kind == "button" and event.name == _HOLD_BUTTON:
                self._button.take(pressed=event.pressed)
        key, button = self._key.squeezes(seconds), self._button.squeezes(seconds)
        self._squeeze_towards(self._full if key else _BUTTON_SHARE * self._full if button else 0.0, seconds)
        return max(self._level, self._squeeze, self._trigger(window))

    def _squeeze_towards(self, force: float, seconds: float) -> None:
        """Move the squeeze towards a force [N] at the limited rate."""
        most = self._rise * seconds
        self._squeeze += min(max(force - self._squeeze, -most), most)

    def _change(self, notches: float) -> None:
        self._level = self._within(self._level + notches * self._step)

    def _trigger(self, window: WindowFrame) -> float:
        pull = max(window.gamepad.axes.get(name, 0.0) for name in ("left_trigger", "right_trigger"))
        share = (pull - _TRIGGER_DEAD_ZONE) / (1.0 - _TRIGGER_DEAD_ZONE)
        return self._within(share * self._full)

    def _within(self, force: float) -> float:
        return min(max(force, 0.0), self._full)


class Pointer:
    """A `PointerSource` for a person at a window.

    The mouse is absolute: the cursor is where its ray meets the plane, stretched where a part of the reach is not in
    the window (see `window_reach`); of a lever it is the deflection from the window's centre. The plane lies at the
    depth of the present target, so that a flat device reaches every target. Arrow keys and sticks are relative: they
    move the cursor at a speed, within reach. The last one used counts. `active` is False before the first movement.

    Args:
        plane: Plane of the cursor.
        ray_from_window: Ray of the view through a point of the window.
        settings: Speeds, response curve and grasp force.
        lever: True where the hand is a lever, whose deflection from the plane's centre counts, and not its place.
    """

    def __init__(
        self,
        plane: FrontalPlane,
        ray_from_window: RayFromWindow,
        settings: PointerSettings | None = None,
        *,
        lever: bool = False,
    ) -> None:
        self._lever = lever
        self._plane = plane
        self._ray = ray_from_window
        self._settings = settings or PointerSettings()
        self._grasp = GraspControl(self._settings.grasp_full)
        self._cursor = plane.centre
        self._keys: set[str] = set()
        self._active = False
        self._last_ns: int | None = None

    def read(self, window: WindowFrame, now_ns: int) -> PointerState:
        """Return the state of the pointing device after this frame's events."""
        seconds = self._frame_seconds(now_ns)
        self._take_events(window)
        self._move(window, seconds)
        return PointerState(self._cursor, self._grasp.read(window, seconds), self._active)

    def aim(self, aim: Aim | None) -> None:
        """Move the plane, with the cursor, to the depth of the target."""
        if aim is not None:
            self._plane = self._plane.through(aim.target_world)
            self._cursor = self._plane.clamp(self._cursor)

    def hold_at(self, point_world: Vec3) -> None:
        """Hold the cursor at a point [m] until the person moves it; a mouse at rest does not pull it back."""
        self._cursor = self._plane.clamp(point_world)

    def _take_events(self, window: WindowFrame) -> None:
        place: tuple[float, float] | None = None
        for event in window.events:
            if event.kind == "move":
                place = (event.x, event.y)
            elif event.kind == "key" and (event.name in _ARROWS or event.name in _SLOW_KEYS):
                _hold(self._keys, event.name, pressed=event.pressed)
        self._aim(place)

    def _aim(self, place: tuple[float, float] | None) -> None:
        """Move the cursor to the last mouse position of a frame, unless its ray misses the plane."""
        if place is None:
            return
        point = levered(self._plane, *place) if self._lever else pointed(self._plane, self._ray, *place)
        if point is not None:
            self._cursor, self._active = point, True

    def _move(self, window: WindowFrame, seconds: float) -> None:
        arrows = [_ARROWS[name] for name in self._keys if name in _ARROWS]
        x, y = sum(arrow[0] for arrow in arrows), sum(arrow[1] for arrow in arrows)
        axes = window.gamepad.axes
        stick = self._settings.stick.answer(axes.get("left_x", 0.0), -axes.get("left_y", 0.0))
        x, y = x + stick[0], y + stick[1]
        length = math.hypot(x, y)
        if length == 0.0:
            return
        slow = self._settings.slow if self._keys.intersection(_SLOW_KEYS) else 1.0
        distance = self._settings.speed * slow * seconds / max(length, 1.0)
        self._cursor, self._active = self._plane.move(self._cursor, x * distance, y * distance), True

    def _frame_seconds(self, now_ns: int) -> float:
        last, self._last_ns = self._last_ns, now_ns
        return 0.0 if last is None else min(max(now_ns - last, 0) / 1e9, _LONGEST_FRAME_S)


def _hold(held: set[str], name: str, *, pressed: bool) -> None:
    if pressed:
        held.add(name)
    else:
        held.discard(name)
