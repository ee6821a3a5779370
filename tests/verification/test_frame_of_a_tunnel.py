"""Which way n of a tunnel lies is the scene's choice: carried along, or Frenet's, which turns over at inflections."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.rendering.haptic.scene_tunnel import tunnel_rows
from mimics_app.rendering.haptic.tunnel_geometry import build_tunnel
from tests.support.haptic_bench import pointer_bench
from tests.support.tunnels import record_of, walk

SCENE = Path(__file__).parents[2] / "scenes" / "wavy_tunnel.json"
X = np.linspace(-0.16, 0.16, 14)
WAVY = build_tunnel(np.stack([X, 0.05 * np.sin(X / 0.32 * 2.5 * np.pi), 0.02 * X], axis=1), 0.02)
S = np.linspace(0.4, len(WAVY.pieces) - 0.4, 300)


def test_frenet_normals_of_the_loop_are_those_of_the_curve():
    ticks = walk(record_of(WAVY, frenet=1), WAVY.point(S))
    _, n, b = WAVY.frame(ticks["s"], "frenet")
    bent = np.linalg.norm(WAVY.curvature(ticks["s"]), axis=1) > 1.0
    assert bent.sum() > 200
    assert np.allclose(ticks["normal_n"][bent], n[bent], atol=1e-9)
    assert np.allclose(ticks["binormal"][bent], b[bent], atol=1e-9)


def test_frenet_turns_over_at_an_inflection_and_the_carried_frame_does_not():
    turns = []
    for frenet in (1, 0):
        n = walk(record_of(WAVY, frenet=frenet), WAVY.point(S))["normal_n"]
        turns.append(int((np.sum(n[1:] * n[:-1], axis=1) < -0.9).sum()))
    assert turns == [3, 0], "the wave crosses its middle three times"


def test_where_the_bisector_is_straight_frenet_has_no_normal_and_the_carried_one_is_kept():
    straight = build_tunnel([[-0.1, 0.0, 0.0], [0.1, 0.02, 0.0]], 0.02)
    path = straight.point(np.linspace(0.1, 0.9, 20))
    one, other = (walk(record_of(straight, frenet=frenet), path)["normal_n"] for frenet in (1, 0))
    assert np.isfinite(one).all() and np.array_equal(one, other)


def test_the_force_does_not_care_which_frame_says_it():
    off = WAVY.point(S) + [0.0, 0.0, 0.022]
    one, other = (walk(record_of(WAVY, frenet=frenet, stiffness=1000.0), off) for frenet in (1, 0))
    assert np.array_equal(one["force_world"], other["force_world"]) and np.abs(one["force_world"]).max() > 1.0
    assert not np.allclose(one["force_tnb"], other["force_tnb"], atol=0.1)


def test_a_scene_chooses_the_frame(tmp_path: Path):
    document = json.loads(SCENE.read_text(encoding="utf-8"))
    tunnel = next(e["components"]["tunnel"] for e in document["entities"] if "tunnel" in e.get("components", {}))
    for wanted, number in (("frenet", 1), ("rotation_minimising", 0)):
        tunnel["frame"] = wanted
        file = tmp_path / f"{wanted}.json"
        file.write_text(json.dumps(document), encoding="utf-8")
        assert tunnel_rows(load_checked_scene(file))[0]["frenet"].tolist() == [number]


def test_the_snapshot_says_how_the_wall_is_touched():
    """In a straight tunnel along x the wall pushes straight to the axis; with drag the whole force does not."""
    bench = pointer_bench()
    bench.publish(tunnel__drag=4.0)
    bench.send(target_world=(0.0, 0.0, 0.0), active=1)
    bench.advance(1500)
    assert bench.engine.snapshot().wall_force == 0.0
    bench.send(target_world=(0.05, -0.03, 0.04), active=1)
    bench.advance(300)
    snapshot = bench.engine.snapshot()
    aside = snapshot.hip_world * (0.0, 1.0, 1.0)
    assert snapshot.wall_force > 1.0
    np.testing.assert_allclose(snapshot.wall_normal, -aside / np.linalg.norm(aside), atol=1e-6)
