"""Culls, bounding geometries and mesh fingers of the registry, and the bench of haptic objects."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.lab import haptic_bench, haptic_peers
from mimics_app.lab.groups import bounding_geometry, mesh_finger, shape_cull
from mimics_app.lab.groups.shape_cull import find_near_plain
from mimics_app.lab.haptic import points_bench
from mimics_app.lab.haptic_harness import HarnessRow, run_harnesses
from mimics_app.lab.stability import s10b_rounded_edge
from mimics_app.rendering.haptic.kernels.objects.cull import find_near


@pytest.mark.parametrize("number", range(3))
@pytest.mark.parametrize("count", [1, 63, 64, 65, 1000])
def test_no_cull_misses_a_shape(number, count):
    assert shape_cull.misses(number, count) == 0.0


@pytest.mark.parametrize("find", [find_near, find_near_plain])
def test_cull_finds_walls_always_and_disabled_shapes_never(find):
    bounds = np.zeros((4, 130))
    bounds[0] = np.arange(130)
    bounds[3] = 0.1
    bounds[3, 70], bounds[3, 129], bounds[3, 5] = np.inf, np.inf, -1.0
    near = np.zeros(130, np.int64)
    assert near[: find(bounds, 130, np.array([5.0, 0.0, 0.0]), 0.02, near)].tolist() == [70, 129]
    assert near[: find(bounds, 129, np.array([7.11, 0.0, 0.0]), 0.02, near)].tolist() == [7, 70]
    assert find(bounds, 130, np.array([math.nan, 0.0, 0.0]), 0.02, near) == 0


def test_bounding_geometries_err_as_their_form_does():
    """A sphere not at all, a mesh by its facets: k r (1 - cos(2 pi / n)) or less; what is flat by several N."""
    assert bounding_geometry.false_force(ShapeKind.SPHERE) < 1e-9
    coarse = bounding_geometry.false_force(ShapeKind.MESH, 1000)
    fine = bounding_geometry.false_force(ShapeKind.MESH, 10_000)
    assert fine < 0.5 * coarse < 1.0
    assert bounding_geometry.false_force(ShapeKind.BOX) > coarse


def test_only_the_walking_finger_holds_its_face():
    assert mesh_finger.false_slide(0) < 1e-9
    for number in (1, 2):
        assert mesh_finger.false_slide(number) == pytest.approx(math.sqrt(2.0) * 2000.0 * 3e-3, rel=0.02)


def test_a_rounded_edge_drops_nothing():
    assert s10b_rounded_edge.leaving_change(0.0) == pytest.approx(6.0)
    outcome = s10b_rounded_edge.EXPERIMENT.run(4)
    assert outcome.passed, outcome.note


@pytest.fixture
def short_bench(monkeypatch):
    """A bench of a second or so."""
    for name, values in (("_COUNTS", (1, 10)), ("_TRIANGLES", (100,)), ("_BODIES", (1,))):
        monkeypatch.setattr(haptic_bench, name, values)
    monkeypatch.setattr(haptic_peers, "_MOST_TICKS", 20)
    monkeypatch.setattr(points_bench, "_TICKS", 500)
    monkeypatch.setattr(haptic_bench, "_tick_p99_us", lambda scene: 1.0 + len(scene.rows.shapes))


def test_bench_rows_say_what_was_measured(short_bench):
    """MuJoCo comes with the tests, CHAI3D does not, Bullet may be there: no figure of what is absent."""
    reported = []
    found = haptic_bench.measure_haptic(reported.append)
    assert found["reference_ns"] > 0.0
    rows = found["rows"]
    assert {row["work"] for row in rows} == {
        "sphere",
        "box",
        "cylinder",
        "capsule",
        "mesh",
        "bodies heap",
        "boxes, 10 moving",
        *haptic_bench.BODY_WORKLOADS,
    }
    assert all(row["us"] > 0.0 and row["ratio"] > 0.0 and row["tick_p99_us"] > 0.0 for row in rows)
    assert all(value is not None for row in rows for value in row.values())
    beside = {"us_from_python", "peer", "peer_us"}
    for row in rows:
        assert beside <= set(row) if row["work"] in haptic_bench.BODY_WORKLOADS else not beside & set(row)
    peers = {row["peer"].split()[0] for row in rows if row["work"] == "bodies box"}
    assert "MuJoCo" in peers and peers <= {"MuJoCo", "Bullet"}
    assert len(reported) == len({(row["work"], row["n"]) for row in rows}) + 1
    assert [row["n"] for row in found["points"]] == [1, 2, 4] and found["points"][0]["of_one_point"] == 1.0
    assert all(row["us"] > 0.0 for row in found["points"])


def test_bench_without_peers_has_no_figures_of_theirs(short_bench, monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    monkeypatch.setitem(sys.modules, "pybullet", None)
    rows = list(haptic_bench._body_rows(lambda _: None, 1.0, ()))
    assert [row.work for row in rows] == list(haptic_bench.BODY_WORKLOADS), "ours stays"
    assert all(not {"peer", "peer_us", "us_from_python"} & set(row.figures()) for row in rows)


def test_peers_and_ours_are_timed_by_one_rule_and_one_motion(short_bench, monkeypatch):
    timed, slides = [], []
    rule = haptic_peers.best_us

    def watched(run):
        timed.append(run.__qualname__)
        return rule(run)

    def build(kind, count, slide, stack):
        slides.append(slide)
        return "a peer 1.0", lambda: None

    monkeypatch.setattr(haptic_peers, "best_us", watched)
    monkeypatch.setattr(haptic_bench, "best_us", watched)
    monkeypatch.setattr(haptic_bench, "PEERS", {"a peer": build})
    rows = list(haptic_bench._body_rows(lambda _: None, 1.0, ()))
    assert {row.peer for row in rows} == {"a peer 1.0"}
    assert timed == ["_Hand.run", "measure_peer.<locals>.run", "_Hand.run_from_python"] * len(rows)
    assert all(slide is haptic_bench.SLIDE for slide in slides)


def test_hand_of_the_bench_slides_alike_in_compiled_code_and_from_python():
    hands = [haptic_bench._Hand(haptic_bench.BODY_WORKLOADS["bodies box"](2)) for _ in range(2)]
    hands[0].run(1250)
    hands[1].run_from_python(1250)
    places = [hand._hand[:6] for hand in hands]
    assert (places[0] == places[1]).all()
    assert places[0][0] == pytest.approx(4e-3 * math.sin(2.0 * math.pi * 0.249), abs=1e-12)
    motions = [hand._args[1].motions["position"] for hand in hands]
    assert (motions[0] == motions[1]).all()


def test_harness_is_run_and_ours_is_timed_by_its_numbers(tmp_path, short_bench, monkeypatch):
    row = {"engine": "peer 3", "kind": "box", "bodies": 1, "gap": 0.02, "us_block_min": 7.5, "n": 30, "reps": 4}
    others = [{**row, "gap": -0.0005}, {**row, "integrator": "RK4"}, {**row, "sleep": True}]
    (tmp_path / "haptics").mkdir()
    writes = f"import json, sys\njson.dump({{'rows': {[row, *others]!r}}}, open(sys.argv[1], 'w'))\n"
    (tmp_path / "haptics" / "bench_peer.py").write_text(writes)
    (tmp_path / "haptics" / "bench_absent.py").write_text("import a_peer_that_is_not_installed\n")
    (tmp_path / "haptics" / "bench_odd.py").write_text("import sys\nopen(sys.argv[1], 'w').write('[]')\n")
    reported, timed = [], []
    found = run_harnesses(tmp_path, reported.append)
    assert found == [HarnessRow("peer 3", "box", 1, 7.5, 30, 4)]
    assert any("bench_odd is not measured" in line for line in reported)
    monkeypatch.setattr(haptic_bench, "PEERS", {})
    monkeypatch.setattr(haptic_bench, "shortest_us", lambda work, calls, rounds: timed.append((calls, rounds)) or 2.0)
    rows = list(haptic_bench._body_rows(lambda _: None, 1.0, found))
    assert [(row.work, row.peer, row.peer_us, row.us_from_python) for row in rows if row.peer] == [
        ("bodies box", "peer 3", 7.5, 2.0)
    ]
    assert timed == [(30, 4)]
    with pytest.raises(UsageError, match="no harness"):
        run_harnesses(tmp_path / "haptics", reported.append)


def test_whole_tick_is_that_of_the_live_loop(monkeypatch):
    monkeypatch.setattr(haptic_bench, "_LIVE_S", 1.2)
    assert 0.5 < haptic_bench._tick_p99_us(haptic_bench.BODY_WORKLOADS["bodies sphere"](2)) < 1e6


def test_bodies_of_the_bench_lie_on_the_floor_and_touch_it():
    scene = haptic_bench.BODY_WORKLOADS["bodies box"](4)
    from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS
    from mimics_app.rendering.haptic.kernels.objects.object_inputs import INPUT_LENGTH
    from mimics_app.rendering.haptic.no_objects import NO_FIELDS
    from mimics_app.rendering.haptic.objects import new_object_work
    from mimics_app.rendering.haptic.simulate import simulate_objects

    work = new_object_work(scene.capacities)
    hand, force = np.zeros(INPUT_LENGTH), np.zeros(3 * MAX_CONTACTS)
    hand[:3] = scene.hand
    for _ in range(200):
        simulate_objects(scene.rows, work, scene.counts[0], hand, NO_FIELDS, 1e-3, force)
    assert (work.motions["collided"] == 1).all() and (work.motions["asleep"] == 0).all()
    assert force[1] > 0.5
    assert np.abs(work.motions["position"][:, 1] - 0.02).max() < 4e-3


def test_fixed_shapes_of_the_bench_stand_beside_the_bodies_that_move():
    scene = haptic_bench.bodies_on_a_floor(haptic_bench.ShapeKind.BOX, 2, fixed=3)
    assert scene.rows.shapes["body"].tolist() == [0, 1, -1, -1, -1, -1]
    places = np.concatenate([scene.rows.bodies["position"], scene.rows.shapes["position"][2:5]])
    assert np.unique(places, axis=0).shape == (5, 3)
    assert scene.rows.shapes["kind"].tolist() == [haptic_bench.ShapeKind.BOX] * 5 + [haptic_bench.ShapeKind.WALL]
