"""The `task` block of a scene file: one Struct per JSON object, units in the docstrings (they become the schema)."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, field

from mimics_app.tasks.carry_spec import CarrySpec
from mimics_app.world.components.bounds import (
    Factor,
    Figure,
    Force,
    Length,
    Point,
    PositiveSeconds,
    Seconds,
)
from mimics_app.world.components.registry import Component

__all__ = [
    "ActionDeed",
    "BlockSpec",
    "CarryCondition",
    "ContactCondition",
    "Deed",
    "DurationGoal",
    "EnterCondition",
    "ExitCondition",
    "GoalSpec",
    "KeyCondition",
    "MapSpec",
    "MessageDeed",
    "Order",
    "ParameterSpec",
    "PlacedGoal",
    "PointGoal",
    "ProgressCondition",
    "ProgressGoal",
    "ScorePartSpec",
    "ScoreSpec",
    "SoundDeed",
    "StartSpec",
    "StateName",
    "TaskSpec",
    "TrialSpec",
    "TriggerCondition",
    "TriggerSpec",
    "Vec3",
]

Steps = Annotated[float, Meta(ge=0.0, le=1e12)]
"""A difference of a parameter, in a unit that the file chooses."""
Tolerance = Annotated[float, Meta(gt=0.0, le=100.0)]
Values = Annotated[dict[str, Figure], Meta(max_length=1000)]
Table = Annotated[list[Figure | str], Meta(max_length=10_000)]
Share = Annotated[float, Meta(ge=0.0, le=1.0)]
Vec3 = Point
Order = Literal["listed", "shuffled", "latin"]
StateName = Literal["approach", "ready", "travel", "finished", "timeout", "aborted", "stopped", "rest", "done"]


class MapSpec(Component, frozen=True):
    """Where the value of a parameter goes: offset + scale * value, or an entry of a table."""

    to: Annotated[
        str,
        Meta(
            description="Dotted name: 'haptic.FIELD' or 'haptic.tunnel.FIELD' is a number of the haptic scene; "
            "'visual.NAME' and 'audio.NAME' are parameters of the scenario and the mixer; 'task.time_limit_s', "
            "'task.rest_s' and 'task.within' (of `carry`) change the task itself."
        ),
    ]
    scale: Annotated[Figure, Meta(description="Target units per unit of the parameter.")] = 1.0
    offset: Annotated[Figure, Meta(description="Target units.")] = 0.0
    table: Annotated[
        Table | None,
        Meta(
            description="One entry per step from min to max. Numbers are interpolated, words taken at the nearest step."
        ),
    ] = None


class ParameterSpec(Component, frozen=True):
    """One adaptable parameter of the task; all numbers in `unit`."""

    min: Annotated[Figure, Meta(description="Smallest value.")]
    max: Annotated[Figure, Meta(description="Largest value.")]
    maps: Annotated[list[MapSpec], Meta(max_length=1000, description="What it changes.")]
    default: Annotated[
        Figure | None,
        Meta(description="Value at the session's start; absent: what the scene says of the haptic field it maps to."),
    ] = None
    step: Annotated[Steps, Meta(description="Grid on which values lie, counted from min; 0: any value.")] = 0.0
    rate: Annotated[
        Steps,
        Meta(description="Largest change per second [unit/s] inside a trial; 0: changes only between trials."),
    ] = 0.0
    unit: Annotated[str, Meta(description="Unit of the value; '-' for none.")] = "-"


class ProgressGoal(Component, frozen=True, tag="progress", tag_field="kind"):
    """Reach a share of the tunnel's length."""

    at_least: Annotated[Share, Meta(description="Share of the arc length, 0-1; exactly this counts.")] = 0.98
    hold_s: Annotated[Seconds, Meta(description="How long to stay there [s].")] = 0.0


class PointGoal(Component, frozen=True, tag="point", tag_field="kind"):
    """Bring the ball to a point."""

    position_world: Annotated[Point, Meta(description="Where [m].")]
    within: Annotated[
        Length, Meta(description="Largest distance of the ball's centre from it [m]; exactly this counts.")
    ]
    hold_s: Annotated[Seconds, Meta(description="How long to stay there [s].")] = 0.0


class DurationGoal(Component, frozen=True, tag="duration", tag_field="kind"):
    """Keep going for a time."""

    seconds: Annotated[Seconds, Meta(description="Since the person was let go [s].")]


class PlacedGoal(Component, frozen=True, tag="placed", tag_field="kind"):
    """Set down what `carry` names at its mark, and let it go."""

    hold_s: Annotated[Seconds, Meta(description="How long it must lie there [s].")] = 0.5


GoalSpec = ProgressGoal | PointGoal | DurationGoal | PlacedGoal


class EnterCondition(Component, frozen=True, tag="enter", tag_field="kind"):
    """A state begins."""

    state: Annotated[StateName, Meta(description="Which one.")]


class ExitCondition(Component, frozen=True, tag="exit", tag_field="kind"):
    """A state ends."""

    state: Annotated[StateName, Meta(description="Which one.")]


class ProgressCondition(Component, frozen=True, tag="progress", tag_field="kind"):
    """The ball comes this far, once per trial."""

    at_least: Annotated[Share, Meta(description="Share of the tunnel's arc length, 0-1.")]


class ContactCondition(Component, frozen=True, tag="contact", tag_field="kind"):
    """The ball touches something during travel."""

    min_force: Annotated[Force, Meta(description="Weaker contacts do not count [N].")] = 0.0


class CarryCondition(Component, frozen=True, tag="carry", tag_field="kind"):
    """Something happens to what is carried."""

    what: Annotated[
        Literal["gripped", "dropped", "bruised"],
        Meta(description="It came into the hand, was lost on the way, or was pressed too hard."),
    ]


class KeyCondition(Component, frozen=True, tag="key", tag_field="kind"):
    """A key or button goes down."""

    key: Annotated[str, Meta(description="Its name e.g. 'm', 'mouse_left' or 'pad_y'.")]


TriggerCondition = EnterCondition | ExitCondition | ProgressCondition | ContactCondition | CarryCondition | KeyCondition


class SoundDeed(Component, frozen=True, tag="sound", tag_field="kind"):
    """Play a sound."""

    sound: Annotated[str, Meta(description="Name of a sound of the scene.")]
    gain: Annotated[Factor, Meta(description="Linear, 1 = as authored.")] = 1.0
    at_ball: Annotated[bool, Meta(description="True: where the ball is; False: at the listener.")] = False


class MessageDeed(Component, frozen=True, tag="message", tag_field="kind"):
    """Show a line of text."""

    text: Annotated[str, Meta(description="What to show.")]
    seconds: Annotated[Seconds, Meta(description="For how long [s].")] = 2.0


class ActionDeed(Component, frozen=True, tag="action", tag_field="kind"):
    """Adapt the task, as a learning policy would."""

    values: Annotated[Values, Meta(description="New values by parameter name, each in that parameter's unit.")]


Deed = SoundDeed | MessageDeed | ActionDeed


class TriggerSpec(Component, frozen=True):
    """When something happens, do something."""

    when: Annotated[TriggerCondition, Meta(description="The condition.")]
    do: Annotated[list[Deed], Meta(max_length=100, description="What to do, in order.")]


class TrialSpec(Component, frozen=True):
    """One trial of a block."""

    label: Annotated[str, Meta(description="Name of the condition, for the results.")] = ""
    values: Annotated[
        Values,
        Meta(
            description="Parameter values set before the trial; others have their default, or what an action gave them."
        ),
    ] = field(default_factory=dict)
    time_limit_s: Annotated[PositiveSeconds | None, Meta(description="Instead of the task's [s].")] = None
    rest_s: Annotated[Seconds | None, Meta(description="Rest after this trial, instead of the task's [s].")] = None


class BlockSpec(Component, frozen=True):
    """Trials that belong together."""

    name: Annotated[str, Meta(description="For the results.")] = ""
    trials: Annotated[
        Annotated[list[TrialSpec], Meta(min_length=1, max_length=1000)], Meta(description="The conditions.")
    ] = field(default_factory=lambda: [TrialSpec()])
    repetitions: Annotated[Annotated[int, Meta(ge=1, le=1000)], Meta(description="How often all of them are done.")] = 1
    order: Annotated[
        Order,
        Meta(
            description="'listed', 'shuffled' (each repetition anew, from the session's seed) or 'latin' (repetition r "
            "takes row r of a Williams square: every condition follows every other equally often)."
        ),
    ] = "listed"
    practice: Annotated[bool, Meta(description="True: recorded and shown, but left out of the session's score.")] = (
        False
    )


class StartSpec(Component, frozen=True):
    """How the robot is brought to the start of a trial."""

    tolerance: Annotated[
        tuple[Tolerance, Tolerance, Tolerance],
        Meta(description="Largest joint error that counts as arrived [m, rad, m]."),
    ] = (0.005, 0.02, 0.005)
    hold_s: Annotated[Seconds, Meta(description="How long it must stay so [s].")] = 0.2
    ready_s: Annotated[
        Seconds, Meta(description="Shortest time between arrival and go [s]; the soft start must be over too.")
    ] = 1.0
    limit_s: Annotated[
        PositiveSeconds,
        Meta(description="Longest way to the start, and longest soft start [s]; then the attempt is aborted."),
    ] = 20.0
    attempts: Annotated[
        Annotated[int, Meta(ge=1, le=1000)],
        Meta(description="How often one trial may be begun; then the next one follows."),
    ] = 5


class ScorePartSpec(Component, frozen=True):
    """How one measure counts: full marks at `best`, none at `worst`, linear between."""

    weight: Annotated[Factor, Meta(description="Share of the score, relative to the other weights.")]
    best: Annotated[Figure, Meta(description="Value that earns full marks, in the measure's unit.")]
    worst: Annotated[Figure, Meta(description="Value that earns none.")]


class ScoreSpec(Component, frozen=True):
    """Weights of the score 0-100; see tasks.score for the formula."""

    time: Annotated[ScorePartSpec, Meta(description="Duration of the travel [s].")] = ScorePartSpec(
        weight=0.3, best=8.0, worst=40.0
    )
    path_error: Annotated[ScorePartSpec, Meta(description="Root mean square distance from the bisector [m].")] = (
        ScorePartSpec(weight=0.3, best=0.002, worst=0.020)
    )
    contacts: Annotated[ScorePartSpec, Meta(description="Number of wall contacts.")] = ScorePartSpec(
        weight=0.25, best=0.0, worst=20.0
    )
    smoothness: Annotated[
        ScorePartSpec,
        Meta(description="Spectral arc length of the speed (SPARC), negative; -1.4 is one minimum-jerk reach."),
    ] = ScorePartSpec(weight=0.15, best=-1.6, worst=-12.0)
    path: Annotated[ScorePartSpec, Meta(description="Length of the hand's way [m].")] = ScorePartSpec(
        weight=0.0, best=0.5, worst=3.0
    )
    drops: Annotated[ScorePartSpec, Meta(description="How often what is carried was lost.")] = ScorePartSpec(
        weight=0.0, best=0.0, worst=4.0
    )
    bruises: Annotated[ScorePartSpec, Meta(description="How often what is carried was pressed too hard.")] = (
        ScorePartSpec(weight=0.0, best=0.0, worst=3.0)
    )
    grasp_error: Annotated[
        ScorePartSpec, Meta(description="Root mean square distance of the grasp force from what is right [N].")
    ] = ScorePartSpec(weight=0.0, best=0.0, worst=8.0)


class TaskSpec(Component, frozen=True):
    """What the person is to do, how often, and how it is scored."""

    title: Annotated[str, Meta(description="Shown to the person.")] = ""
    parameters: Annotated[dict[str, ParameterSpec], Meta(description="What can be adapted, by name.")] = field(
        default_factory=dict
    )
    goals: Annotated[
        Annotated[list[GoalSpec], Meta(min_length=1, max_length=100)],
        Meta(description="All must be met at once to finish a trial."),
    ] = field(default_factory=lambda: [ProgressGoal()])
    carry: Annotated[CarrySpec | None, Meta(description="What is carried where; absent: nothing is.")] = None
    triggers: Annotated[
        list[TriggerSpec], Meta(max_length=1000, description="Sounds, messages and adaptations at given moments.")
    ] = field(default_factory=list)
    trials: Annotated[
        Annotated[list[BlockSpec], Meta(min_length=1, max_length=1000)] | str,
        Meta(description="The blocks in order, or the name of a JSON file beside the scene that holds them."),
    ] = field(default_factory=lambda: [BlockSpec()])
    start: Annotated[StartSpec, Meta(description="How a trial is begun.")] = StartSpec()
    score: Annotated[ScoreSpec, Meta(description="Weights of the score.")] = ScoreSpec()
    time_limit_s: Annotated[PositiveSeconds, Meta(description="Longest travel [s].")] = 60.0
    rest_s: Annotated[Seconds, Meta(description="Pause between trials [s].")] = 3.0
    result_s: Annotated[Seconds, Meta(description="How long a result is shown [s].")] = 2.0
    messages: Annotated[
        dict[StateName, str], Meta(description="Text shown in a state, instead of the built-in one; '' shows nothing.")
    ] = field(default_factory=dict)
