"""Reach to targets: bring the hand to some entities in turn. A kind of task of its own, with board and report."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated

import numpy as np
from msgspec import Meta, structs

from mimics_app.contracts.messages.board import Card
from mimics_app.contracts.messages.report_section import Marks, ReportSection, frontal
from mimics_app.tasks.cards import count_card
from mimics_app.tasks.kinds.kind import KindPlay, Measure, TaskKind
from mimics_app.world.components.registry import Component


class ReachSpec(Component, frozen=True):
    """Touch targets in the air, one after the other."""

    targets: Annotated[list[str], Meta(min_length=1, max_length=100, description="Ids of the entities, in order")]
    within: Annotated[float, Meta(gt=0.0, le=1.0, description="This near counts as touched [m]")] = 0.02


class AllReached(Component, frozen=True, tag="all_reached", tag_field="kind"):
    """Every target was touched."""

    hold_s: Annotated[float, Meta(ge=0.0, le=60.0, description="How long ago, at least [s]")] = 0.0


class ReachPlay(KindPlay):
    def __init__(self, spec, places):
        self.spec, self.places = spec, [places[name] for name in spec.targets]
        self.begin_attempt()

    def begin_attempt(self):
        self.reached, self.extra, self.before = 0, 0.0, None

    @property
    def words(self) -> Mapping[str, str]:
        return {"target": self.spec.targets[min(self.reached, len(self.places) - 1)]}

    @property
    def prompt(self) -> str:
        return "Go to the {target}" if self.reached < len(self.places) else ""

    @property
    def measures(self):
        return {"reached": self.reached, "detour_m": self.extra}

    def see(self, seen, settings):
        if self.reached < len(self.places) and math.dist(seen.hip_world, self.places[self.reached]) <= self.spec.within:
            self.reached, self.before = self.reached + 1, None
        return structs.replace(seen, progress=self.reached / len(self.places))

    def travel(self, seen, seconds):
        """Sum up how much longer the path is than the straight lines between the targets."""
        if self.reached < len(self.places):
            gap = math.dist(seen.hip_world, self.places[self.reached])
            if self.before is not None:
                self.extra += math.dist(seen.hip_world, self.before[0]) - (self.before[1] - gap)
            self.before = seen.hip_world, gap

    def holds(self, goal, seen):
        return self.reached == len(self.places)

    def cards(self, seen, finished) -> Mapping[str, Card]:
        return {"targets": count_card(f"Targets of {len(self.places)}", self.reached)}


class ReachSection(ReportSection):
    """Where the hand was, with its turning points."""

    heading = "Reaching"
    colours = "The path of the hand is blue; it is marked where it was slowest."

    def takes(self, facts, attempts):
        return any("reached" in attempt.row for attempt in attempts)

    def tiles(self, task):
        return {"targets reached": (task.get("reached"), ""), "detour": (task.get("detour_m"), "m")}

    def marks(self, attempt, facts):
        speed = np.where(attempt.free, np.linalg.norm(attempt.samples["v_world"], axis=1), np.inf)
        slowest = np.argsort(speed)[:1]
        return [Marks(frontal(attempt)[slowest], "slowest", [f"{speed[i]:.3f} m/s" for i in slowest])]


class ReachKind(TaskKind):
    name, section, goals, cards, label = "reach", ReachSpec, (AllReached,), ("targets",), "Targets"
    measures = (
        Measure.totalled("reached", "reached", "Targets touched.", 9, 0, sums=True),
        Measure.totalled("detour_m", "detour", "Path beyond the lines [m].", 0, 1),
    )
    report = ReachSection()

    def check_scene(self, spec, scene):
        section = spec.find(ReachSpec)
        named = enumerate(section.targets if section else ())
        return [issue for i, name in named for issue in scene.check_entity(f"/task/reach/targets/{i}", name)]

    def open(self, spec, context, seed):
        return ReachPlay(spec.find(ReachSpec), context.places)


KIND = ReachKind()
