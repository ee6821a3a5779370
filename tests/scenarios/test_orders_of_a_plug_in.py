"""What a scenario or a plug-in may order of the loop: a closed list, each number within its range; the run goes on."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic import LIMIT_NAMES, SCENE, SafetyState
from mimics_app.contracts.loop.object_rows import ROW_DTYPES
from mimics_app.contracts.messages.orders import CONTROLLER, TRIAL, HapticOrder, haptic_field
from mimics_app.contracts.shared_memory.command_ring import request_stop
from mimics_app.contracts.system.resources import root
from tests.support.scene_play import ScenePlay

MAY = {
    "virtual_mass", "virtual_damping", "ball_radius_min", "ball_radius_max", "grasp_force_full", "target",
    "reference_cadence", "reference_speed", "reference_amplitude", "guidance",
}  # fmt: skip
"""Of SCENE itself: what is felt, where a drive leads, and how the reference of the joints goes, within its rates."""

GEOMETRY = {
    "kind", "body", "material", "mesh", "law", "size", "rounding", "field", "path", "on_body", "flags", "integrator",
    "inertia", "centre", "radius", "arc_length", "normal", "pieces", "projection", "frenet", "source", "source_row",
    "target", "target_row", "gain", "offset", "contact",
}  # fmt: skip
"""Of rows: what the loop indexes with, and what a scene is built of."""


@pytest.fixture(scope="module")
def play() -> ScenePlay:
    return ScenePlay(root() / "scenes" / "pick_and_place.json", seed=2).run(2.5)


def _ordered(play: ScenePlay, orders: dict[str, Any], seconds: float = 0.1) -> list[str]:
    """Give orders from the scenario for a time; return what the person was told."""
    told: list[str] = []
    core = play._play.core
    core.report = told.append
    play._play.frames._refused.clear()
    core.scenario.haptic_orders = lambda: HapticOrder({haptic_field(name): value for name, value in orders.items()})
    play.run(seconds)
    core.scenario.haptic_orders = HapticOrder
    return told


@pytest.mark.parametrize("name", sorted(set(SCENE.names or ()) - MAY))
@pytest.mark.requirement("R17")
def test_nothing_else_of_the_block_is_written(play: ScenePlay, name: str):
    """Among them resets, which leave a stop, and contacts and joints, without which nothing is watched."""
    before = np.copy(play.parameter_store.block[0][name])
    shape = SCENE[name].shape
    told = _ordered(play, {name: np.full(shape, 7) if shape else 7}, 1 / 60)
    assert len(told) == 1
    assert all(f'"{name}"' in text and (name in LIMIT_NAMES or "may not be written" in text) for text in told)
    assert name == "sequence" or np.array_equal(play.parameter_store.block[0][name], before)
    assert play.snapshots[-1].state <= SafetyState.ACTIVE


@pytest.mark.parametrize("table", ["shapes", "bodies", "effects", "points", "wires"])
def test_what_a_scene_is_built_of_is_not_rewritten(play: ScenePlay, table: str):
    names = play.parameter_store._names.get(table, {"hand": (0,)})
    entity = next(iter(names))
    fields = [
        name for name in ROW_DTYPES[table].names or () if name in GEOMETRY and (table, name) != ("effects", "radius")
    ]
    assert fields
    for field in fields:
        (told,) = _ordered(play, {f"{table}.{entity}.{field}": 0}, 1 / 60)
        assert field in told or table in ("points", "wires")


@pytest.mark.parametrize("value", [math.nan, math.inf, -1.0, 1e12, "stiff", None, (1.0, 2.0), ()])
@pytest.mark.requirement("R05")
@pytest.mark.fault(id="F04")
def test_a_bad_number_ends_its_order_and_not_the_run(play: ScenePlay, value: Any):
    kept, mass = float(play.parameter_store.block["virtual_damping"][0]), 4.0
    told = _ordered(play, {"virtual_damping": value, "virtual_mass": mass})
    assert len(told) == 1 and "virtual_damping" in told[0], "told once, not in every frame"
    assert play.parameter_store.block["virtual_damping"][0] == kept
    assert play.parameter_store.block["virtual_mass"][0] == mass, "what came with it holds"
    assert play.snapshots[-1].state <= SafetyState.ACTIVE


def test_numbers_that_belong_together_are_taken_or_refused_together(play: ScenePlay):
    store = play.parameter_store
    least, most = (float(store.block[name][0]) for name in ("ball_radius_min", "ball_radius_max"))
    assert not _ordered(play, {"ball_radius_min": 2.0 * most, "ball_radius_max": 3.0 * most})
    assert store.block["ball_radius_min"][0] == 2.0 * most
    assert not _ordered(play, {"ball_radius_min": least, "ball_radius_max": most})
    (told,) = _ordered(play, {"ball_radius_min": 2.0 * most})
    assert "must not be above ball_radius_max" in told and store.block["ball_radius_min"][0] == least


@pytest.mark.requirement("R10")
def test_a_latched_stop_is_left_by_a_person_alone():
    play = ScenePlay(root() / "scenes" / "wavy_tunnel.json", seed=2).run(2.5)
    request_stop(play.memory)
    play.run(0.1)
    assert play.snapshots[-1].state == SafetyState.E_STOP
    resets = int(play.parameter_store.block["resets"][0])
    _ordered(play, {"resets": resets + 1}, 0.3)
    assert play.parameter_store.order(HapticOrder({haptic_field("resets"): resets + 1}), of_task=True)
    play.run(0.3)
    assert play.snapshots[-1].state == SafetyState.E_STOP
    play.parameter_store.reset()
    play.run(0.3)
    assert play.snapshots[-1].state < SafetyState.SAFE_STOP


def test_a_task_kind_does_not_choose_the_controller():
    """What a kind's plug-in orders comes before the task manager's own orders, which hold."""
    play = ScenePlay(root() / "scenes" / "pick_and_place.json", seed=2).run(1.0)
    controller = int(play.parameter_store.block["controller"][0])
    (carry,) = play.tasks._plays.values()
    carry._carried.orders = {CONTROLLER: 0, TRIAL: 99, haptic_field("resets"): 5}
    play.run(0.2)
    block = play.parameter_store.block[0]
    assert (block["controller"], block["resets"]) == (controller, 0) and block["trial"] < 99
