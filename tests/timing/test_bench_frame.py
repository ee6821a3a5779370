"""`mimics bench frame`: what is said of a live session's frames was measured in it."""

from __future__ import annotations

from pathlib import Path

import pytest

from mimics_app.app.bench import frame_bench
from mimics_app.app.bench.frame_load import main
from mimics_app.contracts.errors import SceneError

STAGES = {"inputs", "tasks", "scenario", "world update", "watch", "board", "cull", "shadows", "submit", "post", "swap"}


def test_a_live_session_is_timed_stage_by_stage():
    tried = (main(Path("scenes/wavy_tunnel.json"), (64, 36), "egl", seconds, "full") for seconds in (1.5, 6.0, 20.0))
    row = next(row for row in tried if row["ms"])  # a busy machine may draw no whole frame in a second
    assert row["stages"].keys() >= STAGES
    assert 0.0 < row["ms"]["p50"] <= row["ms"]["p95"] and row["fps"] > 1.0 and row["cpu_ms"] > 0.0
    assert row["triangles"] > 1000 and row["draw_calls"] > 1
    assert row["quality"] == {"scale": 1.0, "shadows": True, "steps": []}
    assert 0.0 <= row["missed_share"] <= 1.0
    inside = sum(each["p50"] for each in row["stages"].values())
    assert inside > 0.3 * row["ms"]["p50"], "the stages are where the time of a frame is"


def test_without_peers_the_reference_is_a_loop_of_this_run(monkeypatch):
    monkeypatch.delenv("PEERS", raising=False)
    monkeypatch.setattr(frame_bench, "_measure_apart", lambda scene, *_: {"scene": scene.stem})
    told: list[str] = []
    answer = frame_bench.measure_frames([Path("wavy_tunnel")], (64, 36), "egl", 1.0, told.append)
    assert answer["reference"]["name"] == "reference loop" and answer["reference"]["ms"] > 0.0
    assert [row["asked"] for row in answer["scenes"]] == ["auto", "full"]
    assert any("OGRE is not measured" in line for line in told)


def test_all_shipped_scenes_are_measured_where_none_is_named():
    assert {scene.stem for scene in frame_bench.shipped_scenes()} >= {
        "wavy_tunnel",
        "pick_and_place",
        "city_walk",
        "tower",
    }


def test_a_scene_that_is_not_there_is_refused():
    with pytest.raises(SceneError, match="no such scene"):
        frame_bench.measure_frames([Path("nowhere")], (64, 36), "egl", 1.0, lambda _: None)
