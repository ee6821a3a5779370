"""`mimics bench frame`: what is said of a live session's frames was measured in it."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path

import pytest

from mimics_app.app.bench import frame_bench, looked_at_load, ogre
from mimics_app.app.bench.frame_load import main
from mimics_app.app.bench.frame_watch import FrameWatch
from mimics_app.app.bench.looked_at_load import PEOPLE
from mimics_app.contracts.errors import DeviceError, SceneError
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.overlay.frame_budget import BUDGET_MS, FRAME_MS, over_budget

OF_PICTURE = {"prepare", "shadows", "cull", "submit", "post", "swap"}
STAGES = {"inputs", "tasks", "scenario", "world update", "watch", "board"} | OF_PICTURE


def test_a_live_session_is_timed_stage_by_stage():
    row = main(Path("scenes/wavy_tunnel.json"), (64, 36), "egl", 1.5, "full")
    assert row["stages"].keys() >= STAGES
    assert 0.0 < row["ms"]["p50"] <= row["ms"]["p95"] and row["fps"] > 1.0 and row["cpu_ms"] > 0.0
    assert row["triangles"] > 1000 and row["draw_calls"] > 1 and row["whole_ms"] > 0.0
    assert row["quality"] == {"scale": 1.0, "shadows": True, "steps": []}
    assert 0.0 <= row["missed_share"] <= 1.0
    assert 0.0 <= row["late"]["share"] < 1.0
    assert all(each["ms"] > 5.0 * row["ms"]["p50"] and each["stage_ms"] > 0.0 for each in row["late"]["frames"])
    assert all(row["stages"][name]["p50"] > 0.0 for name in ("tasks", "cull", "submit", "post"))


def test_without_peers_the_reference_is_a_loop_of_this_run(monkeypatch):
    monkeypatch.delenv("PEERS", raising=False)
    monkeypatch.setattr(frame_bench, "_measure_apart", lambda scene, *_: {"scene": scene.stem})
    reported: list[str] = []
    answer = frame_bench.measure_frames([Path("wavy_tunnel")], (64, 36), "egl", 1.0, reported.append)
    assert answer["reference"]["name"] == "reference loop" and answer["reference"]["ms"] > 0.0
    assert [row["requested"] for row in answer["scenes"]] == ["auto", "full"]
    assert len(answer["floor"]) == 4 and all(ms > 0.0 for ms in answer["floor"].values())
    assert any("OGRE is not measured" in line for line in reported)


def test_all_shipped_scenes_are_measured_where_none_is_named(monkeypatch):
    monkeypatch.setattr(frame_bench, "_measure_apart", lambda scene, *_: {"scene": scene.stem})
    answer = frame_bench.measure_frames([], (64, 36), "egl", 1.0, lambda _: None)
    names = {row["scene"] for row in answer["scenes"]}
    assert names >= {"wavy_tunnel", "pick_and_place", "guided_walk", "tower", "city_walk", "kicking"}


def test_a_scene_that_is_only_looked_at_is_timed_too():
    row = main(Path("scenes/examples/sky_box.json"), (64, 36), "egl", 1.5, "full")
    assert 0.0 < row["ms"]["p50"] <= row["ms"]["p95"] and row["triangles"] > 10 and row["missed_share"] is None
    assert row["stages"].keys() >= {"world update", "cull", "submit", "post", "swap"}


def test_a_row_may_be_held_at_a_scale_with_its_shadows(monkeypatch):
    row = main(Path("scenes/examples/decals.json"), (64, 36), "egl", 1.5, "0.75")
    assert row["quality"] == {"scale": 0.75, "shadows": True, "steps": []} and row["ms"]["p50"] > 0.0
    monkeypatch.setattr(frame_bench, "_measure_apart", lambda scene, *_: {"scene": scene.stem})
    monkeypatch.setattr(frame_bench, "_reference", lambda _: {})
    answer = frame_bench.measure_frames([Path("decals")], (64, 36), "egl", 1.0, lambda _: None, 0.75)
    assert [each["requested"] for each in answer["scenes"]] == ["auto", "full", "0.75"]


def test_every_round_measures_every_scene(monkeypatch):
    monkeypatch.setattr(frame_bench, "_measure_apart", lambda scene, *_: {"scene": scene.stem})
    monkeypatch.setattr(frame_bench, "_reference", lambda _: {})
    scenes = [Path("decals"), Path("walk")]
    answer = frame_bench.measure_frames(scenes, (64, 36), "egl", 1.0, lambda _: None, rounds=2)
    rows = [(each["round"], each["scene"], each["requested"]) for each in answer["scenes"]]
    assert rows == [(k, name, how) for k in (1, 2) for name in ("decals", "walk") for how in ("auto", "full")]


def test_a_scene_that_fails_leaves_the_others(monkeypatch):
    monkeypatch.setattr(frame_bench, "_reference", lambda _: {})
    monkeypatch.setattr(sys, "executable", "false")
    answer = frame_bench.measure_frames([Path("decals"), Path("sky_box")], (64, 36), "egl", 1.0, lambda _: None)
    assert [each["not_measured"] for each in answer["scenes"]] == ["exit code 1, see stderr"] * 4


def test_a_run_that_ends_before_it_is_measured_is_refused(monkeypatch):
    """As where a task is done at once."""
    monkeypatch.setattr(FrameWatch, "done", True)
    with pytest.raises(DeviceError, match="the run ended before its frames were measured: 0 counted"):
        main(Path("scenes/examples/sky_box.json"), (64, 36), "egl", 1.5, "full")


@pytest.mark.slow
def test_people_on_the_sidewalks_are_timed_as_a_scene_is():
    row = main(PEOPLE, (64, 36), "egl", 6.0, "full")
    assert row["scene"] == "people" and row["missed_share"] is None
    assert 0.0 < row["ms"]["p50"] <= row["ms"]["p95"]


def test_a_hundred_people_walk_on_the_sidewalks():
    _, world, move = looked_at_load._crowd()
    assert len(world.motion.bodies) >= 100
    poses = []
    for time_s in (1.0, 1.5):
        move(time_s)
        poses.append(world.transforms.world.copy())
    moved = (poses[0] != poses[1]).any(axis=(1, 2))
    assert moved.sum() >= 100 * 10, "the joints of each"


def test_every_stage_has_a_budget_and_they_leave_a_frame_some_air():
    assert set(BUDGET_MS) >= STAGES
    assert 0.95 * FRAME_MS < sum(BUDGET_MS.values()) <= FRAME_MS
    taken = {**BUDGET_MS, "board": 2.0 * BUDGET_MS["board"], "cull": 3.0 * BUDGET_MS["cull"], "own": 9.0}
    assert over_budget(BUDGET_MS) == [] and over_budget(taken) == ["cull", "board"]


def test_the_page_of_the_budget_says_what_the_table_says():
    """Of each stage its line, and of the whole frame."""
    page = (root() / "docs" / "frame-budget.md").read_text()
    reported = {name: float(ms) for name, ms in re.findall(r"^\| ([a-z ]+) \| ([0-9.]+) \|", page, re.MULTILINE)}
    assert reported == {**BUDGET_MS, "all": round(sum(BUDGET_MS.values()), 1)}


@pytest.fixture
def harness(tmp_path, monkeypatch):
    """A folder of peers whose OGRE is a program of ours."""

    def write(program: str) -> None:
        (tmp_path / "render").mkdir(exist_ok=True)
        (tmp_path / "render" / "run_ogre.py").write_text(program)

    for name in ("PEERS", "RENDER_DATA"):
        monkeypatch.setenv(name, str(tmp_path))
    wrapper = tmp_path / "xvfb-run"
    wrapper.write_text('#!/bin/sh\nshift 3\nexec "$@"\n')
    wrapper.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    monkeypatch.setattr(ogre, "_PYTHON", sys.executable)
    return write


def test_ogre_draws_what_we_draw_as_large(harness):
    harness('import json, sys\nassert sys.argv[1:8] == "city --opt gl3 --size 64x36 --msaa 4".split()\n'
            'print("starting")\nprint("RESULT " + json.dumps({"ms_median": 31.5}))\n')  # fmt: skip
    assert ogre.measure_ogre("city", (64, 36), pytest.fail, msaa=4) == 31.5


@pytest.mark.parametrize(
    "program", ["raise SystemExit(3)", "print('nothing')", "print('RESULT 3')", "print('RESULT {}')"]
)
def test_what_ogre_does_not_say_is_not_measured(harness, program):
    harness(program)
    reported: list[str] = []
    assert ogre.measure_ogre("city", (64, 36), reported.append) is None
    assert len(reported) == 1 and "OGRE is not measured" in reported[0]


def test_a_scene_that_is_not_there_is_refused():
    with pytest.raises(SceneError, match="scene not found"):
        frame_bench.measure_frames([Path("nowhere")], (64, 36), "egl", 1.0, lambda _: None)
