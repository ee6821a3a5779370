"""Cap and margin of several contacts in the whole loop: each direction against the damping of that direction."""

from __future__ import annotations

import math
from itertools import permutations

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.lab.stability.contacts_loop import Contact, Device, exact_matrix
from mimics_app.lab.stability.linear import spectral_radius
from mimics_app.rendering.haptic.kernels.closed_region import contact_share
from mimics_app.rendering.haptic.kernels.kinematics import inverse
from mimics_app.rendering.haptic.scene_block import scene_from_components
from mimics_app.rendering.haptic.tunnel_geometry import build_tunnel
from tests.support.haptic_bench import Bench, script
from tests.support.object_bench import scripted_with
from tests.support.regions import HEAVY, linear_region
from tests.support.touch_play import RIM, SOLIDS, add_point, new_touch_play

T = 1e-3
OWN = 8.0  # virtual damping [N s/m]
DELAY = 4  # [ticks]
LAG = (0.5 + DELAY) * T
CAP = 0.2
ANGLES = [0.0, 30.0, 60.0, 90.0]
PLATE, BLOCK = (10000.0, 0.0), (100.0, 60.0)  # stiffness [N/m], damping [N s/m]
UNLIKE = [PLATE, BLOCK, (2500.0, 12.0)]
FIRST_GAP, NEXT_GAP, WAY = 0.5e-3, 0.5e-3, 6e-3  # [m]


def _normals(angle: float, count: int) -> np.ndarray:
    """Upwards, at an angle to it, and one that leans out of the plane of these by the same angle."""
    a = math.radians(angle)
    up, aside = np.array([0.0, 1.0, 0.0]), np.array([math.sin(a), math.cos(a), 0.0])
    middle = np.array([math.sin(0.5 * a), math.cos(0.5 * a), 0.0])
    return np.array([up, aside, math.cos(a) * middle + math.sin(a) * np.array([0.0, 0.0, 1.0])])[:count]


def _turn(normal: np.ndarray) -> np.ndarray:
    """Quaternion xyzw that turns +z, where the surface is, to a normal."""
    q = np.array([-normal[1], normal[0], 0.0, 1.0 + normal[2]])
    return q / np.linalg.norm(q)


def _pressed(
    normals: np.ndarray, surfaces: list[tuple[float, float]], order: tuple[int, ...], kind: ShapeKind = ShapeKind.BOX,
    rest: int = 0, **values: float,
) -> tuple[np.ndarray, Bench]:  # fmt: skip
    """Samples of a scripted hand that goes into fixed shapes one after the other in this order, and stays.

    It begins after `rest` ticks; from 600 on, after the soft start, what it touches is felt.
    """
    play = new_touch_play()
    way = -normals.sum(axis=0) / np.linalg.norm(normals.sum(axis=0))
    depth = RIM if kind == ShapeKind.BOX else 0.0
    fields = {key: values.pop(key) for key in [key for key in values if key.startswith("friction")]}
    for i, (k, b) in enumerate(surfaces):
        reached = FIRST_GAP + NEXT_GAP * order.index(i)  # along the way
        place = (reached * float(way @ normals[i]) - depth) * normals[i]
        size = SOLIDS.get(kind, ())
        play.add_shape(kind, size, position=place, orientation=_turn(normals[i]), stiffness=k, damping=b, **fields)
    add_point(play)
    steps = np.clip(np.arange(rest + 200) - rest, 0, 120) / 120.0
    rows = script(rest + 200)
    scene = scene_from_components()[0]
    for row, step in zip(rows, steps, strict=True):
        inverse(scene["R_world_from_robot"].T @ (step * WAY * way), float(scene["geometry"][0]), row[:3])
    bench = scripted_with(play, rows)
    bench.publish(virtual_damping=OWN, device_delay=DELAY * T, arm_damping=0.0, device_damping=0.0)
    bench.publish(**{**HEAVY, **values})
    samples = bench.advance(rest + 200)
    assert samples["touching"][-1] == len(surfaces)
    return samples, bench


def _matrices(normals: np.ndarray, surfaces: list[tuple[float, float]]) -> tuple[np.ndarray, np.ndarray]:
    K = sum(k * np.outer(n, n) for n, (k, _) in zip(normals, surfaces, strict=True))
    B = sum(b * np.outer(n, n) for n, (_, b) in zip(normals, surfaces, strict=True))
    return K, B


def _margin(K: np.ndarray, B: np.ndarray) -> float:
    """Largest m with OWN + B - (1 + m) LAG K >= 0 in every direction."""
    root = np.linalg.cholesky(OWN * np.eye(3) + B)
    worst = np.linalg.eigvalsh(np.linalg.solve(root, np.linalg.solve(root, LAG * K).T)).max()
    return float(1.0 / worst - 1.0)


def _share(normals: np.ndarray, surfaces: list[tuple[float, float]], rows: tuple[int, ...]) -> float:
    """Largest s with OWN + s (B - (1 + CAP) LAG K) >= 0 in every direction, of some of the contacts."""
    K, B = _matrices(normals[list(rows)], [surfaces[row] for row in rows])
    needed = float(np.linalg.eigvalsh(LAG * (1.0 + CAP) * K - B).max())
    return OWN / needed if needed > OWN else 1.0


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("count", [2, 3])
def test_the_margin_is_that_of_the_worst_direction_in_any_order_of_touching(angle: float, count: int):
    normals, surfaces = _normals(angle, count), UNLIKE[:count]
    expected = _margin(*_matrices(normals, surfaces))
    for order in permutations(range(count)):
        samples, bench = _pressed(normals, surfaces, order, cap=0)
        assert samples["margin"][-1] == pytest.approx(expected, rel=1e-9, abs=1e-9)
        u = bench.engine._work.state[0]["span"]["direction"]
        K, B = _matrices(normals, surfaces)
        assert samples["stiffness_limit"][-1] == pytest.approx((OWN + u @ B @ u) / LAG, rel=1e-9)
        assert (OWN + u @ B @ u) / LAG / (u @ K @ u) - 1.0 == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("count", [2, 3])
def test_the_cap_keeps_its_margin_in_every_direction_in_any_order_of_touching(angle: float, count: int):
    """And what is left of the contacts is stable by the eigenvalues of the sampled loop."""
    normals, surfaces = _normals(angle, count), UNLIKE[:count]
    angles = [math.atan2(n[0], n[1]) for n in normals]
    for order in permutations(range(count)):
        samples, _ = _pressed(normals, surfaces, order)
        share = samples["stiffness_share"][-1]
        least = min(_share(normals, surfaces, order[: i + 1]) for i in range(count))
        assert share == pytest.approx(least, rel=1e-9), "what the first to be touched have lost does not come back"
        assert samples["margin"][-1] >= CAP - 1e-9
        left = tuple(
            Contact(a, share * k, share * b, math.asin(n[2]))
            for a, n, (k, b) in zip(angles, normals, surfaces, strict=True)
        )
        assert spectral_radius(exact_matrix(Device(damping=OWN, delay=DELAY), left)) < 1.0


def test_a_damped_block_from_the_side_lends_the_plate_nothing_in_either_order():
    """10,000 N/m beside 100 N/m and 60 N s/m: the share is that of the plate alone."""
    alone = contact_share(linear_region(OWN, LAG), *PLATE, CAP)
    for order in ((0, 1), (1, 0)):
        samples, bench = _pressed(_normals(90.0, 2), [PLATE, BLOCK], order, rest=700)
        assert samples["stiffness_share"][-1] == pytest.approx(alone, rel=1e-9)
        assert samples["margin"][-1] == pytest.approx(CAP, rel=1e-9)
        assert samples["stiffness_limit"][-1] == pytest.approx(OWN / LAG, rel=1e-9)
        report = bench.engine.stability()
        assert report.contacts(("plate", "block")) == pytest.approx({"plate": CAP, "block": 99.0}, rel=1e-9)


def test_the_least_margin_is_no_contacts_alone():
    """Two plates at 60 degrees are stiffer between their normals than along either."""
    samples, bench = _pressed(_normals(60.0, 2), [(2000.0, 0.0), (2000.0, 0.0)], (0, 1), rest=700, cap=0)
    along = OWN / LAG / (2000.0 * 1.25) - 1.0
    assert bench.engine.stability().shapes == pytest.approx({0: along, 1: along}, rel=1e-9)
    assert samples["margin"][-1] == pytest.approx(OWN / LAG / (2000.0 * 1.5) - 1.0, rel=1e-9)


@pytest.mark.parametrize("angle", [30.0, 60.0])
def test_walls_that_share_a_corner_are_each_as_stable_as_alone(angle: float):
    """The corner is shared out, so that moving along one normal changes one wall's push only."""
    for order in ((0, 1), (1, 0)):
        samples, _ = _pressed(_normals(angle, 2), [PLATE, BLOCK], order, ShapeKind.WALL, cap=0)
        assert samples["margin"][-1] == pytest.approx(OWN / LAG / PLATE[0] - 1.0, rel=1e-9)


def test_friction_that_holds_is_stiff_along_the_surface():
    """A spring to the anchor of 6000 N/m on a surface of 1000 N/m: its limit is the nearer one."""
    hold = {"friction_static": 50.0, "friction_dynamic": 50.0, "friction_stiffness": 6000.0}
    samples, _ = _pressed(_normals(0.0, 1), [(1000.0, 10.0)], (0,), cap=0, **hold)
    assert samples["margin"][-1] == pytest.approx((OWN + 10.0) / LAG / 6000.0 - 1.0, rel=1e-9)
    both, _ = _pressed(_normals(90.0, 2), [(1000.0, 10.0), (500.0, 10.0)], (0, 1), cap=0, **hold)
    assert both["margin"][-1] == pytest.approx((OWN + 20.0) / LAG / 12000.0 - 1.0, rel=1e-9)


@pytest.mark.parametrize("capped", [0, 1])
def test_the_tunnels_wall_and_a_shape_behind_it_are_one_spring(capped: int):
    """Both push the same way: their stiffness and their damping add up, and each keeps the share of both."""
    wall, box = (5000.0, 20.0), (4000.0, 10.0)
    play = new_touch_play()
    play.add_shape(
        ShapeKind.BOX, SOLIDS[ShapeKind.BOX], position=(0.0, 0.028 + RIM, 0.0), stiffness=box[0], damping=box[1]
    )
    add_point(play)
    rows = script(400)
    rows[:, 2] = 0.030 * np.clip(np.arange(400) / 200.0, 0.0, 1.0)
    bench = scripted_with(play, rows)
    build_tunnel([[-0.15, 0.0, 0.0], [0.15, 0.0, 0.0]], 0.04).fill(bench.tunnel)
    bench.publish(tunnel__stiffness=wall[0], tunnel__damping=wall[1], tunnel__drag=0.0, tunnel__drag_growth=0.0)
    bench.publish(virtual_damping=OWN, device_delay=DELAY * T, cap=capped, **HEAVY)
    samples = bench.advance(400)
    assert samples["touching"][-1] == 1.0 and samples["penetration"][-1] > 0.0
    together = (OWN + 30.0) / LAG / 9000.0 - 1.0
    assert together < CAP
    if not capped:
        assert samples["margin"][-1] == pytest.approx(together, rel=1e-9)
        return
    share = contact_share(linear_region(OWN, LAG), 9000.0, 30.0, CAP)
    assert samples["stiffness_share"][-1] == pytest.approx(share, rel=1e-9)
    assert samples["margin"][-1] >= CAP
    push = samples["f_virt_world"][-1][1] - samples["f_shapes"][-1][1]
    assert push == pytest.approx(-share * wall[0] * samples["penetration"][-1], rel=1e-9), "the wall is as soft"
