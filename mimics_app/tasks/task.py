"""The `task` block of a scene file: one Struct per JSON object, units in the docstrings (they become the schema).

On import, goals, conditions, score parts and sections of the kinds of task (`tasks.kinds`) are added to the structs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, Union

from msgspec import Meta, defstruct, field

from mimics_app.tasks.kinds.kind import Measure, ScorePartSpec
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.kinds.tunnel.kind import ProgressGoal
from mimics_app.tasks.trial_specs import BlockSpec
from mimics_app.world.components.bounds import Factor, Figure, Force, Length, Point, PositiveSeconds, Seconds, Share
from mimics_app.world.components.registry import Component
from mimics_app.world.files.reading.json_text import escape

__all__ = [
    "MEASURES",
    "ActionDeed",
    "ActionKind",
    "ContactCondition",
    "Deed",
    "DeviceTask",
    "DurationGoal",
    "EnterCondition",
    "ExitCondition",
    "FittingSpec",
    "GoalSpec",
    "KeyCondition",
    "MapSpec",
    "MessageDeed",
    "ParameterSpec",
    "PointGoal",
    "ProgressCondition",
    "ScorePartSpec",
    "ScoreSpec",
    "SoundDeed",
    "StartSpec",
    "StateName",
    "TaskSpec",
    "TriggerCondition",
    "TriggerSpec",
]


_Tolerance = Annotated[float, Meta(gt=0.0, le=100.0)]


class StartSpec(Component, frozen=True):
    """Approach of the robot to the start of a trial."""

    tolerance: Annotated[
        Annotated[tuple[_Tolerance, ...], Meta(min_length=1, max_length=8)],
        Meta(description="Largest joint error at the start pose [m or rad]; the last one also for all further joints."),
    ] = (0.005, 0.02, 0.005)
    hold_s: Annotated[Seconds, Meta(description="Time for which the errors must stay below [s].")] = 0.2
    ready_s: Annotated[
        Seconds, Meta(description="Shortest time between arrival and go [s], in which the robot holds the start.")
    ] = 1.0
    announce_s: Annotated[
        Seconds,
        Meta(description="Time for which the drive to the start is announced before it begins, after no rest [s]."),
    ] = 1.0
    countdown_s: Annotated[
        Seconds,
        Meta(
            description="Countdown before the first trial of a session in a window, after the page of keys [s]; "
            "0: none."
        ),
    ] = 3.0
    limit_s: Annotated[
        PositiveSeconds,
        Meta(description="Longest approach, and longest wait for the go [s]; then the attempt is aborted."),
    ] = 20.0
    attempts: Annotated[
        Annotated[int, Meta(ge=1, le=1000)],
        Meta(description="Largest number of attempts at one trial; then the next trial follows."),
    ] = 5


_Steps = Annotated[float, Meta(ge=0.0, le=1e12)]
_Values = Annotated[dict[str, Figure], Meta(max_length=1000)]
_Table = Annotated[list[Figure | str], Meta(max_length=10_000)]

ActionKind = Literal["avatar", "complexity", "appearance", "flow", "sound", "difficulty", "duration"]
StateName = Literal["approach", "ready", "travel", "finished", "timeout", "aborted", "stopped", "rest", "done"]


class MapSpec(Component, frozen=True):
    """Target of a parameter's value: offset + scale * value, or an entry of a table."""

    to: Annotated[
        str,
        Meta(
            description="Dotted name: 'haptic.FIELD' is a number of the haptic scene, 'haptic.tunnel.FIELD' of the "
            "task's own tunnel, 'haptic.tunnels.ENTITY.FIELD' of any; "
            "'visual.NAME' and 'audio.NAME' are parameters of the scenario and the mixer; 'task.time_limit_s', "
            "'task.rest_s', 'task.block' (block of the next trial, counted from 1; 0: as listed) and 'task.within' "
            "(of `carry`) change the task itself."
        ),
    ]
    scale: Annotated[Figure, Meta(description="Target units per unit of the parameter.")] = 1.0
    offset: Annotated[Figure, Meta(description="Target units.")] = 0.0
    table: Annotated[
        _Table | None,
        Meta(description="One entry per step from min to max. Numbers are interpolated; of words the nearest is used."),
    ] = None


class ParameterSpec(Component, frozen=True):
    """One adaptable parameter of the task; all its numbers have the unit `unit`."""

    min: Annotated[Figure, Meta(description="Smallest value.")]
    max: Annotated[Figure, Meta(description="Largest value.")]
    maps: Annotated[list[MapSpec], Meta(max_length=1000, description="Targets of the value.")]
    default: Annotated[
        Figure | None,
        Meta(description="Initial value; absent: the scene's value of the haptic field that it maps to."),
    ] = None
    step: Annotated[_Steps, Meta(description="Step between allowed values, counted from min; 0: any value.")] = 0.0
    rate: Annotated[
        _Steps,
        Meta(description="Largest change per second [unit/s] inside a trial; 0: changes only between trials."),
    ] = 0.0
    unit: Annotated[str, Meta(description="Unit of the value; '-' for none.")] = "-"
    kind: Annotated[ActionKind, Meta(description="Kind of action that it is for a learning system.")] = "difficulty"
    harder: Annotated[
        Literal[-1, 0, 1],
        Meta(description="1: larger values make the task harder; -1: smaller ones do; 0: neither."),
    ] = 0
    cost: Annotated[
        Factor,
        Meta(description="What a learning system pays of each reward for a value a whole range off the default."),
    ] = 0.0
    dwell_s: Annotated[Seconds, Meta(description="Shortest time between two changes by a learning system [s].")] = 0.0
    veto: Annotated[bool, Meta(description="True: no learning system may change it.")] = False


class PointGoal(Component, frozen=True, tag="point", tag_field="kind"):
    """Bring the ball to a point."""

    position_world: Annotated[Point, Meta(description="Position of the point [m].")]
    within: Annotated[Length, Meta(description="Largest distance of the ball's centre from it [m], inclusive.")]
    hold_s: Annotated[Seconds, Meta(description="Hold time [s].")] = 0.0


class DurationGoal(Component, frozen=True, tag="duration", tag_field="kind"):
    """Travel for a given time."""

    seconds: Annotated[Seconds, Meta(description="Duration since the start of the travel [s].")]


if TYPE_CHECKING:
    GoalSpec = Component
else:
    GoalSpec = Union[(PointGoal, DurationGoal, *(goal for kind in task_kinds() for goal in kind.goals))]
    """A goal common to all tasks, or of a kind."""


class EnterCondition(Component, frozen=True, tag="enter", tag_field="kind"):
    """A state begins."""

    state: Annotated[StateName, Meta(description="Name of the state.")]


class ExitCondition(Component, frozen=True, tag="exit", tag_field="kind"):
    """A state ends."""

    state: Annotated[StateName, Meta(description="Name of the state.")]


class ProgressCondition(Component, frozen=True, tag="progress", tag_field="kind"):
    """The progress of the trial reaches a share; occurs once per trial."""

    at_least: Annotated[Share, Meta(description="Share of the path, 0-1: of a tunnel, its arc length.")]


class ContactCondition(Component, frozen=True, tag="contact", tag_field="kind"):
    """A contact begins during the travel."""

    min_force: Annotated[Force, Meta(description="Smallest contact force that counts [N].")] = 0.0


class KeyCondition(Component, frozen=True, tag="key", tag_field="kind"):
    """A key or button is pressed."""

    key: Annotated[str, Meta(description="Its name, e.g. 'm', 'mouse_left' or 'pad_y'.")]


_OWN_CONDITIONS = (EnterCondition, ExitCondition, ProgressCondition, ContactCondition, KeyCondition)

if TYPE_CHECKING:
    TriggerCondition = Component
else:
    TriggerCondition = Union[(*_OWN_CONDITIONS, *(c for kind in task_kinds() for c in kind.conditions))]
    """A condition common to all tasks, or of a kind."""


class SoundDeed(Component, frozen=True, tag="sound", tag_field="kind"):
    """Play a sound."""

    sound: Annotated[str, Meta(description="Name of a sound of the scene.")]
    gain: Annotated[Factor, Meta(description="Linear, 1 = as authored.")] = 1.0
    at_ball: Annotated[bool, Meta(description="True: at the position of the ball; False: at the listener.")] = False


class MessageDeed(Component, frozen=True, tag="message", tag_field="kind"):
    """Show a line of text."""

    text: Annotated[str, Meta(description="The text.")]
    seconds: Annotated[Seconds, Meta(description="Duration [s].")] = 2.0


class ActionDeed(Component, frozen=True, tag="action", tag_field="kind"):
    """Adapt the task, as a learning policy would."""

    values: Annotated[_Values, Meta(description="New values by parameter name, each in that parameter's unit.")]


Deed = SoundDeed | MessageDeed | ActionDeed


class FittingSpec(Component, frozen=True):
    """What is scaled to a person's range of motion, about the middle of the robot's workspace."""

    entities: Annotated[
        tuple[str, ...],
        Meta(max_length=1000, description="Entities without a parent: their place, and curves of theirs."),
    ] = ()


class TriggerSpec(Component, frozen=True):
    """A condition, and the actions carried out when it occurs."""

    when: Annotated[TriggerCondition, Meta(description="The condition.")]
    do: Annotated[list[Deed], Meta(max_length=100, description="Actions in order.")]


_OWN_MEASURES = (
    Measure.totalled("time_s", "time", "Duration of the travel [s].", 8.0, 40.0, weight=0.3),
    Measure(
        "path_error_rms_m",
        "path_error",
        "Root mean square distance from the task's path [m]; a task without a path has no such measure.",
        ScorePartSpec(weight=0.3, best=0.002, worst=0.020),
        total="path_error_m",
    ),
    Measure.totalled("contacts", "contacts", "Number of contacts.", 0.0, 20.0, weight=0.25, sums=True),
    Measure("contact_time_s", "contact_time", "Time in contact [s].", ScorePartSpec(weight=0.0, best=0.0, worst=20.0)),
    Measure(
        "smoothness",
        "smoothness",
        "Spectral arc length of the speed (SPARC), negative; -1.4 is one minimum-jerk reach.",
        ScorePartSpec(weight=0.15, best=-1.6, worst=-12.0),
    ),
    Measure.totalled("path_m", "path", "Length of the path of the hand [m].", 0.5, 3.0),
)

MEASURES = (*_OWN_MEASURES, *(measure for kind in task_kinds() for measure in kind.measures))
"""Measures that may count in a score, the task's own and those of its kinds, in the order of the trial table."""


class _ScoreBase(Component, frozen=True):
    """Weights of the score 0-100; see tasks.score for the formula."""

    def part(self, name: str) -> ScorePartSpec:
        """Return weight and limits of a part."""
        part: ScorePartSpec = getattr(self, name)
        return part


def _with_fields(name: str, base: type[Component], fields: Sequence[tuple[str, object, object]]) -> type[Any]:
    """Return a Struct that has the fields of a base and those that the kinds of task bring."""
    return defstruct(
        name,
        fields,
        bases=(base,),
        namespace={"__doc__": base.__doc__},
        module=__name__,
        frozen=True,
        kw_only=True,
        forbid_unknown_fields=True,
    )


def _score_fields() -> list[tuple[str, Any, ScorePartSpec]]:
    return [(m.part, Annotated[ScorePartSpec, Meta(description=m.what)], m.default) for m in MEASURES]


if TYPE_CHECKING:
    ScoreSpec = _ScoreBase
else:
    ScoreSpec = _with_fields("ScoreSpec", _ScoreBase, _score_fields())


class DeviceTask(Component, frozen=True):
    """What of a task is other with a device."""

    instructions: Annotated[str, Meta(description="As of the task; '': those of the task.")] = ""
    score: Annotated[ScoreSpec | None, Meta(description="As of the task; null: that of the task.")] = None
    parameters: Annotated[
        dict[str, ParameterSpec], Meta(description="Adaptable parameters beside, or instead of, those of the task.")
    ] = field(default_factory=dict)


S = TypeVar("S", bound=Component)


class _TaskBase(Component, frozen=True):
    """The task of the person: goals, trials, adaptation and score."""

    title: Annotated[str, Meta(description="Shown to the person.")] = ""
    parameters: Annotated[dict[str, ParameterSpec], Meta(description="Adaptable parameters, by name.")] = field(
        default_factory=dict
    )
    goals: Annotated[
        Annotated[list[GoalSpec], Meta(min_length=1, max_length=100)],
        Meta(description="All must be met at once to finish a trial."),
    ] = field(default_factory=lambda: [ProgressGoal()])
    triggers: Annotated[
        list[TriggerSpec], Meta(max_length=1000, description="Sounds, messages and adaptations at given moments.")
    ] = field(default_factory=list)
    trials: Annotated[
        Annotated[list[BlockSpec], Meta(min_length=1, max_length=1000)] | str,
        Meta(description="The blocks in order, or the name of a JSON file beside the scene that holds them."),
    ] = field(default_factory=lambda: [BlockSpec()])
    start: Annotated[StartSpec, Meta(description="Start of a trial.")] = StartSpec()
    passive: Annotated[
        bool, Meta(description="True: a trial may end well though the hand did nothing, as where the person watches.")
    ] = False
    score: Annotated[ScoreSpec, Meta(description="Weights of the score.")] = ScoreSpec()
    time_limit_s: Annotated[PositiveSeconds, Meta(description="Longest travel [s].")] = 60.0
    rest_s: Annotated[Seconds, Meta(description="Pause between trials [s].")] = 3.0
    result_s: Annotated[Seconds, Meta(description="Duration for which a result is shown [s].")] = 2.0
    instructions: Annotated[
        str,
        Meta(
            description="What the person is to do, in one to three short sentences, shown before the first trial and "
            "with H; '': the scene's description."
        ),
    ] = ""
    devices: Annotated[
        dict[str, DeviceTask],
        Meta(description="What is other for who plays with a device of the scene's section devices, by its name."),
    ] = field(default_factory=dict)
    fitting: Annotated[
        FittingSpec | None,
        Meta(
            description="What is scaled to a person's range of motion; absent: nothing, as where all is at its place."
        ),
    ] = None
    prompt: Annotated[
        str, Meta(description="Line shown during a trial while its kind of task has nothing to say; '': none.")
    ] = ""
    messages: Annotated[
        dict[StateName, str], Meta(description="Text shown in a state, instead of the built-in one; '' shows nothing.")
    ] = field(default_factory=dict)

    learn: Annotated[str, Meta(description="Policy that adapts the task unless a run names one; '': none.")] = ""
    goal: Annotated[
        str, Meta(description="Goal of the policy: 'task', 'success:SHARE', 'arousal:LOW:HIGH' and the like.")
    ] = "success:0.7"
    estimator: Annotated[
        str,
        Meta(
            description="Estimator of the person's load unless a run names it: fusion, lda, adaptive_lda; '': the best."
        ),
    ] = ""

    def placed_parameters(self, pointer: str = "/task") -> Iterator[tuple[str, ParameterSpec]]:
        """Yield all adaptable parameters, also those of devices, with their pointers below that of the task."""
        for name, parameter in self.parameters.items():
            yield f"{pointer}/parameters/{escape(name)}", parameter
        for device, other in self.devices.items():
            for name, parameter in other.parameters.items():
                yield f"{pointer}/devices/{escape(device)}/parameters/{escape(name)}", parameter

    def section(self, kind: str) -> Component | None:
        """Return the section of a kind of task by its name, or None where the task has none."""
        section: Component | None = getattr(self, kind, None)
        return section

    def find(self, section: type[S]) -> S | None:
        """Return the section of a type, or None where the task has none."""
        parts = (getattr(self, name) for name in self.__struct_fields__)
        return next((part for part in parts if isinstance(part, section)), None)


def _section_fields() -> list[tuple[str, object, None]]:
    return [(kind.name, _optional(kind.section), None) for kind in task_kinds() if kind.section is not None]


def _optional(section: type[Component]) -> object:
    return Annotated[section | None, Meta(description=f"{section.__doc__} Absent: none.")]


if TYPE_CHECKING:
    TaskSpec = _TaskBase
else:
    TaskSpec = _with_fields("TaskSpec", _TaskBase, _section_fields())
