"""Two legs and two hands, each point of contact at an object of its own: to the bit as if it were alone.

The oracle is the device with one point and the same motion, which has no second point to be confused with.
"""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.device_descriptor import KINEMATICS, DeviceDescriptor, Joint, Kinematics
from mimics_app.contracts.loop.haptic import POINT_SAMPLE, EventKind, SafetyState, point_of_body
from mimics_app.contracts.loop.haptic_objects import OBJECT_COUNTS, TUNNEL, EffectKind, ShapeKind
from mimics_app.contracts.loop.loop_fields import point_rows
from mimics_app.contracts.loop.loop_ports import DATA_DQ, DATA_FORCE, DATA_GRASP, DATA_Q, DevicePlugin
from mimics_app.contracts.loop.object_rows import ObjectCapacities, new_rows
from mimics_app.rendering.haptic.descriptors.leg import LEGS
from mimics_app.rendering.haptic.kernels.leg_kinematics import leg_jacobian, place_foot
from mimics_app.rendering.haptic.mesh_table import build_mesh_table
from mimics_app.rendering.haptic.objects import new_object_work
from mimics_app.rendering.haptic.scene_block import kinematic_values
from mimics_app.rendering.haptic.tunnel_geometry import build_tunnel
from mimics_app.world.components.robot import Robot
from tests.support.body_play import FREE, Play
from tests.support.chain import data_rows, read_rows
from tests.support.effect_bench import effect
from tests.support.haptic_bench import Bench, bench_of, ignore
from tests.support.touch_play import add_point

TICKS = 2600
QUIET = 700
"""Ticks at rest: the soft start is over by then."""

TO_WORLD = np.array(Robot().robot_to_world.rotation)
ORIGIN = np.array(Robot().robot_to_world.translation)
BALL = 0.004


@typed_kernel(KINEMATICS)
def places(geometry, q, given, out):
    """Three straight joints for each hand."""
    for i in range(3 * int(geometry[0])):
        out[i] = q[i]
    return 0


@typed_kernel(KINEMATICS)
def places_by_joint(geometry, q, given, out):
    n = 3 * int(geometry[0])
    for i in range(n * n):
        out[i] = 1.0 if i % (n + 1) == 0 else 0.0
    return 0


@typed_kernel(KINEMATICS)
def left_foot(geometry, q, given, out):
    place_foot(geometry, 0, q[0:2], out[0:3])
    return 0


@typed_kernel(KINEMATICS)
def right_foot(geometry, q, given, out):
    place_foot(geometry, 1, q[0:2], out[0:3])
    return 0


@typed_kernel(KINEMATICS)
def foot_by_joint(geometry, q, given, out):
    out[0], out[1], out[4], out[5] = leg_jacobian(geometry, q[0:2])
    out[2], out[3] = 0.0, 0.0
    return 0


def hands(count: int) -> DeviceDescriptor:
    joint = Joint("way", "m", -1.0, 1.0, 3.0, 50.0)
    kinematics = Kinematics(places, places_by_joint)
    return DeviceDescriptor((joint,) * (3 * count), ("left hand", "right hand")[:count], kinematics, lambda _: (count,))


def legs(alone: int | None) -> DeviceDescriptor:
    """Both legs, or one in its place beside the other."""
    forward, jacobian = LEGS.kinematics.forward, LEGS.kinematics.jacobian
    if alone is None:
        return DeviceDescriptor(LEGS.joints, LEGS.contacts, Kinematics(forward, jacobian), LEGS.geometry)
    own = Kinematics((left_foot, right_foot)[alone], foot_by_joint)
    return DeviceDescriptor(LEGS.joints[:2], LEGS.contacts[alone : alone + 1], own, LEGS.geometry)


def swing(ticks: int, sizes: tuple[float, ...], hertz: tuple[float, ...]) -> np.ndarray:
    """A way that begins at rest and comes back, shape [ticks, joints]."""
    t = np.maximum(0.0, (np.arange(ticks) - QUIET) / 1000.0)[:, None]
    return np.array(sizes) * np.sin(2.0 * np.pi * np.array(hertz) * t) * np.minimum(1.0, t / 0.3)


HANDS_AT = ((0.0, 0.15, 0.0), (0.02, -0.15, 0.01))
LEGS_AT = ((0.3, 0.8), (0.2, 0.7))
MOTION = {
    "hands": (
        np.array(HANDS_AT[0]) + swing(TICKS, (0.02, 0.015, 0.01), (0.8, 1.3, 0.7)),
        np.array(HANDS_AT[1]) + swing(TICKS, (0.015, -0.02, 0.012), (1.1, 0.9, 1.4)),
    ),
    "legs": (
        np.array(LEGS_AT[0]) + swing(TICKS, (0.05, 0.04), (0.8, 1.3)),
        np.array(LEGS_AT[1]) + swing(TICKS, (-0.04, 0.05), (1.1, 0.9)),
    ),
}


def start_of(kind: str, point: int) -> np.ndarray:
    """Where a point is at rest, world [m]."""
    if kind == "hands":
        return TO_WORLD @ np.array(HANDS_AT[point]) + ORIGIN
    x, q = np.zeros(6), np.array([*LEGS_AT[0], *LEGS_AT[1]])
    LEGS.kinematics.forward(LEGS.geometry_of(Robot()), q, np.zeros(4), x)
    return TO_WORLD @ x[3 * point : 3 * point + 3] + ORIGIN


def data_of(kind: str, points: tuple[int, ...]) -> np.ndarray:
    """What the device reads: joints of each point, its force on the user's sensor, its grasp."""
    rows, joint = data_rows(TICKS), 0
    for c, point in enumerate(points):
        q = MOTION[kind][point]
        rows[:, DATA_Q + joint : DATA_Q + joint + q.shape[1]] = q
        rows[:-1, DATA_DQ + joint : DATA_DQ + joint + q.shape[1]] = np.diff(q, axis=0) / 1e-3
        joint += q.shape[1]
        rows[:, DATA_FORCE + 3 * c] = 0.5 + point
        rows[:, DATA_GRASP + c] = 4.0 + point
    return rows


def tunnel_at(start: np.ndarray, contact: int) -> np.ndarray:
    row = np.zeros(1, TUNNEL)
    build_tunnel([start - [0.06, 0.0, 0.0], start + [0.06, 0.0, 0.0]], 0.012).fill(row[0])
    for name, value in {"radius_scale": 1.0, "stiffness": 400.0, "damping": 2.0, "centring": 10.0}.items():
        row[0][name] = value
    row[0]["contact"] = contact
    return row


def bench(kind: str, descriptor: DeviceDescriptor, points: tuple[int, ...]) -> Bench:
    """Every point has a tunnel, a spring, a fixed sphere and, in its hand, a body; all are there in every bench."""
    room = ObjectCapacities(shapes=8, bodies=4, effects=4, tunnels=2)
    play = Play(new_rows(room), new_object_work(room, build_mesh_table()), np.zeros(1, OBJECT_COUNTS))
    tunnels = []
    number = {point: c for c, point in enumerate(points)}
    for point in (0, 1):
        start, contact = start_of(kind, point), number.get(point, 1)
        tunnels.append(tunnel_at(start, contact))
        spring = effect(EffectKind.SPRING, stiffness=60.0 + 20.0 * point, damping=1.0, position=start, contact=contact)
        play.rows.effects[point] = spring[0]
        fixed = {"stiffness": 300.0, "damping": 1.0, "friction_static": 0.4, "friction_dynamic": 0.3}
        play.add_shape(ShapeKind.SPHERE, (0.01,), position=tuple(start + [0.0, 0.022, 0.0]), **fixed)
        body = play.add_body(0.2, 1e-4 * np.eye(3), position=tuple(start), flags=FREE, grip=1, gravity=(0.0, 0.0, 0.0))
        surface = {"stiffness": 200.0, "damping": 2.0, "friction_static": 0.8, "friction_dynamic": 0.7}
        play.add_shape(ShapeKind.SPHERE, (0.008,), body, **surface)
    play.counts[0]["effects"] = 2
    for contact in range(len(points)):
        add_point(play, radius=BALL)
        play.rows.points["contact"][contact] = contact
    memory = data_of(kind, points).ravel()
    plugin = DevicePlugin("scripted", read_rows, ignore, memory, follows="force", descriptor=descriptor)
    made = bench_of(plugin, straight=None, objects=play.work, capacities={"objects": room})
    made.scene[0]["objects"] = play.counts[0]
    made.rows = play.rows._replace(tunnels=np.concatenate(tunnels))
    made.publish(
        rows=made.rows,
        **kinematic_values(Robot(), descriptor),
        **{"force_driven": 1, "controller": Slot.PERSON, "virtual_damping": 1.0, "own_tunnel": points[0]},
        **{"velocity_limit": 5.0, "arm_damping": 30.0, "passivity": 1, "passivity_damping": 40.0, "device_mass": 1.0},
    )
    return made


@pytest.mark.parametrize("kind", ["hands", "legs"])
def test_each_of_two_points_is_to_the_bit_as_if_it_were_alone(kind: str) -> None:
    both = bench(kind, hands(2) if kind == "hands" else legs(None), (0, 1))
    together = both.advance(TICKS)
    assert (together["state"][-1], together["cause"].max()) == (SafetyState.ACTIVE, 0)
    events = both.engine.events()
    assert {point_of_body(int(each["body_a"])) for each in events} == {0, 1}
    for point in (0, 1):
        own = bench(kind, hands(1) if kind == "hands" else legs(point), (point,))
        alone = own.advance(TICKS)
        mine = point_rows(together, point)
        for name in ("f_shapes", "f_effects", "f_grip", "f_tunnel", "f_user_world"):
            assert np.abs(mine[name]).max() > 0.05, f"{name}: the point {point} is at an object of every kind"
        assert mine["held_body"].max() == point and mine["penetration"].max() > 0.0 and mine["energy"].any()
        differing = [name for name in POINT_SAMPLE.names or () if mine[name].tobytes() != alone[name].tobytes()]
        assert differing == [], f"point {point}"
        assert np.array_equal(together["state"], alone["state"])


@pytest.mark.parametrize("kind", ["hands", "legs"])
def test_contacts_of_each_point_have_their_own_events(kind: str) -> None:
    both = bench(kind, hands(2) if kind == "hands" else legs(None), (0, 1))
    both.advance(TICKS)
    recorded = both.engine.events()
    for point in (0, 1):
        own = bench(kind, hands(1) if kind == "hands" else legs(point), (point,))
        own.advance(TICKS)
        wanted = [
            each for each in own.engine.events() if each["kind"] in (EventKind.CONTACT_BEGIN, EventKind.CONTACT_END)
        ]
        found = [
            each
            for each in recorded
            if each["kind"] in (EventKind.CONTACT_BEGIN, EventKind.CONTACT_END)
            and point_of_body(int(each["body_a"])) == point
        ]
        assert len(wanted) >= 2
        names = ("tick", "kind", "body_b", "position_world", "normal_world", "speed", "force", "value")
        for one, other in zip(found, wanted, strict=True):
            assert [one[name].tobytes() for name in names] == [other[name].tobytes() for name in names]


def test_what_is_recorded_of_two_points_is_replayed_bit_for_bit() -> None:
    both = bench("hands", hands(2), (0, 1))
    samples = both.advance(TICKS)
    again = both.replay(samples)
    for name in samples.dtype.names or ():
        if name not in ("lateness_ns", "duration_ns"):
            assert samples[name].tobytes() == again[name].tobytes(), name
