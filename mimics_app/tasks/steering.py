"""Commands to the task: each is carried out by the receiver of its type, or refused with the reason."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from mimics_app.contracts.commands.vocabulary import (
    Command,
    Pause,
    Repeat,
    Reply,
    Resume,
    SetAssistance,
    SetParameter,
    Skip,
    StartTrial,
    name_of,
)
from mimics_app.contracts.errors import nearest
from mimics_app.contracts.loop.haptic import LIMIT_NAMES
from mimics_app.contracts.messages.action_space import ActionSpace
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.tasks.adaptation import Adaptation
from mimics_app.tasks.attempts import Attempts
from mimics_app.tasks.countdown import Countdown
from mimics_app.tasks.prompt import REPEATED, SKIPPED
from mimics_app.tasks.state_machine import UNDER_WAY
from mimics_app.tasks.state_machine import Pause as PauseState

__all__ = ["TASK_COMMANDS", "Steering"]

TASK_COMMANDS = (Pause, Resume, Skip, Repeat, StartTrial, SetParameter, SetAssistance)
"""Commands that the task carries out."""

_WAITS = (TrialState.FINISHED, TrialState.TIMEOUT, TrialState.ABORTED, TrialState.REST)
_ASSISTS = "assistance"
"""Name of the adaptable parameter that `SetAssistance` sets."""
_DONE = Reply(done=True)


def _refused(why: str) -> Reply:
    return Reply(done=False, why=why)


class Steering:
    """Receives the commands of a frame, before the state machine looks at it.

    Args:
        space: The adaptable parameters.
        adaptation: Their values.
        attempts: Trials and attempts.
        pause: The pause.
        countdown: The page before the first trial, and the countdown.

    Attributes:
        replies: What became of each of the frame's commands.
        gave_up: Cause of the end of the trial under way in this frame, SKIPPED or REPEATED; "" for none.
        hurried: Whether a shown result or a rest ends in this frame.
        overruled: Names of the parameters that commands set in this frame: an action of a policy does not change them.
    """

    def __init__(
        self, space: ActionSpace, adaptation: Adaptation, attempts: Attempts, pause: PauseState, countdown: Countdown
    ) -> None:
        self._space, self._adaptation, self._attempts = space, adaptation, attempts
        self._pause, self._countdown = pause, countdown
        self.replies: tuple[Reply, ...] = ()
        self.gave_up = ""
        self.hurried = False
        self.overruled: frozenset[str] = frozenset()
        self._receivers: Mapping[type[Command], Callable[..., Reply]] = {
            Pause: lambda command, state: self._switch_pause(state, on=True),
            Resume: lambda command, state: self._switch_pause(state, on=False),
            Skip: lambda command, state: self._give_up(state, SKIPPED),
            Repeat: lambda command, state: self._repeat(state),
            StartTrial: lambda command, state: self._start(state),
            SetParameter: lambda command, state: self._set(command),
            SetAssistance: lambda command, state: self._set_assistance(command),
        }

    def take(self, commands: Sequence[Command], state: TrialState, *, begun: bool) -> None:
        """Carry out the commands of a frame.

        Args:
            commands: Commands in their order.
            state: State of the trial.
            begun: Whether a frame came before this one; until then there is nothing to steer but parameters.
        """
        self.gave_up, self.hurried, self.overruled = "", False, frozenset()
        self.replies = tuple(self._one(command, state, begun=begun) for command in commands)

    def _one(self, command: Command, state: TrialState, *, begun: bool) -> Reply:
        receive = self._receivers.get(type(command))
        if receive is None:
            return _refused(f"{name_of(command)} is not a command to the task")
        if not begun and not isinstance(command, (SetParameter, SetAssistance)):
            return _refused("the session has not begun")
        return receive(command, state)

    def _switch_pause(self, state: TrialState, *, on: bool) -> Reply:
        why = self._pause.want(on, state)
        return _refused(why) if why else _DONE

    def _hindrance(self, state: TrialState) -> str:
        if state is TrialState.DONE:
            return "the session is over"
        if self._pause.on:
            return "the task is paused: resume first"
        return "another command has ended the trial" if self.gave_up else ""

    def _give_up(self, state: TrialState, cause: str) -> Reply:
        if why := self._hindrance(state):
            return _refused(why)
        stopped = state is TrialState.STOPPED and not self._attempts.trial_over
        if state not in UNDER_WAY and not stopped:
            return _refused("no trial is under way")
        self.gave_up = cause
        self._attempts.give_up()
        return _DONE

    def _repeat(self, state: TrialState) -> Reply:
        if why := self._hindrance(state):
            return _refused(why)
        done = self._give_up(state, REPEATED)
        if not done.done and not (state in _WAITS and self._attempts.trial_over):
            return _refused("the trial is played again already")
        self._attempts.repeat()
        return _DONE

    def _start(self, state: TrialState) -> Reply:
        if why := self._hindrance(state):
            return _refused(why)
        if state in _WAITS:
            self.hurried = True
            return _DONE
        if state is TrialState.READY and self._countdown.reading:
            self._countdown.begin()
            return _DONE
        return _refused("a stop is latched" if state is TrialState.STOPPED else "the trial is under way")

    def _set(self, command: SetParameter) -> Reply:
        name = command.name
        if name.rpartition(".")[2] in LIMIT_NAMES and name not in self._space:
            return _refused(f'"{name}" is a limit of the haptic loop, set once at the start under "safety"')
        if name not in self._space:
            hint = nearest(name, self._space.names) if len(self._space) else "this task has none"
            return _refused(f'there is no adaptable parameter "{name}"; {hint}')
        if not math.isfinite(command.value):
            return _refused(f'the value of "{name}" must be finite, not {command.value}')
        return self._override({name: command.value})

    def _set_assistance(self, command: SetAssistance) -> Reply:
        helps = [parameter for parameter in self._space if parameter.name == _ASSISTS]
        if not helps:
            return _refused("this task has no parameter of assistance")
        return self._override({p.name: p.low + command.share * (p.high - p.low) for p in helps})

    def _override(self, values: Mapping[str, float]) -> Reply:
        if why := "; ".join(filter(None, map(self._never, values))):
            return _refused(why)
        self._adaptation.override(values)
        self.overruled |= values.keys()
        clipped = [name for name in values if not self._space[name].fits(values[name])]
        later = [name for name in values if self._space[name].rate == 0.0]
        said = [f"{name} is limited to {self._space[name].clip(values[name]):g}" for name in clipped]
        said += [f"{name} changes with the next trial" for name in later]
        said += filter(None, map(self._own, values))
        return Reply(done=True, why="; ".join(said))

    def _never(self, name: str) -> str:
        """Return why no trial would have a value that is set now; "" where one would."""
        own, coming = self._attempts.own_values(name)
        at_once = self._attempts.under_way and self._space[name].rate > 0.0
        if at_once or not coming or own < coming:
            return ""
        return f'every trial to come has its own value of "{name}" in the list of trials'

    def _own(self, name: str) -> str:
        own, coming = self._attempts.own_values(name)
        return f"{own} of {coming} trials to come have their own {name} and keep it" if own else ""
