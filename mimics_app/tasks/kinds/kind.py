"""Protocol of a kind of task: its additions to the task block of a scene file, and its behaviour in a session.

Manager, score, board and trial table use kinds through these two classes only. A kind is an entry point of the group
`mimics_app.task_kinds` (name: the kind's, object: an instance of `TaskKind`). All methods but `TaskKind.open` have
defaults, so a kind defines only what it has.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Protocol, TypeVar

from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.messages.board import Card
from mimics_app.contracts.messages.orders import Feature, HapticField, Numbers
from mimics_app.contracts.messages.report_section import ReportSection
from mimics_app.contracts.messages.stage_messages import SoundTrigger, TactileEvent
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.observation import Observation
from mimics_app.tasks.trial_specs import BlockSpec
from mimics_app.world.components.bounds import Factor, Figure
from mimics_app.world.components.registry import Component

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = [
    "Fault",
    "KindPlay",
    "Measure",
    "ObservationTable",
    "ScorePartSpec",
    "StepResult",
    "TaskBlock",
    "TaskKind",
    "Values",
]

Fault = tuple[str, str, str]
"""(JSON pointer, what is wrong, what to do)"""

S = TypeVar("S", bound=Component)

Values = Mapping[str, float | None]
"""Measures of one travel by the name of their column; None where one cannot be evaluated."""


class TaskBlock(Protocol):
    """What a kind asks of the task block of a scene; `tasks.task.TaskSpec` answers."""

    @property
    def goals(self) -> Sequence[Component]:
        """Goals of a trial."""
        ...

    @property
    def passive(self) -> bool:
        """True where the robot leads a person who need not act."""
        ...

    @property
    def trials(self) -> Sequence[BlockSpec] | str:
        """Blocks of trials, or the name of the file that holds them."""
        ...

    def section(self, kind: str) -> Component | None:
        """Return the section of a kind of task, None where the task has none."""
        ...

    def find(self, section: type[S]) -> S | None:
        """Return the section of a type, None where the task has none."""
        ...


class ScorePartSpec(Component, frozen=True):
    """Weight and limits of one measure: full marks at `best`, none at `worst`, linear between."""

    weight: Annotated[Factor, Meta(description="Share of the score, relative to the other weights.")]
    best: Annotated[Figure, Meta(description="Value that earns full marks, in the measure's unit.")]
    worst: Annotated[Figure, Meta(description="Value that earns none.")]


@dataclass(frozen=True, slots=True)
class StepResult:
    """Result of a step inside a trial.

    Attributes:
        reward: Reward by the task.
        observed: State after the step, by name.
    """

    reward: float
    observed: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Measure:
    """One number of a travel that counts in the score.

    Attributes:
        column: Name in the trial table, with the unit, e.g. "grasp_error_n".
        part: Name in the scene's `task.score`.
        what: Description with the unit, for the schema and the report.
        default: Weight and limits in the score unless the scene states them.
        total: Name among the session's totals, "" for none.
        sums: Whether the total is a sum over the trials; a mean otherwise.
    """

    column: str
    part: str
    what: str
    default: ScorePartSpec
    total: str = ""
    sums: bool = False

    @classmethod
    def totalled(
        cls, column: str, part: str, what: str, best: float, worst: float, *, weight: float = 0.0, sums: bool = False
    ) -> Measure:
        """Make a measure whose total has the name of its column."""
        return cls(column, part, what, ScorePartSpec(weight=weight, best=best, worst=worst), column, sums)


@dataclass(frozen=True, slots=True)
class ObservationTable:
    """A table of what a kind of task journals beside its trials: one row for each observation, for studies.

    Attributes:
        name: Name of its file, and of its section on the page of a study.
        columns: Its columns.
        rows: Return the rows of one run from the lines of its journal.
        summary: Return heads and rows of a summary by condition, from rows of all subjects.
    """

    name: str
    columns: tuple[str, ...]
    rows: Callable[[Sequence[Mapping[str, Any]]], list[dict[str, Any]]]
    summary: Callable[[Sequence[Mapping[str, Any]]], tuple[list[str], list[list[str]]]]


class KindPlay:
    """Behaviour of one kind of task during a session."""

    @property
    def orders(self) -> Mapping[HapticField, Numbers]:
        """Present numbers of the haptic scene of this kind; unchanged values cost nothing."""
        return {}

    @property
    def visual(self) -> Mapping[Feature[Any], object]:
        """Present values of the scenario's features; unchanged values cost nothing."""
        return {}

    def take_touches(self) -> tuple[TactileEvent, ...]:
        """Return the tactile events ordered since the last call."""
        return ()

    def take_sounds(self) -> tuple[SoundTrigger, ...]:
        """Return the events with a sound since the last call; the scene assigns the sound by kind and material."""
        return ()

    def take_obstacle(self) -> str:
        """Return the obstacle that the controller of the loop is to begin in this frame, by name; "" for none."""
        return ""

    def take_events(self) -> Sequence[tuple[str, Mapping[str, object]]]:
        """Return the lines for the journal since the last call: kind and data."""
        return ()

    @property
    def step(self) -> StepResult | None:
        """Result of a step that ended in this frame, for a learning system; read once, after `travel`."""
        return None

    @property
    def words(self) -> Mapping[str, str]:
        """Replacements of {NAME} in messages."""
        return {}

    @property
    def prompt(self) -> str:
        """Line of text on the next step, "" for none; may contain {NAME} of `words`."""
        return ""

    @property
    def lever(self) -> bool:
        """Whether the hand is a lever: its deflection from where the travel began counts, and not its place."""
        return False

    @property
    def led(self) -> bool:
        """Whether a gait orthosis leads the person, who then need not act: its belt walks with severe patients, too."""
        return False

    @property
    def asks(self) -> bool:
        """Whether `prompt` is a question that the person answers."""
        return False

    @property
    def measures(self) -> Values:
        """Measures of the travel so far: a value for each column of `TaskKind.measures`."""
        return {}

    def begin_trial(self, label: str, number: int) -> None:
        """Begin a trial of a condition; called before its first `begin_attempt`."""

    def begin_attempt(self) -> None:
        """Begin an attempt: the robot moves to the start."""

    def start_attempt(self, seen: Observation) -> None:
        """Begin the travel in this frame: the person may move the robot."""

    def see(self, seen: Observation, settings: Mapping[str, object]) -> Observation:
        """Take a frame and return it with `progress` and `distance` as defined by this kind.

        Args:
            seen: Observation from the loop.
            settings: Values of the task set by parameters, by name (see `TaskKind.targets`).
        """
        return seen

    def pause(self, paused_ns: int) -> None:
        """Take a frame of a pause: postpone deadlines by the time since the previous frame [ns]."""

    def travel(self, seen: Observation, seconds: float) -> None:
        """Take a frame of the travel with its duration [s]; called after `see`."""

    def way(self, goal: Component, seen: Observation) -> float:
        """Return the shortest way of the hand to a goal from where the travel begins [m]; 0 where there is none."""
        return 0.0

    def holds(self, goal: Component, seen: Observation) -> bool:
        """Whether a goal of this kind is met in this frame, its hold time aside."""
        raise TypeError(f"{type(self).__name__} has no goals")

    def happens(self, condition: Component, seen: Observation) -> bool:
        """Whether the condition of a trigger of this kind begins in this frame."""
        raise TypeError(f"{type(self).__name__} has no conditions")

    def outcome_words(self, row: Mapping[str, object], *, finished: bool) -> str:
        """Return in words how a travel ended, "" for the task's own words.

        Args:
            row: Measures by column of the trial table.
            finished: True: a sentence without its full stop, e.g. "Goal reached in 8.3 s"; False, when the time was
                over: what is missing, e.g. "80 % of the tunnel done".
        """
        return ""

    def cards(self, seen: Observation, finished: int) -> Mapping[str, Card]:
        """Cards for the board by name; `finished` trials have reached their goal."""
        return {}


class TaskKind(ABC):
    """A kind of task: its additions to the task block of a scene file.

    Attributes:
        name: Name of the entry point, and of the `section` in the task block.
        section: Struct of its settings under `task.NAME`, or None.
        goals: Structs with tag field "kind", for `task.goals`.
        conditions: The same for `task.triggers[].when`.
        measures: Measures beside those of every task.
        targets: Numbers of the task that a parameter may change, as `task.NAME`.
        completes: Name among the totals for the count of trials that reached their goal, "" for none.
        cards: Names of its cards, as `hud.show` of a scene lists them.
        scored: Whether its trials have a score where the scene states no weights; those of an experiment have none.
        journals: Kinds of the journal lines from `take_events`, which a replay compares.
        label: Caption of the progress card.
        contacts: Caption of the card that counts contacts.
        touches: Whether the hand can touch something, so that contacts are counted.
        implied: Whether it also takes scenes whose task does not name it; another kind of the same task then gives the
            captions and the report.
        report: Its section in the report of a run, or None.
        tables: Tables of what it journals beside its trials, for studies.
    """

    name: ClassVar[str]
    section: ClassVar[type[Component] | None] = None
    goals: ClassVar[tuple[type[Component], ...]] = ()
    conditions: ClassVar[tuple[type[Component], ...]] = ()
    measures: ClassVar[tuple[Measure, ...]] = ()
    targets: ClassVar[tuple[str, ...]] = ()
    completes: ClassVar[str] = ""
    cards: ClassVar[tuple[str, ...]] = ()
    scored: ClassVar[bool] = True
    journals: ClassVar[tuple[str, ...]] = ()
    label: ClassVar[str] = phrase("Progress")
    contacts: ClassVar[str] = phrase("Contacts")
    touches: ClassVar[bool] = True
    implied: ClassVar[bool] = False
    report: ClassVar[ReportSection | None] = None
    tables: ClassVar[tuple[ObservationTable, ...]] = ()

    def read_files(self, section: Component, folder: Path, root: Path) -> Component:
        """Return this kind's section with the contents of the files that it names.

        Args:
            section: The section as decoded from the scene.
            folder: Folder of the scene file.
            root: Folder that must contain the files.

        Raises:
            SceneError: With every fault of the files.
        """
        return section

    def takes(self, spec: TaskBlock, offers: frozenset[str]) -> bool:
        """Whether a task is (also) of this kind: by default where it has this kind's section or one of its goals.

        Args:
            spec: The task.
            offers: Features of the scene for tasks, e.g. "tunnel".
        """
        return spec.section(self.name) is not None or any(isinstance(goal, self.goals) for goal in spec.goals)

    def check(self, spec: TaskBlock, pointer: str) -> Iterator[Fault]:
        """Yield the faults of a task of this kind beyond its types; `pointer` is the task's. Called for every task.

        By default: a goal of this kind in a task without its section.
        """
        if self.section is not None and spec.section(self.name) is None:
            for i, goal in enumerate(spec.goals):
                if isinstance(goal, self.goals):
                    yield (
                        f"{pointer}/goals/{i}",
                        f"this goal needs {self.name} in the task",
                        f'write "{self.name}": {{...}}',
                    )

    def check_scene(self, spec: TaskBlock, scene: Scene) -> list[Issue]:
        """Return the faults of a task in its scene. Called for every task."""
        return []

    @abstractmethod
    def open(self, spec: TaskBlock, context: TaskContext, seed: int) -> KindPlay:
        """Begin a session.

        Args:
            spec: A task that this kind takes.
            context: Properties of the scene.
            seed: Seed of the session, for all random numbers.
        """
