"""The left half of Figure 1 in one session: signals, their processing, the person's state, the learning system."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from mimics_app.app.settings import RunSettings
from mimics_app.contracts.input_port import SignalSource
from mimics_app.contracts.stages import Dsp, Estimation, Goal, Learning
from mimics_app.dsp.stage import NullDsp
from mimics_app.estimation.stage import NullEstimation
from mimics_app.learning.action_sequence import load_action_sequence
from mimics_app.learning.stage import NullLearning, TaskGoal
from mimics_app.tasks.actions import build_action_space
from mimics_app.tasks.task import TaskSpec

__all__ = ["Body", "open_body"]


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """The parts.

    Attributes:
        sources: Recorders of signals.
        dsp: Signals to features.
        estimation: Features to state.
        learning: State, result and reward to actions.
        goal: What the learning system is rewarded for.
        header: What a recording must say for a replay to make the same parts.
    """

    sources: tuple[SignalSource, ...] = ()
    dsp: Dsp = field(default_factory=lambda: NullDsp())
    estimation: Estimation = field(default_factory=lambda: NullEstimation())
    learning: Learning = field(default_factory=NullLearning)
    goal: Goal = field(default_factory=TaskGoal)
    header: Mapping[str, object] = field(default_factory=dict)


def open_body(settings: RunSettings, task: TaskSpec) -> Body:
    """What a run asks for, the null stages where it asks for nothing.

    Raises:
        SceneError: the action file is wrong.
    """
    if settings.action is not None:
        return Body(learning=load_action_sequence(settings.action, build_action_space(task)))
    return Body()
