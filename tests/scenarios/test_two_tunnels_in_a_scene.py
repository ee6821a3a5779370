"""A scene with two tunnels, written and played: both are seen and felt, the task is about the one its goal names."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.errors import SceneError, UsageError
from mimics_app.contracts.messages.orders import Feature, VisualOrder
from mimics_app.contracts.messages.stage_messages import TaskOrders
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.haptic.scene_tunnel import tunnel_of_scene
from tests.support.core_play import CorePlay

SCENE = root() / "scenes" / "wavy_tunnel.json"
RISE = 0.1
"""How much higher the second tunnel lies [m]: farther than both are wide."""


def two_tunnels(folder: Path, **changes: Any) -> Path:
    """The wavy tunnel with a copy of it `RISE` above, the task about the copy."""
    document = json.loads(SCENE.read_text())
    first = next(entity for entity in document["entities"] if entity["id"] == "tunnel")
    upper = json.loads(json.dumps(first)) | {"id": "upper"}
    tunnel = upper["components"]["tunnel"]
    tunnel["control_points"] = [[x, y + RISE, z] for x, y, z in tunnel["control_points"]]
    tunnel["stiffness"] = 777.0
    document["entities"].append(upper)
    document["task"]["goals"] = [{"kind": "progress", "at_least": 0.5, "tunnel": "upper"}]
    document["task"]["parameters"]["softness"] = {
        "min": 100.0, "max": 2000.0, "maps": [{"to": "haptic.tunnels.upper.stiffness"}],
    }  # fmt: skip
    document["task"] |= changes
    path = folder / "two.json"
    path.write_text(json.dumps(document))
    return path


@pytest.fixture(scope="module")
def play(tmp_path_factory: pytest.TempPathFactory) -> CorePlay:
    """The simulated patient, until the first trial has ended."""
    play = CorePlay.of(load_checked_scene(two_tunnels(tmp_path_factory.mktemp("two"))), 1)
    while not play.core.tasks.rows and play.frames.number < 60 * 60:
        play.step()
    return play


def test_the_patient_travels_the_task_s_own_tunnel(play: CorePlay):
    samples, (row, *_) = play.samples, play.core.tasks.rows
    assert row["outcome"] == "finished"
    curve, _ = tunnel_of_scene(play.core.scene, "upper")
    active = samples[samples["ramp"] == 1.0]
    s = active["s"][::50]
    distance = np.linalg.norm(active["hip_world"][::50] - curve.point(s), axis=1)
    assert distance == pytest.approx(active["distance"][::50], abs=1e-6)
    assert active["progress"].max() >= 0.5
    assert active["distance"].max() < RISE / 2.0


def test_both_walls_are_in_the_picture_and_one_is_widened_alone(play: CorePlay):
    world, scenario = play.core.world, play.core.scenario
    own, other = ("tunnel_wall", "tunnel_wall:tunnel")
    before = {name: world.meshes[name].positions.copy() for name in (own, other)}
    snapshot = play.core.haptics.snapshot()
    scenario.apply(TaskOrders(visual=VisualOrder({Feature("tunnel.radius_scale", 1.0): 1.3})), snapshot)
    assert np.array_equal(world.meshes[own].positions, before[own])
    assert not np.array_equal(world.meshes[other].positions, before[other])
    assert world.find("tunnel").entity is not None and world.find("upper").entity is not None


def test_one_tunnel_is_adapted_without_the_other(play: CorePlay):
    store = play.core.parameter_store
    first, upper = store.value("tunnels.tunnel.stiffness"), store.value("tunnels.upper.stiffness")
    assert (first, upper, store.value("tunnel.stiffness")) == (2000.0, 777.0, 777.0)
    assert store.change({"tunnels.tunnel.stiffness": 900.0})
    assert (store.value("tunnels.tunnel.stiffness"), store.value("tunnels.upper.stiffness")) == (900.0, 777.0)
    assert store.change({"tunnel.stiffness": 800.0}), "the task's own"
    assert (store.value("tunnels.tunnel.stiffness"), store.value("tunnels.upper.stiffness")) == (900.0, 800.0)
    with pytest.raises(UsageError, match="unknown haptic parameter"):
        store.change({"tunnels.lower.stiffness": 1.0})


@pytest.mark.parametrize(
    ("changes", "pointer", "what"),
    [
        ({"goals": [{"kind": "progress", "tunnel": "uper"}]}, "/task/goals/0/tunnel", 'no tunnel is called "uper"'),
        (
            {"goals": [{"kind": "progress", "tunnel": "upper"}, {"kind": "progress", "tunnel": "tunnel"}]},
            "/task/goals/1/tunnel",
            "one tunnel of its own",
        ),
        (
            {
                "parameters": {"a": {"min": 1, "max": 2, "maps": [{"to": "haptic.tunnels.ball.stiffness"}]}},
                "trials": [{}],
            },
            "/task/parameters/a/maps/0/to",
            'no tunnel is called "ball"',
        ),
        (
            {
                "parameters": {"a": {"min": 1, "max": 9, "maps": [{"to": "haptic.tunnels.tunnel.radius_scale"}]}},
                "trials": [{}],
            },
            "/task/parameters/a/max",
            "wider than its tightest bend",
        ),
    ],
)
def test_what_is_wrong_is_reported_where_it_stands(tmp_path: Path, changes: Any, pointer: str, what: str):
    with pytest.raises(SceneError) as error:
        load_checked_scene(two_tunnels(tmp_path, **changes))
    assert [(issue.pointer, what in issue.what) for issue in error.value.issues] == [(pointer, True)]
