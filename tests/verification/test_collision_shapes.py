"""Distances, overlaps and normals of two solids, against sampled surfaces and each other."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.rendering.haptic.kernels.objects.collisions_boxes import separate_boxes
from mimics_app.rendering.haptic.kernels.objects.collisions_hulls import separate_hulls, support
from mimics_app.rendering.haptic.kernels.objects.distances import distance_to
from tests.support.body_play import new_play

NOWHERE = (0.0, 0.0, 0.0)
SIZES = {
    ShapeKind.SPHERE: (0.02,),
    ShapeKind.BOX: (0.04, 0.05, 0.03),
    ShapeKind.CYLINDER: (0.02, 0.05),
    ShapeKind.CAPSULE: (0.015, 0.04),
}


def posed(first, second, seed, apart):
    """Two solids in any attitude, `apart` [m] between their middles."""
    random = np.random.default_rng(seed)
    play = new_play()
    way = random.normal(size=3)
    for kind, place in ((first, NOWHERE), (second, apart * way / np.linalg.norm(way))):
        k = play.add_body(position=place, orientation=random.normal(size=4))
        play.add_shape(kind, SIZES[kind], k)
    play.run(1)
    return play.work.solids[0], play.work.solids[1]


def surface(solid, n=12_000):
    """Points all over a box or cylinder, world [m]."""
    random = np.random.default_rng(3)
    if solid["kind"] == ShapeKind.BOX:
        p = random.uniform(-0.5, 0.5, (n, 3))
        p[np.arange(n), np.arange(n) % 3] = np.sign(p[np.arange(n), np.arange(n) % 3]) * 0.5
        p *= solid["size"]
    else:
        angle, radius = random.uniform(0.0, 2.0 * np.pi, n), solid["size"][0]
        y = random.uniform(-0.5, 0.5, n) * solid["size"][1]
        rho = np.full(n, radius)
        cap = np.arange(n) % 2 == 0
        rho[cap] = radius * np.sqrt(random.uniform(0.0, 1.0, cap.sum()))
        y[cap] = np.sign(y[cap]) * 0.5 * solid["size"][1]
        p = np.stack([rho * np.cos(angle), y, rho * np.sin(angle)], axis=1)
    return p @ solid["rotation"].T + solid["position"]


@pytest.mark.parametrize("kind", list(SIZES))
def test_distance_is_a_distance_and_its_normal_the_gradient(kind):
    """|grad d| = 1 along n, inside and out (away from edges of the inside, where the nearest face changes)."""
    solid, _ = posed(kind, ShapeKind.SPHERE, 4, 1.0)
    random = np.random.default_rng(5)
    good = 0
    for p in random.uniform(-0.06, 0.06, (200, 3)):
        d, n = distance_to(solid, tuple(p), NOWHERE)
        h = 1e-7
        slope = [
            (distance_to(solid, tuple(p + h * e), NOWHERE)[0] - distance_to(solid, tuple(p - h * e), NOWHERE)[0])
            / (2 * h)
            for e in np.eye(3)
        ]
        assert np.linalg.norm(n) == pytest.approx(1.0)
        good += np.allclose(slope, n, atol=1e-5)
        if d > 0.0:
            back, _ = distance_to(solid, tuple(p - d * np.array(n)), NOWHERE)
            assert back == pytest.approx(0.0, abs=1e-12)
    assert good >= 198


@pytest.mark.parametrize("second", [ShapeKind.BOX, ShapeKind.CYLINDER])
@pytest.mark.parametrize("seed", range(12))
def test_cylinder_overlaps_as_deep_as_its_surface_says(second, seed):
    """Nearly touching: the gap between the rounded solids is that of sampled points, less what the skins round off."""
    for apart in (0.045, 0.055):
        a, b = posed(ShapeKind.CYLINDER, second, seed, apart)
        overlap, rounded, n = separate_hulls(a, b, NOWHERE, np.zeros((4, 3)))
        gaps = np.array([distance_to(b, tuple(p), NOWHERE)[0] for p in surface(a, 3000)])
        if overlap <= 0.0:
            assert gaps.min() > -1e-3, "they touch"
            continue
        if overlap > 3e-3:
            continue  # cores overlap: the way out is the least of some, tested below
        assert np.linalg.norm(n) == pytest.approx(1.0)
        assert rounded > -1e-9
        assert rounded < 2.0 * 0.42 * (2e-3 + 2.5e-3), "two skins at two corners, (sqrt 2 - 1) each and a bit"
        assert overlap == pytest.approx(-gaps.min(), abs=2.5e-3)


@pytest.mark.parametrize("second", [ShapeKind.BOX, ShapeKind.CYLINDER])
@pytest.mark.parametrize("seed", range(6))
def test_way_out_of_a_deep_overlap_is_a_way_out(second, seed):
    """Moved by its overlap along its normal the second is free; the force is bounded by the smaller solid."""
    a, b = posed(ShapeKind.CYLINDER, second, seed, 0.01)
    overlap, _, n = separate_hulls(a, b, NOWHERE, np.zeros((4, 3)))
    assert 0.0 < overlap < 0.06
    b["position"] += (overlap + 1e-9) * np.array(n)
    assert separate_hulls(a, b, n, np.zeros((4, 3)))[0] < 1e-3


@pytest.mark.parametrize("seed", range(40))
def test_boxes_overlap_by_the_least_of_their_axes(seed):
    """Against the 15 axes written out with numpy; apart exactly when one of them separates."""
    a, b = posed(ShapeKind.BOX, ShapeKind.BOX, seed, 0.035 + 0.0008 * seed)
    feature, overlap, n = separate_boxes(a, b, 0, NOWHERE, np.zeros((3, 3)))
    R, S = a["rotation"], b["rotation"]
    axes = [*R.T, *S.T, *(np.cross(R[:, i], S[:, j]) for i in range(3) for j in range(3))]
    deep = []
    for axis in axes:
        axis = axis / np.linalg.norm(axis)
        reach = 0.5 * (np.abs(axis @ R) @ a["size"] + np.abs(axis @ S) @ b["size"])
        deep.append(reach - abs(axis @ (b["position"] - a["position"])))
    if min(deep) <= 0.0:
        assert feature == 0
        return
    assert overlap == pytest.approx(deep[feature - 1], abs=1e-12)
    assert overlap <= min(min(deep[:6]), 1.06 * min(deep)) + 1e-12
    assert np.array(n) @ (b["position"] - a["position"]) > 0.0
    assert abs(np.array(n) @ axes[feature - 1]) == pytest.approx(np.linalg.norm(axes[feature - 1]))


def test_box_keeps_its_face_while_another_is_hardly_better():
    """A corner region where two faces are equally deep: the one of the last tick stays, whichever it was."""
    play = new_play()
    for place in ((0.0, 0.0, 0.0), (0.038, 0.038, 0.0)):
        play.add_box(position=place)
    play.run(1)
    a, b = play.work.solids[0], play.work.solids[1]
    for feature in (1, 2, 4, 5):
        assert separate_boxes(a, b, feature, NOWHERE, np.zeros((3, 3)))[0] == feature
    b["position"][1] += 5e-4  # now y is clearly less deep
    assert separate_boxes(a, b, 1, NOWHERE, np.zeros((3, 3)))[0] in (2, 5)


@pytest.mark.parametrize("kind", [ShapeKind.BOX, ShapeKind.CYLINDER])
def test_support_is_the_farthest_point(kind):
    solid, _ = posed(kind, ShapeKind.SPHERE, 8, 1.0)
    random = np.random.default_rng(9)
    points = surface(solid)
    for d in random.normal(size=(50, 3)):
        d /= np.linalg.norm(d)
        assert np.array(support(solid, tuple(d), 0.0)) @ d >= (points @ d).max() - 1e-12
        assert distance_to(solid, support(solid, tuple(d), 0.0), NOWHERE)[0] == pytest.approx(0.0, abs=1e-12)
