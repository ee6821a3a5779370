"""Travelling a tunnel (D2.1 3.2.2): progress is a share of its arc length, error the distance from its bisector."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar

from msgspec import Meta, structs

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.contracts.system.phrases import phrase
from mimics_app.tasks.kinds.kind import KindPlay, TaskBlock, TaskKind
from mimics_app.tasks.kinds.tunnel.report import TunnelSection
from mimics_app.tasks.observation import Observation
from mimics_app.world.components.bounds import Seconds, Share
from mimics_app.world.components.registry import Component
from mimics_app.world.components.robot import Robot, Tunnel

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["KIND", "ProgressGoal", "TunnelTask", "has_tunnel", "own_tunnel"]


_PROMPT = phrase("Lead the ball through the tunnel to its end")
_UNDER_WAY = 0.1
"""Progress from which no prompt is shown [-]."""


class ProgressGoal(Component, frozen=True, tag="progress", tag_field="kind"):
    """Reach a share of the tunnel's length."""

    at_least: Annotated[Share, Meta(description="Share of the arc length, 0-1; exactly this counts.")] = 0.98
    hold_s: Annotated[Seconds, Meta(description="How long to stay there [s].")] = 0.0
    tunnel: Annotated[
        str | None, Meta(description="Entity of the tunnel, of several in a scene; absent: the first.")
    ] = None


class _TunnelPlay(KindPlay):
    def __init__(self, path_m: float) -> None:
        self._path_m = path_m
        self._progress = 0.0

    @property
    def prompt(self) -> str:
        return _PROMPT if self._progress < _UNDER_WAY else ""

    def see(self, seen: Observation, settings: Mapping[str, object]) -> Observation:
        snapshot = seen.snapshot
        self._progress = snapshot.progress
        return structs.replace(
            seen,
            progress=snapshot.progress,
            distance=snapshot.distance,
            progress_peak=snapshot.progress_peak,
            distance_peak=snapshot.distance_peak,
        )

    def outcome_words(self, row: Mapping[str, object], *, finished: bool) -> str:
        done = 100.0 * self._progress
        return "" if finished else phrase("{done:.0f} % of the tunnel done", done=done)

    def way(self, goal: Component, seen: Observation) -> float:
        return self._path_m * max(0.0, goal.at_least - seen.progress) if isinstance(goal, ProgressGoal) else 0.0

    def holds(self, goal: Component, seen: Observation) -> bool:
        return isinstance(goal, ProgressGoal) and seen.progress >= goal.at_least


class TunnelTask(TaskKind):
    """The built-in kind of scenes with a tunnel."""

    name = "tunnel"
    goals: ClassVar[tuple[type[Component], ...]] = (ProgressGoal,)
    label = phrase("Tunnel")
    contacts = phrase("Wall contacts")
    implied = True
    report = TunnelSection()

    def takes(self, spec: TaskBlock, offers: frozenset[str]) -> bool:
        return "tunnel" in offers or super().takes(spec, offers)

    def check_scene(self, spec: TaskBlock, scene: Scene) -> list[Issue]:
        """Check that progress goals name one existing tunnel."""
        named = {f"/task/goals/{i}/tunnel": goal.tunnel for i, goal in self._own_goals(spec)}
        known = [entity for entity, _, _ in scene.components(Tunnel)]
        issues = scene.check_names(named, "no tunnel is called", known)
        first = next(iter(named.values()), None)
        issues += [
            scene.issue(place, "a task has one tunnel of its own, and an earlier goal is of another", "name the same")
            for place, name in named.items()
            if name != first
        ]
        issues += self._check_leading(spec, scene)
        if not scene.components(Robot) or has_tunnel(scene):
            return issues
        written = "goals" in scene.task
        what = "the goal is a share of a tunnel's length, and the scene has no tunnel"
        places = (f"/task/goals/{i}" if written else "/task" for i, _ in self._own_goals(spec))
        return [scene.issue(place, what, "goals: duration, point") for place in places]

    def _check_leading(self, spec: TaskBlock, scene: Scene) -> list[Issue]:
        """Check that a tunnel that leads the hand all the time is of a passive task."""
        what = "leads every hand to the end, also one that does nothing"
        fix = 'make it a parameter of the task, which waits for the hand, or write "passive": true in the task'
        return [
            scene.issue(f"{pointer}/advance", what, fix)
            for _, tunnel, pointer in scene.components(Tunnel)
            if tunnel.advance > 0.0 and not spec.passive
        ]

    def _own_goals(self, spec: TaskBlock) -> Iterator[tuple[int, ProgressGoal]]:
        return ((i, goal) for i, goal in enumerate(spec.goals) if isinstance(goal, ProgressGoal))

    def open(self, spec: TaskBlock, context: TaskContext, seed: int) -> KindPlay:
        return _TunnelPlay(context.path_m)


def own_tunnel(scene: Scene) -> str:
    """Return the entity of the task's own tunnel: the one its goals name, else the first.

    Raises:
        SceneError: The scene has no tunnel.
    """
    task = scene.sections.get("task")
    goals = getattr(task, "goals", ())
    named = next((goal.tunnel for goal in goals if isinstance(goal, ProgressGoal) and goal.tunnel), None)
    return named or scene.one(Tunnel)[0]


def has_tunnel(scene: Scene) -> bool:
    """Whether there is a tunnel, valid or not: faults of a tunnel are reported at its own pointer."""
    return scene.has(Tunnel) or any(
        "tunnel" in entity.get("components", {}) for entity in scene.document.get("entities", ())
    )


KIND = TunnelTask()
