"""The parts that `explain` lists add up to the measured tick within 30 %, both timed in the same process."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

from mimics_app.app.planner.explain import TICK_GROUP, explain_plan
from mimics_app.app.planner.plan import plan_scene
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.touch.rehearsal import Rehearsal, rehearse
from mimics_app.contracts import ring
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.method_table import Row, Table
from mimics_app.contracts.resources import root
from mimics_app.lab.catalogue import load_methods

SCENES = ("wavy_tunnel", "pick_and_place", "examples/surfaces", "examples/free_objects")
GROUPS = (TICK_GROUP, "bounding geometry", "resting bodies")
"""Whose costs add up to a tick."""

TICKS = 1000
SETTLED = 15_000
"""Ticks after which the bodies of these scenes are at rest, as `explain` tells them."""

ROUNDS = 8
"""Parts and wholes by turns; of each the shortest stands: what else runs on the machine only adds."""

UNUSED = ("brute force", "golden section", "mesh of 1000", "mesh of 10000", "capsule")
"""Rows that no scene of these runs."""


@cache
def rehearsals() -> dict[str, Rehearsal]:
    return {name: rehearse(load_checked_scene(root() / "scenes" / f"{name}.json"), ticks=SETTLED) for name in SCENES}


def tick_us(rehearsal: Rehearsal) -> float:
    """Cost of a tick of the compiled loop [us]; nobody looks at the scene meanwhile."""
    clock = MonotonicClock()
    started = clock.now_ns()
    rehearsal.haptics.advance(TICKS)
    cost = (clock.now_ns() - started) * 1e-3 / TICKS
    ring.drain(rehearsal.memory.sample_words, rehearsal.memory.samples, rehearsal._rows)
    rehearsal.haptics.events()
    return cost


@cache
def measured() -> tuple[Table, dict[str, float]]:
    """(the shipped table with this process's costs of the parts of a tick, cost of a tick by scene [us])."""
    registry, shipped = load_methods(GROUPS), Table.load_shipped()
    parts, wholes = dict[tuple[str, str], float](), dict[str, float]()
    for _ in range(ROUNDS):
        for name, rehearsal in rehearsals().items():
            wholes[name] = min(tick_us(rehearsal), wholes.get(name, float("inf")))
        for group in GROUPS:
            for method in registry.rivals(group):
                if method.name not in UNUSED:
                    key = (group, method.name)
                    parts[key] = min(method.cost(), parts.get(key, float("inf")))

    def here(group: str, row: Row) -> Row:
        return replace(row, cost_us=parts.get((group, row.method), row.cost_us))

    groups = {group: [here(group, row) for row in rows] for group, rows in shipped.groups.items()}
    return replace(shipped, groups=groups), wholes


@pytest.mark.parametrize("name", SCENES)
def test_the_parts_add_up_to_the_measured_tick(name: str):
    table, wholes = measured()
    scene = load_checked_scene(root() / "scenes" / f"{name}.json")
    parts = explain_plan(scene, plan_scene(scene, "training", table))["parts"]
    told = [part["tick_us"] for part in parts if part["tick_us"] is not None]
    assert sum(told) / wholes[name] == pytest.approx(1.0, rel=0.3), (told, wholes[name])


@pytest.mark.parametrize(("name", "more"), [(SCENES[1], 2), (SCENES[2], 1), (SCENES[3], 2)])
def test_what_objects_cost_is_a_part_of_the_sum(name: str, more: int):
    """Touching where something can be touched, and bodies where some can move."""
    scene = load_checked_scene(root() / "scenes" / f"{name}.json")
    parts = explain_plan(scene, plan_scene(scene, "training", Table.load_shipped()))["parts"]
    groups = {part["group"] for part in parts if part["tick_us"] is not None}
    assert groups == set(GROUPS[: 1 + more])
