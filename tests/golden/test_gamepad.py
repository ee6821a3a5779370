"""A gamepad as GLFW reports it becomes named axes, held buttons and events; played by a stand-in for the library."""

from __future__ import annotations

from types import SimpleNamespace

import glfw
import pytest

from mimics_app.contracts.messages.window_input import GamepadState
from mimics_app.rendering.visual.surfaces.window import WindowSurface


@pytest.fixture
def window(monkeypatch):
    """A window without a display: only its gamepad part is alive. `pads` maps joystick number to its raw state."""
    pads: dict[int, SimpleNamespace | None] = {}
    monkeypatch.setattr(glfw, "joystick_present", lambda number: number in pads)
    monkeypatch.setattr(glfw, "joystick_is_gamepad", lambda number: pads.get(number) is not None)
    monkeypatch.setattr(glfw, "get_gamepad_state", pads.get)
    monkeypatch.setattr(glfw, "get_gamepad_name", lambda _number: b"Stand-in")
    surface = WindowSurface.__new__(WindowSurface)
    surface._read_library(glfw)
    surface.gamepad = GamepadState()
    return SimpleNamespace(surface=surface, pads=pads)


def raw(buttons: dict[int, int] | None = None, axes: dict[int, float] | None = None) -> SimpleNamespace:
    released = {glfw.GAMEPAD_AXIS_LEFT_TRIGGER: -1.0, glfw.GAMEPAD_AXIS_RIGHT_TRIGGER: -1.0}
    return SimpleNamespace(
        buttons=[(buttons or {}).get(i, 0) for i in range(15)],
        axes=[(released | (axes or {})).get(i, 0.0) for i in range(6)],
    )


def test_no_gamepad_is_no_gamepad(window):
    window.surface._read_gamepad()
    assert not window.surface.gamepad.connected
    assert window.surface._events == []


def test_a_joystick_without_a_mapping_is_passed_over(window):
    window.pads[0] = None
    window.pads[3] = raw()
    window.surface._read_gamepad()
    assert window.surface.gamepad.name == "Stand-in"


def test_triggers_rest_at_zero_and_sticks_keep_their_signs(window):
    window.pads[0] = raw(axes={glfw.GAMEPAD_AXIS_RIGHT_TRIGGER: 0.5, glfw.GAMEPAD_AXIS_LEFT_Y: -0.25})
    window.surface._read_gamepad()
    axes = window.surface.gamepad.axes
    assert axes == {
        "left_x": 0.0,
        "left_y": -0.25,
        "right_x": 0.0,
        "right_y": 0.0,
        "left_trigger": 0.0,
        "right_trigger": 0.75,
    }


def test_buttons_are_named_and_become_events_once(window):
    window.pads[0] = raw({glfw.GAMEPAD_BUTTON_A: 1, glfw.GAMEPAD_BUTTON_DPAD_UP: 1})
    window.surface._read_gamepad()
    window.surface._read_gamepad()
    window.pads[0] = raw({glfw.GAMEPAD_BUTTON_DPAD_UP: 1})
    window.surface._read_gamepad()
    events = [(event.kind, event.name, event.pressed) for event in window.surface._events]
    assert events == [("pad", "a", True), ("pad", "dpad_up", True), ("pad", "a", False)]


def test_an_unplugged_gamepad_lets_go_of_its_buttons(window):
    window.pads[0] = raw({glfw.GAMEPAD_BUTTON_START: 1})
    window.surface._read_gamepad()
    window.pads.clear()
    window.surface._read_gamepad()
    assert [(event.name, event.pressed) for event in window.surface._events] == [("start", True), ("start", False)]
    assert not window.surface.gamepad.connected
