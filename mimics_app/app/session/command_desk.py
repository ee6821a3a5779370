"""Commands to the session: taken from all sources once a frame, carried out or refused, answered and recorded."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Literal

from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.commands.vocabulary import (
    Calibrate,
    Command,
    Confirm,
    End,
    Fault,
    Mark,
    Mute,
    Note,
    Obstacle,
    Policy,
    Recalibrate,
    Reply,
    Reset,
    SetParameter,
    Stop,
    View,
    Volume,
    command_values,
    name_of,
    refusal,
)
from mimics_app.contracts.errors import UsageError, counted
from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.contracts.loop.haptic import LIMIT_NAMES, SafetyState
from mimics_app.contracts.messages.stage_messages import HapticSnapshot, TaskAction
from mimics_app.contracts.shared_memory.command_ring import Answer, CommandReceiver, Given
from mimics_app.rendering.haptic.controllers.parameter_vector import changed_components
from mimics_app.rendering.haptic.controllers.registry import controller_of_person, obstacle_names
from mimics_app.tasks.steering import TASK_COMMANDS

if TYPE_CHECKING:
    from mimics_app.app.session.core import SessionCore

__all__ = ["CommandDesk"]

_LATCHED = (SafetyState.SAFE_STOP, SafetyState.E_STOP)
_DONE = Reply(done=True)
_OF_CONTROLLER = "controller."
"""Before the name of a parameter of the controller under which the person leads; all others are the task's."""


_PolicyMode = Literal["on", "off", "propose"]


def _refused(why: str) -> Reply:
    return Reply(done=False, why=why)


def _tried(order: Callable[[str], None], name: str) -> Reply:
    """Give the device an order by name; return why it refused."""
    try:
        order(name)
    except UsageError as error:
        return _refused(str(error))
    return _DONE


class _PolicyGate:
    """Stands between the learning system and the task.

    In each mode the policy is asked and learns from what was played, so that it can be switched on again and a replay
    asks it the same.

    Args:
        has_policy: Whether the session has a policy or a list of actions.

    Attributes:
        mode: "on": carried out; "off": recorded only; "propose": the newest choice waits for `confirm`.
        proposal: The choice that waits; None without one.
    """

    def __init__(self, *, has_policy: bool) -> None:
        self._has_policy = has_policy
        self.mode: _PolicyMode = "on"
        self.proposal: TaskAction | None = None
        self._confirmed: TaskAction | None = None

    def switch(self, mode: _PolicyMode) -> Reply:
        """Change the mode; a proposal that waits is dropped."""
        if not self._has_policy:
            return Reply(done=False, why="this session has no policy")
        self.mode, self.proposal = mode, None
        return Reply(done=True)

    def confirm(self, *, accept: bool) -> Reply:
        """Carry out the proposal in this frame, or drop it."""
        if self.proposal is None:
            return Reply(done=False, why="nothing is proposed")
        if accept:
            self._confirmed = self.proposal
        self.proposal = None
        return Reply(done=True)

    def passed(self, action: TaskAction | None) -> TaskAction | None:
        """Return what of a new choice is carried out with the next frame."""
        if self.mode == "propose" and action is not None:
            self.proposal = action
        return action if self.mode == "on" else None

    def take_confirmed(self) -> TaskAction | None:
        """Return the proposal that was confirmed in this frame."""
        confirmed, self._confirmed = self._confirmed, None
        return confirmed


class CommandDesk:
    """Takes the commands of a frame.

    Args:
        core: The session.

    Attributes:
        ended: Whether a command ended the session.
        gate: What the policy may do.
    """

    def __init__(self, core: SessionCore) -> None:
        self._core = core
        self._receiver = CommandReceiver(core.memory)
        self._taken: list[tuple[Given, Reply | None]] = []
        self._stopped = False
        self._snapshot: HapticSnapshot | None = None
        self.ended = False
        self.gate = _PolicyGate(has_policy=core.has_policy)
        self._receivers: Mapping[type[Command], Callable[..., Reply]] = {
            Stop: lambda command: self._stop(),
            Reset: lambda command: self._reset(),
            Policy: lambda command: self.gate.switch(command.mode),
            Confirm: lambda command: self.gate.confirm(accept=command.accept),
            Volume: lambda command: core.sound.set_volume(command.level),
            Mute: lambda command: core.sound.mute(on=command.on),
            Recalibrate: lambda command: core.recalibrate(),
            End: lambda command: self._end(),
            Note: lambda command: _DONE,
            Mark: lambda command: _DONE,
            Obstacle: lambda command: self.call_obstacle(command.name),
            View: lambda command: core.show_view(command.name),
            Fault: lambda command: _tried(core.haptics.inject, command.name),
            Calibrate: lambda command: _tried(core.haptics.calibrate, command.step),
        }

    def take(self, snapshot: HapticSnapshot) -> tuple[Command, ...]:
        """Take what was given since the last frame, and carry out what is not the task's.

        Args:
            snapshot: State of the loop that the frame sees.

        Returns:
            The commands of the task, in the order in which they were given.
        """
        self._snapshot, self._stopped = snapshot, False
        self._tell_dropped()
        given = self._receiver.take()
        self._taken = [(each, self._answer(each)) for each in given]
        return tuple(each.command for each, reply in self._taken if reply is None and each.command is not None)

    def answer(self, replies: Sequence[Reply], frame: int, now_ns: int) -> None:
        """Answer and record the commands of the frame, those of the task by its replies."""
        if not self._taken:
            return
        tick, of_task = 0 if self._snapshot is None else self._snapshot.tick, iter(replies)
        for given, reply in self._taken:
            done, why = reply or next(of_task)
            line = _line(given, frame, tick, now_ns) | {"of_task": reply is None, "done": done, "why": why}
            self._core.recorder.journal("command", line)
            self._receiver.answer(given, Answer(given.sequence, done, why, frame, tick))
        self._taken = []

    def _answer(self, given: Given) -> Reply | None:
        """Return what became of a command; None for one that the task is to carry out."""
        command = given.command
        if command is None:
            return _refused(given.fault)
        why = refusal(command, given.source, simulated=self._core.haptics.plugin.simulated)
        if why:
            return _refused(why)
        if isinstance(command, SetParameter) and command.name.startswith(_OF_CONTROLLER):
            return self._set_controller(command)
        if isinstance(command, TASK_COMMANDS):
            return None
        return self._receivers[type(command)](command)

    def _stop(self) -> Reply:
        """Note the stop: its source has set its stop word already."""
        self._stopped = True
        return _DONE

    def _reset(self) -> Reply:
        if self._stopped:
            return _refused("a stop was given in the same frame")
        if self._snapshot is None or self._snapshot.state not in _LATCHED:
            return _refused("no stop is latched")
        self._core.parameter_store.reset()
        return _DONE

    def call_obstacle(self, name: str) -> Reply:
        """Let the controller of the person begin an obstacle, by a name that it has; of a person or a task."""
        store = self._core.parameter_store
        known = obstacle_names(store.block)
        if not known:
            return _refused("this scene has no obstacles")
        if name not in known:
            return _refused(f"this scene has the obstacles {', '.join(known)}")
        if self._stopped or self._snapshot is None or self._snapshot.gait_state != GaitState.WALKING:
            return _refused("an obstacle appears only while the patient walks in the orthosis")
        store.call_obstacle(known.index(name))
        return _DONE

    def _set_controller(self, command: SetParameter) -> Reply:
        """Set a parameter of the controller, within the limits that it declares."""
        name, store = command.name.removeprefix(_OF_CONTROLLER), self._core.parameter_store
        if name in LIMIT_NAMES:
            return _refused(f'"{name}" is a limit of the haptic loop, set once at the start under "safety"')
        controller = controller_of_person(store.block)
        if controller is None:
            return _refused("this session has no controller under which the person leads")
        try:
            components, value, remark = changed_components(controller, name, command.value)
        except UsageError as error:
            return _refused(str(error))
        parameters = store.block[0]["controller_parameters"][Slot.PERSON].copy()
        parameters[list(components)] = value
        if why := controller.misfit(parameters):
            return _refused(f'the controller "{controller.name}" {why}')
        store.steer_controller(components, value)
        return Reply(done=True, why=remark)

    def _end(self) -> Reply:
        self.ended = True
        return _DONE

    def _tell_dropped(self) -> None:
        for source, number in self._receiver.take_dropped().items():
            self._core.recorder.journal("commands_dropped", {"from": source.name.lower(), "number": number})
            self._core.report(f"{counted(number, 'commands')} from {_said(source)} came too fast and were lost")


def _line(given: Given, frame: int, tick: int, now_ns: int) -> dict[str, object]:
    """Return a command as a line of the journal, without its answer."""
    command = given.command
    what = {} if command is None else {"command": name_of(command), "values": command_values(command)}
    return {
        "frame": frame,
        "tick": tick,
        "t_ns": now_ns,
        "from": given.source.name.lower(),
        "who": given.who,
        "sequence": given.sequence,
        "given_ns": given.t_ns,
        **what,
    }


def _said(source: CommandSource) -> str:
    return {CommandSource.FILE: "the command file", CommandSource.PYTHON: "Python"}.get(
        source, f"the {source.name.lower()}"
    )
