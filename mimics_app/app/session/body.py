"""Left half of D2.1 Figure 1 in one session: body signals, processing, the person's state, the learning system."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import msgspec

from mimics_app.app.settings import RunSettings
from mimics_app.app.terminal.output import say
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.messages.action_space import ActionSpace, Parameter
from mimics_app.contracts.messages.stage_messages import FeatureFrame, SignalBlock, TrialResult, UserState
from mimics_app.contracts.ports.input_port import SignalSource
from mimics_app.contracts.ports.stages import Dsp, Estimation, Goal, Learning
from mimics_app.learning.action_sequence import ActionSequence, load_action_sequence
from mimics_app.learning.goals import TaskGoal
from mimics_app.learning.policy import Policy
from mimics_app.tasks.actions import build_action_space, build_learning_space
from mimics_app.tasks.task import TaskSpec

__all__ = ["Body", "NullDsp", "NullEstimation", "make_stages", "open_body"]


class NullDsp:
    """Signal processing of a scene without body signals: every frame is empty."""

    def process(self, signals: Sequence[SignalBlock], now_ns: int) -> FeatureFrame:
        """Return a frame without features at this time."""
        return FeatureFrame(now_ns)


class NullEstimation:
    """Estimator whose state is always unknown."""

    def update(self, features: FeatureFrame) -> UserState:
        """Return an unknown state at the time of the features."""
        return UserState(features.t_ns)

    def update_from_result(self, result: TrialResult) -> UserState:
        """Return an unknown state at the time of the result."""
        return UserState(result.t_ns)

    def recalibrate(self) -> None:
        """Nothing is measured."""


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """The stages and their sources.

    Attributes:
        sources: Sources of signals.
        dsp: Stage from signals to features.
        estimation: Stage from features to state.
        learning: Stage from state, result and reward to actions.
        goal: Reward function of the learning system.
        header: Entry of the recording from which a replay makes the same stages, see `make_stages`.
    """

    sources: tuple[SignalSource, ...] = ()
    dsp: Dsp = field(default_factory=lambda: NullDsp())
    estimation: Estimation = field(default_factory=lambda: NullEstimation())
    learning: Learning = field(default_factory=ActionSequence)
    goal: Goal = field(default_factory=TaskGoal)
    header: Mapping[str, object] = field(default_factory=dict)


def open_body(settings: RunSettings, task: TaskSpec, preset: str = "", policy: Policy | None = None) -> Body:
    """Return the stages that a run requests; null stages for the others.

    Args:
        settings: Settings of the run.
        task: The task; the defaults of its parameters have been filled in.
        preset: Preset of the simulated patient, which a simulated body without a preset takes.
        policy: Policy given by a program instead of a name; a replay does not ask it again.

    Raises:
        SceneError: The action file, or a file of signals, is faulty.
        UsageError: A policy, goal, estimator or source does not exist, or the policy cannot follow the goal.
        DeviceError: The source is not available.
    """
    body = Body()
    learn = "" if settings.action is not None else settings.learn or task.learn
    if settings.physio or learn or policy is not None:
        learn = "" if policy is not None else learn
        header = _header(settings, task, learn)
        if learn:
            _check_learning(learn, str(header["goal"]), build_learning_space(task))
        body = replace(make_stages(header), sources=_sources(settings, preset))
        if policy is not None:
            body = replace(body, learning=_with(policy, str(header["goal"]), task, settings.seed))
    if settings.action is not None:
        body = replace(body, learning=load_action_sequence(settings.action, build_action_space(task)))
    return body


def make_stages(header: Mapping[str, object]) -> Body:
    """Return signal processing, estimation, learning and goal by a header, without sources.

    Raises:
        UsageError: The policy, goal or estimator does not exist.
    """
    from mimics_app.dsp.stage import PhysioDsp
    from mimics_app.estimation.registry import build_estimation
    from mimics_app.learning.goals import build_goal

    read = msgspec.convert(header, _Header)
    learning: Learning = ActionSequence()
    try:
        goal = build_goal(read.goal)
        if read.learn:
            from mimics_app.learning.builder import build_learning

            learning = build_learning(read.learn, read.goal, ActionSpace(read.parameters), read.seed)
    except ValueError as error:
        raise UsageError(str(error)) from error
    return Body(
        dsp=PhysioDsp(),
        estimation=build_estimation(read.estimator, read.baseline_s),
        learning=learning,
        goal=goal,
        header=msgspec.to_builtins(read),
    )


def _with(policy: Policy, goal: str, task: TaskSpec, seed: int) -> Learning:
    from mimics_app.learning.builder import build_with

    try:
        return build_with(policy, goal, build_learning_space(task), seed)
    except ValueError as error:
        raise UsageError(str(error)) from error


def _check_learning(learn: str, goal: str, space: ActionSpace) -> None:
    """Check that the policy can follow the goal in this task.

    Raises:
        UsageError: It cannot, or the goal or policy is unknown.
    """
    from mimics_app.learning.builder import check_learning

    try:
        check_learning(learn, goal, space)
    except ValueError as error:
        raise UsageError(str(error)) from error


class _Header(msgspec.Struct, frozen=True):
    """See `Body.header`."""

    learn: str
    goal: str
    seed: int
    baseline_s: float
    parameters: list[Parameter]
    estimator: str = "fusion"
    """Default: the estimator of recordings without this entry."""


def _header(settings: RunSettings, task: TaskSpec, learn: str) -> Mapping[str, object]:
    from mimics_app.estimation.registry import DEFAULT

    return {
        "learn": learn,
        "goal": settings.goal or task.goal,
        "seed": settings.seed,
        "baseline_s": settings.baseline_s,
        "parameters": msgspec.to_builtins(list(build_learning_space(task))),
        "estimator": settings.estimator or task.estimator or DEFAULT,
    }


def _sources(settings: RunSettings, preset: str) -> tuple[SignalSource, ...]:
    """Return the source of the movement, and that of body signals where one was requested."""
    from mimics_app.inputs.stage import Movement

    if not settings.physio:
        return (Movement(),)
    from mimics_app.dsp.channel_kinds import check_rate
    from mimics_app.inputs.physio.sources import open_source

    address = f"sim:{preset}" if settings.physio == "sim" and preset else settings.physio
    source = open_source(address, settings.seed, check_rate)
    for note in source.notes:
        say(f"body signals: {note}")
    return (Movement(), source)
