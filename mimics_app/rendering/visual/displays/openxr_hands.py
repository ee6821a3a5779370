"""A headset's controllers: their poses as hands, their buttons as those of a gamepad, for any controller model.

A grip's +x points through the palm to the left, -z towards the thumb ("Standard pose identifiers", OpenXR 1.0, 6.3.2).
A hand's -z points along its fingers, +y out of its back, as for every tracker; its origin is the wrist.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths.poses import pose_from_parts

if TYPE_CHECKING:
    from types import ModuleType

__all__ = ["OpenXrHands"]

_PROFILE = "/interaction_profiles/khr/simple_controller"
"""Interaction profile that every runtime supports and maps its controllers to."""
_BUTTONS = {
    ("hand_left", "select"): "dpad_left",
    ("hand_right", "select"): "dpad_right",
    ("hand_left", "menu"): "a",
    ("hand_right", "menu"): "a",
}
"""Gamepad button of each controller button: the triggers move a selection left and right, the menu confirms it."""
_VALID = 3
"""Flags of a valid orientation (1) and position (2)."""
_WRIST_M = 0.08
"""Distance from the centre of the palm to the wrist [m]."""


def _grip_from_wrist(side: float) -> F8:
    """Return the pose of the left (-1) or right (+1) wrist in the grip's frame, float64 [4, 4]."""
    pose = np.eye(4)
    pose[:3, 0] = (0.0, 0.0, side)
    pose[:3, 1] = (side, 0.0, 0.0)
    pose[:3, 2] = (0.0, 1.0, 0.0)
    pose[:3, 3] = _WRIST_M * pose[:3, 2]
    return pose


class OpenXrHands:
    """Both controllers of a session; created before its first frame.

    Args:
        xr: The pyopenxr module.
        instance: Instance of the runtime.
        session: Session of the headset.
        owns: Registers a handle to be freed: (function, handle) -> handle.
    """

    def __init__(
        self, xr: ModuleType, instance: Any, session: Any, owns: Callable[[Callable[[Any], object], Any], Any]
    ) -> None:
        self._xr, self._session = xr, session
        sides = {"hand_left": "/user/hand/left", "hand_right": "/user/hand/right"}
        self._paths = {sensor: xr.string_to_path(instance, path) for sensor, path in sides.items()}
        made = xr.create_action_set(
            instance, xr.ActionSetCreateInfo(action_set_name="mimics", localized_action_set_name="mimics", priority=0)
        )
        self._set = owns(xr.destroy_action_set, made)
        kinds = xr.ActionType
        inputs = {"grip/pose": self._action("hand", kinds.POSE_INPUT)}
        self._clicks = {name: self._action(name, kinds.BOOLEAN_INPUT) for name in ("select", "menu")}
        inputs |= {f"{name}/click": action for name, action in self._clicks.items()}
        bindings = [
            xr.ActionSuggestedBinding(action, xr.string_to_path(instance, f"{side}/input/{place}"))
            for place, action in inputs.items()
            for side in sides.values()
        ]
        xr.suggest_interaction_profile_bindings(
            instance,
            xr.InteractionProfileSuggestedBinding(
                interaction_profile=xr.string_to_path(instance, _PROFILE), suggested_bindings=bindings
            ),
        )
        xr.attach_session_action_sets(session, xr.SessionActionSetsAttachInfo(action_sets=[self._set]))
        hand = inputs["grip/pose"]
        self._spaces = {
            sensor: owns(
                xr.destroy_space,
                xr.create_action_space(session, xr.ActionSpaceCreateInfo(action=hand, subaction_path=path)),
            )
            for sensor, path in self._paths.items()
        }
        self._held: set[tuple[str, str]] = set()
        self._pressed: list[str] = []

    def _action(self, name: str, kind: Any) -> Any:
        """Create an action of both hands."""
        info = self._xr.ActionCreateInfo(
            action_name=name,
            action_type=kind,
            subaction_paths=list(self._paths.values()),
            localized_action_name=name,
        )
        return self._xr.create_action(self._set, info)

    def sync(self) -> None:
        """Read the state of the controllers, once per frame."""
        xr = self._xr
        active = xr.ActiveActionSet(self._set, xr.NULL_PATH)
        xr.sync_actions(self._session, xr.ActionsSyncInfo(active_action_sets=[active]))
        held = {key for key in _BUTTONS if self._is_held(*key)}
        self._pressed += [_BUTTONS[key] for key in sorted(held - self._held)]
        self._held = held

    def take_pressed(self) -> list[str]:
        """Return the gamepad buttons pressed since the last call."""
        taken, self._pressed = self._pressed, []
        return taken

    def _is_held(self, sensor: str, name: str) -> bool:
        xr = self._xr
        query = xr.ActionStateGetInfo(action=self._clicks[name], subaction_path=self._paths[sensor])
        state = xr.get_action_state_boolean(self._session, query)
        return bool(state.is_active and state.current_state)

    def poses(self, base: Any, time: int) -> dict[str, F8]:
        """Return base_from_wrist of each tracked hand at a time of the runtime's clock, float64 [4, 4]."""
        grips = {sensor: self.place(space, base, time) for sensor, space in self._spaces.items()}
        sides = {"hand_left": -1.0, "hand_right": 1.0}
        return {sensor: grip @ _grip_from_wrist(sides[sensor]) for sensor, grip in grips.items() if grip is not None}

    def place(self, space: Any, base: Any, time: int) -> F8 | None:
        """Return base_from_space at a time of the runtime's clock, float64 [4, 4]; None where it is not tracked."""
        found = self._xr.locate_space(space, base, time)
        if int(found.location_flags) & _VALID != _VALID:
            return None
        place, turn = found.pose.position, found.pose.orientation
        return pose_from_parts((place.x, place.y, place.z), (turn.x, turn.y, turn.z, turn.w))
