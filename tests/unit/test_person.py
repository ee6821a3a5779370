"""Who leads in a window: the mouse, or the person of a robot with a time of its own."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.session.person_input import person_inputs
from mimics_app.contracts.messages.stage_messages import Aim
from mimics_app.contracts.messages.window_input import GamepadState, InputEvent
from mimics_app.contracts.system.resources import root

APPLE = (0.1, 0.2, 0.05)


class Window:
    """In which the mouse has been moved."""

    gamepad = GamepadState()

    def poll(self) -> list[InputEvent]:
        return [InputEvent("move", x=0.5, y=0.5)]


@pytest.mark.parametrize("real_time", [True, False])
def test_on_a_robot_of_its_own_time_the_mouse_does_not_lead(real_time: bool):
    """An emulated robot's person follows the scene though the mouse has a cursor; at a pointer the mouse leads."""
    session: Any = SimpleNamespace(
        scene=load_checked_scene(root() / "scenes" / "pick_and_place.json"),
        scenario=SimpleNamespace(via_points_world=(), hand_frame=lambda: None),
        picture=SimpleNamespace(
            ray=lambda right, up: ((right, up, 2.0), (0.0, 0.0, -1.0)),
            surface=Window(),
            presenter=SimpleNamespace(take_pressed=tuple),
        ),
        haptics=SimpleNamespace(plugin=SimpleNamespace(name="emulated", real_time=real_time, simulated=False)),
        inputs=SimpleNamespace(signals=()),
        tasks=SimpleNamespace(lever=False),
    )
    inputs = person_inputs(session)
    inputs.aim(Aim(APPLE, close=True))
    pointer = inputs.poll(0).pointer
    assert pointer is not None and pointer.active
    assert (pointer.target_world == APPLE and pointer.grasp == 1.0) == real_time
