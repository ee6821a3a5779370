"""Several tunnels in a scene: which holds the ball, what the sample holds, and what one does to the other: nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.haptic import SAMPLE, SCENE
from mimics_app.contracts.loop.haptic_objects import TUNNEL
from mimics_app.contracts.loop.object_rows import ObjectCapacities, new_rows, pack_rows
from mimics_app.rendering.haptic.scene_block import scene_from_components
from mimics_app.rendering.haptic.tunnel_geometry import build_tunnel
from tests.support.haptic_bench import Bench, patient_bench, script, scripted

STIFF, SOFT = 2000.0, 300.0
WAY = 0.1
"""How far the scripted hand goes along an axis [m]."""

OWN_TUNNEL = ("s", "progress", "distance", "offset_n", "offset_b", "tunnel_radius")

ROOM = {"objects": ObjectCapacities(tunnels=2)}


def tunnel(points: Any, radius: float = 0.04, **fields: float) -> np.ndarray:
    row = np.zeros(1, TUNNEL)
    build_tunnel(points, radius).fill(row[0])
    for name, value in {"radius_scale": 1.0, "stiffness": STIFF, "damping": 25.0, **fields}.items():
        row[0][name] = value
    return row


def along_x(**fields: float) -> np.ndarray:
    return tunnel([[-0.15, 0.0, 0.0], [0.15, 0.0, 0.0]], **fields)


def along_y(**fields: float) -> np.ndarray:
    return tunnel([[0.0, -0.15, 0.0], [0.0, 0.15, 0.0]], **fields)


def far_away() -> np.ndarray:
    return tunnel([[5.0, 5.0, 0.0], [5.3, 5.1, 0.0]])


def put(bench: Bench, *rows: np.ndarray, **values: Any) -> Bench:
    bench.rows = bench.rows._replace(tunnels=np.concatenate(rows))
    bench.publish(**values)
    return bench


def led_along(axis: int, *rows: np.ndarray, **values: Any) -> np.ndarray:
    """Samples of a hand that rests in the middle, then goes by `WAY` along a joint: 0 is the world's z, 1 x, 2 y."""
    ticks = script(1600)
    way = np.concatenate([np.zeros(900), np.linspace(0.0, WAY, 500), np.full(200, WAY)])
    ticks[:, axis] = way
    bench = scripted(ticks, straight=None, capacities=ROOM)
    return put(bench, *rows, controller=Slot.PERSON, force_limit=1e4, velocity_limit=1e3, **values).advance(1600)


UP = 2
"""The joint that moves the hand along the world's y."""


def same(one: np.ndarray, other: np.ndarray, *but: str) -> list[str]:
    """Columns that differ in any bit."""
    return [name for name in SAMPLE.names if name not in but and one[name].tobytes() != other[name].tobytes()]


@pytest.mark.parametrize("row", [0, 1])
def test_each_feels_as_in_a_scene_of_its_own(row: int):
    """A simulated person travels; the other tunnel is 5 m away, before or behind it in the table."""
    alone = patient_bench()
    samples = []
    for bench in (alone, patient_bench(capacities=ROOM)):
        both = [bench.rows.tunnels[:1], far_away()]
        rows = both[:1] if bench is alone else both[::-1] if row else both
        own = 0 if bench is alone else row
        put(bench, *rows, own_tunnel=own)
        drive = bench.advance(2000)
        bench.send(active=1, grasp=10.0)
        bench.publish(controller=Slot.PERSON, trial=1)
        samples.append(np.concatenate([drive, bench.advance(4000)]))
    assert np.abs(samples[0]["f_user_world"]).max() > 1.0 and samples[0]["penetration"].max() > 0.0
    assert same(*samples) == []


def test_the_ball_stays_in_its_tunnel_and_the_wall_of_the_other_is_not_there():
    crossed = led_along(UP, along_x(), along_y(stiffness=SOFT))
    out = led_along(UP, along_x())
    pressed = out["penetration"] > 0.0
    assert pressed.sum() > 300
    assert np.abs(out["f_virt_world"][pressed, 1]).max() > 50.0
    # Through the wall of the first there is the second: the ball is in that one, and nothing pushes.
    assert np.all(crossed["f_virt_world"] == 0.0)
    # Away from the crossing it is a wall again, at the second's own stiffness.
    sideways = led_along(1, along_y(stiffness=SOFT), along_x())
    assert np.all(sideways["f_virt_world"] == 0.0)
    walled = led_along(0, along_y(stiffness=SOFT), along_x())
    depth = np.linalg.norm(walled["hip_world"][-1] - walled["hip_world"][0]) - (0.04 - walled["ball_radius"][-1])
    assert np.linalg.norm(walled["f_virt_world"][-1]) == pytest.approx(SOFT * depth, rel=1e-9)


def test_the_sample_says_of_the_task_s_own_tunnel_wherever_the_ball_is():
    own = led_along(UP, along_x(), along_y(), own_tunnel=1)
    alone = led_along(UP, along_y())
    other = led_along(UP, along_x(), along_y(), own_tunnel=0)
    assert [name for name in OWN_TUNNEL if own[name].tobytes() != alone[name].tobytes()] == []
    assert np.abs(other["distance"] - alone["distance"]).max() > 0.9 * WAY
    assert other["distance"][-1] == pytest.approx(WAY, abs=1e-9), "the way it missed"
    assert own["f_virt_world"].tobytes() == other["f_virt_world"].tobytes(), "what is reported changes no force"


def test_the_force_of_another_tunnel_is_not_reported_as_the_own_one_s():
    reported = led_along(0, along_x(), far_away(), own_tunnel=1)
    assert np.abs(reported["f_virt_world"]).max() > 10.0 and np.all(reported["f_tunnel"] == 0.0)
    assert np.all(reported["penetration"] == 0.0)


def test_cap_and_margin_are_those_of_the_tunnel_that_holds_the_ball():
    values = {"cap": 0, "device_delay": 5e-3}
    stiff = led_along(0, along_x(), far_away(), **values)
    soft = led_along(0, along_x(stiffness=SOFT), far_away(), **values)
    ratio = (stiff["margin"] + 1.0) / (soft["margin"] + 1.0)
    assert ratio[100:] == pytest.approx(SOFT / STIFF, rel=1e-12)
    capped = led_along(0, along_x(stiffness=1e6), far_away(), cap=1, cap_margin=0.1, device_delay=5e-3)
    assert capped["stiffness_share"].max() < 0.1
    beside = led_along(0, along_x(stiffness=SOFT), np.concatenate([far_away()]), cap=1, cap_margin=0.1)
    assert beside["stiffness_share"].min() == 1.0


def test_a_tunnel_that_is_gone_holds_no_more():
    bench = scripted(script(100), straight=None, capacities=ROOM)
    put(bench, along_x(), along_y())
    bench.advance(10)
    put(bench, along_x())
    assert np.all(np.isfinite(bench.advance(10)["f_virt_world"]))
    bench.rows = bench.rows._replace(tunnels=bench.rows.tunnels[:0])
    bench.publish()
    assert np.all(bench.advance(10)["f_virt_world"] == 0.0)


def test_two_tunnels_are_replayed_bit_for_bit():
    ticks = script(1200)
    ticks[:, UP] = np.concatenate([np.zeros(900), np.linspace(0.0, WAY, 300)])
    bench = scripted(ticks, straight=None, capacities=ROOM)
    put(bench, along_x(), along_y(stiffness=SOFT), controller=Slot.PERSON, own_tunnel=1)
    samples = bench.advance(1200)
    again = bench.replay(samples)
    assert same(samples, again, "lateness_ns", "duration_ns") == []


def test_a_block_without_a_tunnel_is_a_few_kilobytes():
    """Most of it are the parameters of the controllers' slots; the table of a tunnel is not in it."""
    block = scene_from_components()
    assert SCENE.itemsize <= 6000
    rows = new_rows(ObjectCapacities())
    assert len(block.tobytes() + pack_rows(rows, block[0]["objects"])) == SCENE.itemsize
    block[0]["objects"]["tunnels"] = 1
    assert len(pack_rows(rows, block[0]["objects"])) == TUNNEL.itemsize > 15_000
