"""Culls, bounding geometries and mesh fingers of the registry, and the bench of haptic objects."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.contracts.haptic_objects import ShapeKind
from mimics_app.lab import haptic_bench
from mimics_app.lab.stability import s10b_rounded_edge
from mimics_app.rendering.haptic.kernels.objects.cull import find_near, find_near_plain
from mimics_app.rendering.haptic.methods import bounding as methods_bounding
from mimics_app.rendering.haptic.methods import cull as methods_cull
from mimics_app.rendering.haptic.methods import mesh as methods_mesh


@pytest.mark.parametrize("number", range(3))
@pytest.mark.parametrize("count", [1, 63, 64, 65, 1000])
def test_no_cull_misses_a_shape(number, count):
    assert methods_cull.misses(number, count) == 0.0


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
    assert methods_bounding.false_force(ShapeKind.SPHERE) < 1e-9
    coarse = methods_bounding.false_force(ShapeKind.MESH, 1000)
    fine = methods_bounding.false_force(ShapeKind.MESH, 10_000)
    assert fine < 0.5 * coarse < 1.0
    assert methods_bounding.false_force(ShapeKind.BOX) > coarse


def test_only_the_walking_finger_holds_its_face():
    assert methods_mesh.false_slide(0) < 1e-9
    for number in (1, 2):
        assert methods_mesh.false_slide(number) == pytest.approx(math.sqrt(2.0) * 2000.0 * 3e-3, rel=0.02)


def test_a_rounded_edge_drops_nothing():
    assert s10b_rounded_edge.leaving_change(0.0) == pytest.approx(6.0)
    outcome = s10b_rounded_edge.EXPERIMENT.run(4)
    assert outcome.passed, outcome.note


def test_bench_rows_say_what_was_measured(monkeypatch):
    """A short run: finite figures, peers quoted where they are not installed, the same keys in every row."""
    for name, values in (("_COUNTS", (1, 10)), ("_TRIANGLES", (100,)), ("_BODIES", (1,)), ("_TICKS", 20)):
        monkeypatch.setattr(haptic_bench, name, values)
    monkeypatch.setattr(haptic_bench, "_LONGEST", 0.01)
    monkeypatch.setattr(haptic_bench, "_tick_p99_us", lambda scene: 1.0 + len(scene.rows.shapes))
    told = []
    found = haptic_bench.measure_haptic(told.append)
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
    assert next(row for row in rows if row["work"] == "box")["peer_us"] == 0.12
    assert {row["peer"].split()[0] for row in rows if row["work"] == "bodies box"} == {"MuJoCo", "Bullet"}
    assert len(told) == len({(row["work"], row["n"]) for row in rows})


def test_whole_tick_is_that_of_the_live_loop(monkeypatch):
    monkeypatch.setattr(haptic_bench, "_LIVE_S", 1.2)
    assert 0.5 < haptic_bench._tick_p99_us(haptic_bench.BODY_WORKLOADS["bodies sphere"](2)) < 1e6


def test_bodies_of_the_bench_lie_on_the_floor_and_touch_it():
    scene = haptic_bench.BODY_WORKLOADS["bodies box"](4)
    from mimics_app.rendering.haptic.kernels.objects.hand import HAND_LENGTH
    from mimics_app.rendering.haptic.no_objects import NO_FIELDS
    from mimics_app.rendering.haptic.objects import new_object_work
    from mimics_app.rendering.haptic.simulate import simulate_objects

    work = new_object_work(scene.capacities)
    hand, force = np.zeros(HAND_LENGTH), np.zeros(3)
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
