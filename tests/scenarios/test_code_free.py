"""Scenes that need no code run as they are: nothing stops, nothing leaves, and what they show happens."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.haptic.replay import replay_run
from tests.support.object_scenes import thing, written
from tests.support.scene_play import ScenePlay

EXAMPLES = root() / "scenes" / "examples"

TOUCHED = ("falling_pairs", "free_objects", "models", "rollers", "shaking_and_sticking", "surfaces", "wired")
PULLED = ("force_field", "guided_path", "shaking_and_sticking", "springs_and_magnets", "wired")
ALL = sorted({*TOUCHED, *PULLED, "tower", "two_fingers"})

SECONDS = {"guided_path": 12.0, "wired": 12.0}
"""Where it takes longer than `_ENOUGH` to see what a scene shows [s]."""

_ENOUGH = 9.0
"""Four bring the hand to its start; then the person acts [s]."""


@cache
def played(name: str) -> ScenePlay:
    return ScenePlay(EXAMPLES / f"{name}.json").run(SECONDS.get(name, _ENOUGH))


@pytest.mark.parametrize("name", ALL)
def test_scene_runs_and_nothing_leaves_it(name):
    play = played(name)
    assert SafetyState.SAFE_STOP not in play.samples["state"]
    assert np.isfinite(play.samples["f_user_world"]).all()
    assert np.isfinite(play.samples["hip_world"]).all()
    for entity in play.objects.body_entities:
        place = play.pose(entity)[:3]
        assert np.abs(place).max() < 0.7, f"{entity} is gone"
        assert place[1] > 0.10, f"{entity} fell through"
        assert play.speed(entity) < 1.0, f"{entity} was flung off"
        assert play.world.find(entity).world_matrix()[:3, 3] == pytest.approx(place), "its node follows"


@pytest.mark.parametrize("name", TOUCHED)
def test_person_touches_something(name):
    samples = played(name).samples
    felt = samples[samples["state"] == SafetyState.ACTIVE]
    assert (felt["touching"] > 0).any()
    assert np.linalg.norm(felt["f_shapes"], axis=1).max() > 0.5


@pytest.mark.parametrize("name", TOUCHED)
def test_the_time_in_contact_is_that_of_the_samples(name):
    """A contact ends 0.02 s after the last touch, and touches within that time are one contact."""
    measures, samples = played(name).tasks._attempts.tally.measures(), played(name).samples
    touched = (samples["touching"] > 0) & (samples["t"] > samples["t"][-1] - measures.time_s)
    held = np.convolve(touched, np.ones(20))[: len(touched)] > 0
    assert measures.contact_time_s == pytest.approx(held.sum() * 1e-3, abs=2e-3 * measures.contacts + 0.02)


@pytest.mark.parametrize("name", PULLED)
def test_person_feels_the_effects(name):
    samples = played(name).samples
    felt = samples[samples["state"] == SafetyState.ACTIVE]
    assert np.linalg.norm(felt["f_effects"], axis=1).max() > (0.02 if name == "wired" else 0.5)


def test_guidance_brings_the_hand_to_the_end_of_the_path():
    play = played("guided_path")
    assert play.tasks.rows
    assert play.tasks.rows[0]["outcome"] == "finished"
    way = play.samples[play.samples["state"] == SafetyState.ACTIVE]
    assert np.linalg.norm(way["f_effects"], axis=1).max() <= 12.0 + 2.0 + 1e-9, "largest_force, and the leading force"


def test_tower_stands_while_nobody_touches_it():
    play = ScenePlay(EXAMPLES / "tower.json").run(2.0)
    before = [play.pose(f"brick_{k}")[:3].copy() for k in range(1, 6)]
    play.run(2.0)
    after = [play.pose(f"brick_{k}")[:3].copy() for k in range(1, 6)]
    assert np.abs(np.array(after) - before).max() < 1e-4
    assert np.all(np.diff(np.array(after)[:, 1]) > 0.025)


def test_what_falls_rests_on_the_table_and_on_each_other():
    """Before the person comes, each lies as deep as the weight above presses it: W / k, stiffnesses in series."""
    play = ScenePlay(EXAMPLES / "falling_pairs.json").run(4.0)
    table, boxes = 1.0 / (1.0 / 4000.0 + 1.0 / 4000.0), 1.0 / (2.0 / 4000.0)
    box = 0.3 * 9.81
    low = 0.165 - 2.0 * box / table
    expected = {"low_box": low, "high_box": low + 0.05 - box / boxes, "third_box": 0.165 - box / table}
    for name, height in expected.items():
        assert play.pose(name)[1] == pytest.approx(height, abs=2e-4), name
    for name in ("low_ball", "high_ball", "ball_on_box"):
        assert 0.165 < play.pose(name)[1] < 0.21, name


def test_objects_stay_between_the_six_walls():
    """Figure 50; a body may press into a wall of 1500 N/m by what its speed is worth."""
    play = played("free_objects")
    for snapshot in play.snapshots:
        reach = np.abs(snapshot.poses[:3, :3] - [0.0, 0.30, 0.0])
        assert (reach < np.array([0.21, 0.18, 0.16]) + 0.005).all()


def test_wires_carry_the_kite_after_the_hand():
    play = played("wired")
    late = play.snapshots[-1]
    kite = play.pose("kite")[:3]
    assert np.linalg.norm(kite - (late.hip_world + [0.0, 0.02, -0.10])) < 0.08


def test_recorded_ticks_of_paths_fields_and_meshes_simulate_again_bit_for_bit():
    for name in ("guided_path", "force_field", "models"):
        play = ScenePlay(EXAMPLES / f"{name}.json").run(0.5)
        again = replay_run(play.samples, play.blocks, play.rows, play.statics).samples
        for column in ("hip_world", "f_user_world", "f_effects", "f_shapes", "bodies"):
            assert (again[column] == play.samples[column]).all(), f"{name}: {column}"


def test_scene_without_a_task_goes_on_for_a_minute(tmp_path):
    file = written(tmp_path, thing("robot", robot={}), thing("patient", patient={}))
    play = ScenePlay(file).run(6.0)
    assert play.tasks.state in (TrialState.READY, TrialState.TRAVEL)


def test_field_that_breaks_is_put_away_and_the_run_goes_on(tmp_path):
    """1/sqrt of a negative number once the hand is beyond its place."""
    from mimics_app.compiled.kernel import typed_kernel
    from mimics_app.contracts.loop.loop_ports import FIELD
    from mimics_app.rendering.haptic import force_fields

    @typed_kernel(FIELD)
    def breaks(parameters, p, v, t, out):
        out[0] = 0.5 / np.sqrt(parameters[0] - t)

    force_fields.add_field("breaks", breaks)
    field = thing("field", force_field={"function": "breaks", "parameters": [0.5]})
    play = ScenePlay(written(tmp_path, thing("robot", robot={}), field)).run(2.0)
    before, after = (play.samples[part]["f_effects"][:, 0] for part in (slice(1, 499), slice(600, None)))
    assert (before > 0.5).all()
    assert not after.any()
    assert SafetyState.SAFE_STOP not in play.samples["state"]
