"""Controller of the robot in each state of a trial: the slot of the parameter block that acts, and its target."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain, repeat

from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.messages.orders import CONTROLLER, TARGET, HapticField, Numbers
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.contracts.ports.scenario_port import Home
from mimics_app.tasks.observation import Observation
from mimics_app.tasks.task import StartSpec

__all__ = ["Approach", "Arrival", "RobotControl"]

_HOLDS = frozenset({TrialState.FINISHED, TrialState.TIMEOUT, TrialState.ABORTED, TrialState.REST, TrialState.DONE})


class RobotControl:
    """Slot and target of each state.

    Approach: hold, then drive to the start. Ready: hold the start. Travel: the person moves the robot. Stopped: off.
    Otherwise, or paused: hold. Holding between trials supports the arm without moving it.
    """

    def __init__(self, home: Home) -> None:
        self._home = home
        self._slot = Slot.OFF
        self._target = home.target
        self._holding = False
        self._before = self._slot, self._target

    def enter(self, state: TrialState, q: tuple[float, ...]) -> None:
        """Begin a state with the joints at q [m or rad]."""
        held_before = self._holding
        self._holding = state in _HOLDS
        if state is TrialState.STOPPED:
            self._slot = Slot.OFF
        elif state is TrialState.TRAVEL:
            self._slot = Slot.PERSON
        elif state is not TrialState.READY:
            self._slot = Slot.HOLD
            self._target = self._target if held_before else q

    def set_out(self) -> None:
        """Drive to the start, and hold it until the travel."""
        self._slot, self._target = Slot.START, self._home.target

    def pause(self, q: tuple[float, ...]) -> None:
        """Hold the robot where it is, at the joints q [m or rad], until `resume`."""
        self._before = self._slot, self._target
        self._slot, self._target = Slot.HOLD, q

    def resume(self) -> None:
        """Restore controller and target of before the pause."""
        self._slot, self._target = self._before

    def wanted(self) -> Mapping[HapticField, Numbers]:
        """Return the present numbers of the controller."""
        return {CONTROLLER: int(self._slot), TARGET: self._target}


class Arrival:
    """Arrival: the joint errors are within tolerance for the hold time, while the robot follows its controller."""

    def __init__(self, spec: StartSpec, start_joints: tuple[float, ...]) -> None:
        self._spec = spec
        self._start = start_joints
        self._since_ns: int | None = None

    def restart(self) -> None:
        """Reset at the beginning of an approach."""
        self._since_ns = None

    def near(self, seen: Observation) -> bool:
        """Whether the joint errors are within tolerance in this frame."""
        errors = (abs(q - start) for q, start in zip(seen.q, self._start, strict=True))
        most = chain(self._spec.tolerance, repeat(self._spec.tolerance[-1]))
        return all(error <= limit for error, limit in zip(errors, most, strict=False))

    def reached(self, seen: Observation) -> bool:
        """Whether the robot has arrived by this frame, or is still there. Call once per frame."""
        if not (self.near(seen) and seen.movable):
            self._since_ns = None
            return False
        if self._since_ns is None:
            self._since_ns = seen.now_ns
        return (seen.now_ns - self._since_ns) / 1e9 >= self._spec.hold_s


class Approach:
    """The drive to the start of a trial: announced while the robot holds where it is, then carried out.

    Args:
        announce_s: Time of an announcement; 0 where nothing is announced [s].
        arrival: Arrival at the start.
        control: Controller of the robot.

    Attributes:
        announced_s: Time of the present announcement [s].
    """

    def __init__(self, announce_s: float, arrival: Arrival, control: RobotControl) -> None:
        self._announce_s, self._arrival, self._control = announce_s, arrival, control
        self.announced_s = 0.0
        self._set_out = False

    def begin(self, *, announced: bool) -> None:
        """Begin an approach; `announced`: its drive was announced before."""
        self.announced_s = 0.0 if announced else self._announce_s
        self._set_out = False
        self._arrival.restart()

    def restart(self) -> None:
        """Begin the time of the arrival anew, after a pause."""
        self._arrival.restart()

    def drive(self, seen: Observation, elapsed_s: float) -> None:
        """Set out once the drive was announced for its time [s]; at once where the robot is at the start already."""
        if not self._set_out and (elapsed_s >= self.announced_s or self._arrival.near(seen)):
            self._set_out = True
            self._control.set_out()

    def arrived(self, seen: Observation) -> bool:
        """Whether the robot has arrived by this frame, or is still there. Call once per frame."""
        return self._arrival.reached(seen) and self._set_out
