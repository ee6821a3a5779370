"""Which controller drives the robot in each state of a trial."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from mimics_app.contracts.haptic import Controller
from mimics_app.tasks.state_machine import State

__all__ = ["Home", "RobotControl"]

Vec3 = tuple[float, float, float]
_FREE = (State.READY, State.TRAVEL)


@dataclass(frozen=True, slots=True)
class Home:
    """How the robot gets to the start of a trial.

    Attributes:
        target: SCENE.target: joints [m, rad, m] for JOINT_PD, robot frame [m] for WORLD_PD.
        controller: Either of the two.
    """

    target: Vec3
    controller: Controller = Controller.JOINT_PD


class RobotControl:
    """Approach: PD to the start. Ready and travel: admittance. Stopped: off. Otherwise: hold where it is.

    Holding between trials carries the arm, and nothing moves a hand that rests.
    """

    def __init__(self, home: Home) -> None:
        self._home = home
        self._controller = Controller.OFF
        self._target = home.target
        self._holding = False

    def enter(self, state: State, q: Vec3) -> None:
        """A state begins with the joints at q [m, rad, m]."""
        held_before = self._holding
        self._holding = state not in (State.APPROACH, State.STOPPED, *_FREE)
        if state is State.STOPPED:
            self._controller = Controller.OFF
        elif state in _FREE:
            self._controller = Controller.ADMITTANCE
        else:
            self._controller = Controller.JOINT_PD
        if state is State.APPROACH:
            self._controller, self._target = self._home.controller, self._home.target
        elif self._holding and not held_before:
            self._target = q

    def wanted(self) -> Mapping[str, object]:
        """SCENE fields as they should be now."""
        return {"controller": int(self._controller), "target": self._target}
