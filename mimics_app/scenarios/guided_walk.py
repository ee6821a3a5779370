"""Guided walk (D2.1 3.4.2): the person's view and own body in an alley, and an avatar that brings them to a place."""

from __future__ import annotations

from mimics_app.contracts.messages.orders import Shown
from mimics_app.contracts.messages.stage_messages import HapticSnapshot, TaskOrders
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.scenarios.figures.alley_figure import AlleyFigure
from mimics_app.scenarios.figures.walking_figure import see_past_head
from mimics_app.scenarios.parts.touch_scene import TouchScene
from mimics_app.tasks.kinds.guided_walk.kind import AVATAR_AT, DEED, PERSON_AT, GuidedWalkSpec
from mimics_app.tasks.scene_section import section_of
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["SCENARIO", "GuidedWalk"]

_POINT = "point"
_GESTURES = {4: "beckon", 5: _POINT}
"""Gesture of the avatar's model by the number of the action; none for the others."""
_LONGEST = 0.1
"""Longest time step [s]: the figures must not leap after a pause."""
_SET_OUT = (TrialState.APPROACH, TrialState.READY)
"""States in which the figures stand where the walk begins."""


class GuidedWalk(TouchScene):
    """An alley along -z; places are metres along it from where the walk begins, and to its right, +x.

    Args:
        scene: The checked scene; needs a robot and a task with `guided_walk`.
        world: The world built from it.

    Raises:
        SceneError: the task has no guided walk.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        super().__init__(scene, world)
        spec = section_of(scene, GuidedWalkSpec)
        self._person = AlleyFigure(world, world.find(spec.person), -1.0)
        see_past_head(world.cameras, world.find(spec.person))
        self._avatar = AlleyFigure(world, world.find(spec.avatar), 1.0)
        x, _, z = world.find(spec.place).world_matrix()[:3, 3].tolist()
        self._place = (-z, x)
        self._now = Shown((PERSON_AT, AVATAR_AT, DEED))
        self._before_ns: int | None = None

    def apply(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        super().apply(orders, snapshot)
        self._now.follow(orders.visual)
        seconds = 0.0 if self._before_ns is None else (snapshot.t_ns - self._before_ns) * 1e-9
        self._before_ns = snapshot.t_ns
        self._move(orders.view.state, min(max(seconds, 0.0), _LONGEST))

    def _move(self, state: TrialState, seconds: float) -> None:
        """Move the figures: to the start before the travel, to the task's positions during it."""
        person, avatar = self._person, self._avatar
        if state in _SET_OUT:
            person.put(*self._now[PERSON_AT])
            avatar.put(*self._now[AVATAR_AT])
            person.face(avatar)
            avatar.face(person)
        elif state is TrialState.TRAVEL:
            person.go(self._now[PERSON_AT], avatar, seconds)
            gesture = _GESTURES.get(self._now[DEED], "still")
            avatar.go(self._now[AVATAR_AT], person, seconds, self._place if gesture == _POINT else None)
            person.show("still")
            avatar.show(gesture)


SCENARIO = GuidedWalk
