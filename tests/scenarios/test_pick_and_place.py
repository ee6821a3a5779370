"""Pick and place by simulated persons and by a pointer: who can, who less, who not at all; and as a script meets it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.recording.run import Run
from tests.support.command import mimics
from tests.support.market_play import SCENE, MarketPlay

SECONDS, SEED = 60.0, 7
SEEDS = tuple(range(1, 21))
LANDED = round(2.5 * 60)
"""Frames after which an apple that fell lies still."""


def highest(heights: np.ndarray) -> float:
    """Of the apple once it lies still [m]: an apple that rolled away falls anew, which is no lifting.

    Nothing but a new fall takes it up by 10 cm in one frame.
    """
    falls = np.flatnonzero(np.diff(heights, prepend=0.0) > 0.1)
    lies = np.ones(len(heights), bool)
    for fall in falls:
        lies[fall : fall + LANDED] = False
    return float(heights[lies].max())


@pytest.fixture(scope="module")
def answer(tmp_path_factory) -> dict[str, Any]:
    folder = tmp_path_factory.mktemp("runs")
    options = ("--headless", "--seconds", SECONDS, "--seed", SEED, "--json", "--runs", folder, "--pictures", 0)
    done = mimics("run", SCENE, *options)
    assert done.returncode == 0, done.stderr
    result: dict[str, Any] = json.loads(done.stdout)
    return result


def test_a_run_places_three_and_leaves_nothing_unread_but_the_board(answer):
    assert answer["task"]["placed"] >= 3
    assert answer["unread"] == ["hud"]  # --pictures 0: nothing is drawn, so nobody requests the board
    assert (answer["safety"]["stops"], answer["safety"]["holds"]) == (0, 0)


def test_its_replay_is_equal_bit_for_bit(answer):
    done = mimics("replay", answer["run_dir"], "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["ticks"] == 60_000


def test_every_frame_says_where_the_apple_was(answer):
    frames = Run.open(Path(answer["run_dir"])).lines_of("app", "frame")
    places = np.array([line["bodies"][0] for line in frames])
    assert places.shape == (answer["frames"], 7)
    assert np.ptp(places[:, 0]) > 0.1 and np.allclose(np.linalg.norm(places[60:, 3:], axis=1), 1.0)


def test_its_report_says_of_the_carrying(answer):
    report = Path(answer["report"]).read_text()
    for words in ("apple in the hand", "grasp force", "right at least", "drops", "Carrying"):
        assert words in report, words


def test_sounds_of_grip_knock_and_set_down_were_played(answer):
    lines = [json.loads(line) for line in (Path(answer["run_dir"]) / "events.jsonl").read_text().splitlines()]
    heard = {str(line.get("sound", "")).split(":")[0] for line in lines if line.get("kind") == "sound"}
    assert {"grip_cue", "placed_chime", "apple_knock"} <= heard


def test_the_weight_of_each_trials_apple_is_felt_while_it_is_carried(answer):
    """Held, off the ground and hardly accelerating: the force on the hand is the weight, downwards."""
    run = Run.open(Path(answer["run_dir"]))
    rows = run.haptic
    slow = np.abs(np.gradient(rows["v_world"][:, 1], 1e-3)) < 0.2
    high = rows["hip_world"][:, 1] > 0.215
    reported = 0
    for trial in run.trials:
        within = (rows["t"] > trial["begin_ns"] * 1e-9) & (rows["t"] < trial["end_ns"] * 1e-9)
        lifted = within & slow & high & (rows["held_body"] >= 0.0)
        if trial["outcome"] == "finished" and lifted.sum() > 500:
            reported += 1
            weight = 9.81 * trial["parameter.weight"]
            assert np.median(rows["f_grip"][lifted, 1]) == pytest.approx(-weight, rel=0.05)
    assert reported >= 2


def test_the_severe_place_fewer(answer):
    assert MarketPlay("severe", SEED, SECONDS).result["placed"] < answer["task"]["placed"]


def test_without_a_grip_nothing_is_lifted():
    """0.6 N carries 2 x 0.6 x 0.6 N, 73 g; the lightest apple has 150 g."""
    play = MarketPlay("healthy", 3, 15.0, grasp=0.6, grasp_variation=0.0)
    assert play.result["placed"] == 0
    assert highest(play.heights) < 0.05, "no more than a nudge"


def test_assistance_lets_the_soft_start_end():
    """The easier task helps with up to 6 N, more than a soft start waits for: before the go it must not pull."""
    play = MarketPlay("severe", 1, 5.0, difficulty="easier", keep=("ramp", "f_effects"))
    ramp, help_n = play.kept["ramp"], np.linalg.norm(play.kept["f_effects"], axis=1)
    assert ramp.max() == 1.0
    assert help_n[ramp == 1.0].max() > 3.0


def test_a_person_at_a_pointer_places_apples_too():
    play = MarketPlay("healthy", 6, 20.0, pointer=9.0)
    assert play.result["placed"] >= 1
    assert (play.result["drops"], play.result["bruises"]) == (0, 0)


def test_pressed_too_hard_it_is_bruised():
    assert MarketPlay("healthy", 6, 12.0, pointer=30.0).result["bruises"] >= 1


@pytest.mark.slow
def test_the_healthy_place_three_the_severe_fewer_over_twenty_seeds():
    healthy, severe = (
        [MarketPlay(who, seed, SECONDS).result["placed"] for seed in SEEDS] for who in ("healthy", "severe")
    )
    assert min(healthy) >= 3, f"healthy: {healthy}"
    assert np.mean(severe) < np.mean(healthy) - 1.0, f"severe {severe}, healthy {healthy}"
    fewer = sum(s < h for s, h in zip(severe, healthy, strict=True))
    assert fewer >= 18, f"severe {severe}, healthy {healthy}"


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_no_grip_never_lifts(seed):
    for changes in ({"grasp": 0.0, "grasp_variation": 0.0}, {"grasp": 0.6, "grasp_variation": 0.0}, {"intent": False}):
        play = MarketPlay("healthy", seed, 20.0, **changes)
        assert play.result["placed"] == 0
        assert highest(play.heights) < 0.05
