"""Conformance kit of scenarios: what a session takes for granted of one, built in or of a package."""

from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.scenario_choice import open_scenario
from mimics_app.app.session.core import SessionCore
from mimics_app.app.viewer.resting import rest
from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.contracts.messages.stage_messages import Aim, TaskOrders
from mimics_app.contracts.ports.scenario_port import Scenario
from mimics_app.world.files.scene.file import build_world
from mimics_app.world.files.scene.reload import apply_scene
from tests.support.core_play import CorePlay

SEED = 3
FRAMES = 4


def check_scenario(file: Path) -> None:
    """Play the scenario of a scene as a session does; raises AssertionError, or the error that would end the run."""
    scene = load_checked_scene(file)
    world = build_world(scene)
    _check_statements(open_scenario(scene, world))
    rest(scene, world)  # as `mimics view` shows it: no haptic loop, bodies without a pose
    play, again = (CorePlay.of(load_checked_scene(file), SEED) for _ in range(2))
    try:
        _check_repeated(play, again)
        _check_frame(play)
        _check_reload(play.core)
    finally:
        for each in (play, again):
            each.core.stop()


def _check_statements(scenario: Scenario) -> None:
    """What is asked of a scenario before the first frame."""
    points = scenario.via_points_world
    assert points.ndim == 2 and points.shape[1] == 3 and np.isfinite(points).all(), "via points are places [n, 3]"
    try:
        json.dumps(dict(scenario.facts), allow_nan=False)
    except (TypeError, ValueError) as error:
        raise AssertionError(f"facts are plain values: {error}") from error
    one, other = scenario.scene_block(), scenario.scene_block()
    assert one.dtype == SCENE and one.shape == (1,), "the haptic parameters are one SCENE record"
    assert not np.shares_memory(one, other), "whoever asks for the haptic parameters owns the record"


def _check_repeated(play: CorePlay, again: CorePlay) -> None:
    """The seed alone decides what is played."""
    for each in (play, again):
        start, joints = each.core.scenario.task_context.start_joints, len(each.core.haptics.snapshot().q)
        assert len(start) == joints and np.isfinite(start).all(), "a trial starts at a position of each joint"
        for _ in range(FRAMES):
            each.step()
    one, other = play.core.scenario, again.core.scenario
    assert one.scene_block().tobytes() == other.scene_block().tobytes(), "the same scene has the same parameters"
    np.testing.assert_array_equal(one.via_points_world, other.via_points_world, "the same scene has the same path")
    assert play.samples.tobytes() == again.samples.tobytes(), "the same seed feels the same"


def _check_frame(play: CorePlay) -> None:
    """The calls of one frame, with a body that is tracked and one that is not, before a screen and inside walls."""
    core, scenario, snapshot, now_ns = play.core, play.core.scenario, play.frames.snapshot, play.core.clock.now_ns()
    given = _bytes_of(snapshot)
    for tracked in (False, True):
        scenario.set_tracked_body(lambda role, at_ns, tracked=tracked: np.eye(4) if tracked else None, now_ns)
        scenario.apply(play.frames.orders, snapshot)
        refused = core.parameter_store.order(scenario.haptic_orders())
        assert not refused, refused
        before = int(core.parameter_store.block["sequence"][0])
        core.parameter_store.order(scenario.haptic_orders())
        assert int(core.parameter_store.block["sequence"][0]) == before, "what was ordered is not ordered anew"
        _check_hand(scenario, scenario.aim(snapshot))
        core.world.update()
        scenario.hide_own_avatar()
    for name, value in _bytes_of(snapshot).items():
        assert value == given[name], f"a scenario changes nothing of the haptic state: {name}"


def _check_hand(scenario: Scenario, aim: Aim | None) -> None:
    assert aim is None or np.isfinite(aim.target_world).all(), "the hand has a place to go to"
    frame = scenario.hand_frame()
    if frame is not None:
        assert frame.shape == (4, 4) and np.allclose(frame[:3, :3] @ frame[:3, :3].T, np.eye(3), atol=1e-9), "rigid"


def _check_reload(core: SessionCore) -> None:
    """The scene file was saved again: the scenario is made anew in the world that its predecessor has furnished."""
    before = len(core.world.transforms)
    scene = load_checked_scene(core.scene.path, before=core.scene)
    apply_scene(core.world, core.scene, scene)
    scenario = open_scenario(scene, core.world)
    scenario.apply(TaskOrders(), core.haptics.snapshot())
    core.world.update()
    assert len(core.world.transforms) == before, "a reload adds nothing twice"


def _bytes_of(snapshot: Any) -> dict[str, bytes]:
    values: dict[str, NDArray[Any]] = {f.name: np.asarray(getattr(snapshot, f.name)) for f in fields(snapshot)}
    return {name: value.tobytes() for name, value in values.items()}
