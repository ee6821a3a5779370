"""What a whole run rendered, against the printed equations of D2.1 in their right form, written again in numpy.

The kernels have tests of their own; here the parts are together, as a person feels them: robot frame and world frame,
sign of the force on the user, velocity of the object, parameters of the very tick. Nothing of the product computes an
expected value: the spline is scipy's, the closest point is found by search, contacts from the poses of the scene file.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.spatial.transform import Rotation

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.system.resources import root
from tests.support.core_play import CorePlay, change_component
from tests.support.object_scenes import at, thing, written
from tests.support.scene_play import ScenePlay
from tests.support.scenes import write

D1 = 0.46
"""Offset of the world's origin from the robot's axis, equation 1 [m]."""
TICK = 1e-3
RADIUS = 0.019
"""Radius of the tunnel, the same everywhere [m]."""
K, B = 900.0, 6.0
"""Stiffness [N/m] and damping [N s/m] of the objects."""
MASS, DRAG = 2.0, 30.0
"""Mass [kg] and drag [N s/m] of the ball that floats."""
BALL, CUBE, CAN = (0.0, 0.385, 0.0), (-0.11, 0.3, 0.0), (0.12, 0.29, 0.01)
TURN_OF_CUBE, TURN_OF_CAN = Rotation.from_euler("xyz", (0.3, 0.5, -0.2)), Rotation.from_euler("xyz", (1.0, 0.4, 0.1))
EDGE, CAN_RADIUS, CAN_LENGTH, BALL_RADIUS = 0.08, 0.035, 0.1, 0.045
"""Sizes [m]; a thinner can would let a hand through below the force limit of 60 N, and `check` refuses it."""


@pytest.fixture(scope="module")
def tunnel(tmp_path_factory: pytest.TempPathFactory) -> CorePlay:
    """The wavy tunnel with a constant radius and a wavering patient."""
    document = json.loads((root() / "scenes" / "wavy_tunnel.json").read_text(encoding="utf-8"))
    document["entities"][0]["components"]["tunnel"]["radius"] = RADIUS
    scene = load_checked_scene(write(tmp_path_factory.mktemp("tunnel"), {**document, "scenario": "wavy_tunnel"}))
    change_component(scene, "patient", preset="severe")
    play = CorePlay.of(scene, 3)
    for _ in range(12 * 60):
        play.step()
    return play


@pytest.fixture(scope="module", params=["ball", "cube", "can"])
def visited(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, ScenePlay]:
    """A ball that floats, a cube and a can that cannot move, all smooth; a simulated person visits one of them."""
    surface = {"stiffness": K, "damping": B, "friction_dynamic": 0.0, "friction_static": 0.0}
    fixed = {"enable_translation": False, "enable_rotation": False, **surface}
    ball = {
        "shapes": [{"shape": "sphere", "radius": BALL_RADIUS}],
        "mass": MASS,
        "environment_translation_damping": DRAG,
        "sleeps": False,
        "integrator": "exact_drag",
        **surface,
    }
    cube = {"shapes": [{"shape": "cube", "size": [EDGE] * 3}], **fixed}
    can = {"shapes": [{"shape": "cylinder", "radius": CAN_RADIUS, "length": CAN_LENGTH}], **fixed}
    folder: Path = tmp_path_factory.mktemp("equations")
    file = written(
        folder,
        at(*BALL, thing("ball", haptic_object=ball)),
        at(*CUBE, thing("cube", haptic_object=cube), rotation=list(TURN_OF_CUBE.as_quat())),
        at(*CAN, thing("can", haptic_object=can), rotation=list(TURN_OF_CAN.as_quat())),
        {"id": "robot", "prefab": "robot"},
        {"id": "patient", "prefab": "patient", "components": {"patient": {"visits": [request.param]}}},
        include=["mimics:scenes/parts/touch_room.json"],
        task={"title": "Visits", "goals": [{"kind": "duration", "seconds": 60}], "time_limit_s": 90},
    )
    return request.param, ScenePlay(file).run(9.0)


def joints(samples: Any) -> tuple[Any, Any, Any]:
    return samples["q"][:, 0], samples["q"][:, 1], samples["q"][:, 2]


def to_world(block: Any, robot: Any) -> Any:
    return robot @ np.asarray(block[0]["R_world_from_robot"]).T + np.asarray(block[0]["origin_world"])


def test_1_and_4_joints_are_where_and_as_fast_as_the_hip(tunnel: CorePlay) -> None:
    samples, block = tunnel.samples, next(iter(tunnel.recorder.blocks.values()))
    q1, q2, q3 = joints(samples)
    place = np.stack([(q1 + D1) * np.cos(q2) - D1, (q1 + D1) * np.sin(q2), q3], 1)
    np.testing.assert_allclose(to_world(block, place), samples["hip_world"][:, :3], atol=1e-15)
    dq1, dq2, dq3 = samples["dq"][:, 0], samples["dq"][:, 1], samples["dq"][:, 2]
    speed = np.stack(
        [dq1 * np.cos(q2) - (q1 + D1) * np.sin(q2) * dq2, dq1 * np.sin(q2) + (q1 + D1) * np.cos(q2) * dq2, dq3], 1
    )
    turned = speed @ np.asarray(block[0]["R_world_from_robot"]).T
    np.testing.assert_allclose(turned, samples["v_world"][:, :3], atol=1e-15)


def test_6_and_7_measured_and_virtual_force_accelerate_three_kilograms(tunnel: CorePlay) -> None:
    samples, block = tunnel.samples, next(iter(tunnel.recorder.blocks.values()))[0]
    mass, damping = float(block["virtual_mass"]), float(block["virtual_damping"])
    assert mass == 3.0
    _, q2, _ = joints(samples)
    radial, tangential, vertical = samples["f_meas"][:, 0], samples["f_meas"][:, 1], samples["f_meas"][:, 2]
    measured = np.stack(
        [np.cos(q2) * radial - np.sin(q2) * tangential, np.sin(q2) * radial + np.cos(q2) * tangential, vertical], 1
    )
    force = measured + samples["f_user_world"][:, :3] @ np.asarray(block["R_world_from_robot"])
    v = samples["v_virtual"]
    acceleration = (force[1:] - damping * v[:-1]) / mass
    length = np.linalg.norm(acceleration, axis=1, keepdims=True)
    acceleration *= np.minimum(1.0, float(block["max_acceleration"]) / np.maximum(length, 1e-300))
    active = (samples["state"][1:] == SafetyState.ACTIVE) & (samples["held"][1:] == 0)
    assert active.sum() > 3000 and np.abs(samples["f_user_world"][1:][active]).max() > 2.0
    np.testing.assert_allclose(v[1:][active], (v[:-1] + TICK * acceleration)[active], atol=1e-14)


def closest(spline: BSpline, end: float, points: Any) -> Any:
    """Parameters of the points of the curve closest to these: a search on a grid, then Newton's method."""
    grid = np.linspace(0.0, end, 4001)
    curve = spline(grid)
    s = np.array([grid[np.argmin(np.sum((curve - p) ** 2, axis=1))] for p in points])
    for _ in range(6):
        e, first, second = points - spline(s), spline(s, 1), spline(s, 2)
        slope = np.sum(e * second, 1) - np.sum(first * first, 1)
        s = np.clip(s - np.sum(e * first, 1) / slope, 0.0, end)
    return s


def test_4_2_10_tunnel_is_a_spring_and_damper_about_its_spline(tunnel: CorePlay) -> None:
    samples = tunnel.samples[tunnel.samples["state"] == SafetyState.ACTIVE]
    document = json.loads((root() / "scenes" / "wavy_tunnel.json").read_text(encoding="utf-8"))
    points = np.array(document["entities"][0]["components"]["tunnel"]["control_points"])
    end = float(len(points) - 3)
    spline = BSpline(np.concatenate([[0.0] * 3, np.arange(end + 1.0), [end] * 3]), points, 3)
    hip, v = samples["hip_world"][:, :3], samples["v_world"][:, :3]
    s = closest(spline, end, hip)
    inside = (s > 1e-6) & (s < end - 1e-6)
    tangent = spline(s, 1) / np.linalg.norm(spline(s, 1), axis=1, keepdims=True)
    e = hip - spline(s)
    rho = np.linalg.norm(e, axis=1)
    rows = [tunnel.recorder.rows[sequence].tunnels[0] for sequence in samples["sequence"].astype(int)]
    k, b, drag, growth, scale = (
        np.array([float(row[name]) for row in rows])
        for name in ("stiffness", "damping", "drag", "drag_growth", "radius_scale")
    )
    ball = samples["ball_radius"]
    swelling = np.diff(ball, prepend=ball[0]) / TICK
    room = np.maximum(0.0, scale * RADIUS - ball)
    depth = rho - room
    outward = e / np.maximum(rho, 1e-300)[:, None]
    rate = np.sum(v * outward, 1) + swelling * (room > 0.0)
    push = np.where(depth > 0.0, np.maximum(0.0, k * depth + b * rate), 0.0)
    along = (drag + growth * np.maximum(0.0, ball - scale * RADIUS)) * np.sum(v * tangent, 1)
    expected = -push[:, None] * outward - along[:, None] * tangent
    assert (depth[inside] > 0.0).sum() > 200 and push[inside].max() > 2.0
    assert samples["stiffness_share"].min() == 1.0, "nothing is softened here"
    inside[0] = False  # the ball's size in the tick before is not known
    np.testing.assert_allclose(samples["f_virt_world"][:, :3][inside], expected[inside], atol=1e-9)


def flown(samples: Any) -> tuple[Any, Any]:
    """Places and velocities of the ball at every tick by (11), from the force it was touched with."""
    place, velocity = np.empty((len(samples), 3)), np.empty((len(samples), 3))
    p, v = np.array(BALL), np.zeros(3)
    decay = np.exp(-DRAG * TICK / MASS)
    for i, row in enumerate(samples):
        place[i], velocity[i] = p, v
        steady = (-row["f_shapes"] if row["touched_shape"] == 0 else np.zeros(3)) / DRAG
        p = p + steady * TICK + (v - steady) * (1.0 - decay) * MASS / DRAG
        v = decay * v + (1.0 - decay) * steady
    return place, velocity


def sphere_contact(p: Any, _: Any) -> tuple[float, Any]:
    """(13): depth and outward normal, in the frame of the object."""
    length = np.linalg.norm(p)
    return BALL_RADIUS - length, p / length


def cube_contact(p: Any, entry: Any) -> tuple[float, Any]:
    """(14) with the face of entry: the last of the planes of its faces that the way in crossed."""
    before, after = entry
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(
            np.abs(before) >= EDGE / 2, (np.abs(before) - EDGE / 2) / (np.abs(before) - np.abs(after)), -1.0
        )
    axis = int(np.argmax(share))
    normal = np.zeros(3)
    normal[axis] = np.sign(before[axis])
    return EDGE / 2 - normal[axis] * p[axis], normal


def can_contact(p: Any, entry: Any) -> tuple[float, Any]:
    """(15), its axis along y: the side, or the cap whose plane the way in crossed inside the rim."""
    before, after = entry
    if abs(before[1]) >= CAN_LENGTH / 2:
        share = (abs(before[1]) - CAN_LENGTH / 2) / (abs(before[1]) - abs(after[1]))
        crossing = before + share * (after - before)
        if np.hypot(crossing[0], crossing[2]) < CAN_RADIUS:
            side = np.sign(before[1])
            return CAN_LENGTH / 2 - side * p[1], np.array([0.0, side, 0.0])
    rho = np.hypot(p[0], p[2])
    return CAN_RADIUS - rho, np.array([p[0], 0.0, p[2]]) / rho


def test_8_to_15_objects_push_back_by_the_depth_below_the_face_of_entry(visited: tuple[str, ScenePlay]) -> None:
    name, play = visited
    samples = play.samples
    place, velocity = flown(samples)
    still = np.zeros_like(place)
    contact, turn, centre, moving = {
        "ball": (sphere_contact, Rotation.identity(), place, velocity),
        "cube": (cube_contact, TURN_OF_CUBE, still + CUBE, still),
        "can": (can_contact, TURN_OF_CAN, still + CAN, still),
    }[name]
    hip, v = samples["hip_world"][:, :3], samples["v_world"][:, :3]
    local = turn.inv().apply(hip - centre)
    touched = samples["touching"] == 1
    assert touched.sum() > 50, "it was not visited"
    entry: Any = None
    for i in np.flatnonzero(touched):
        if not touched[i - 1]:
            entry = (local[i - 1], local[i])
        depth, normal = contact(local[i], entry)
        outward = turn.apply(normal)
        force = max(0.0, K * depth + B * np.dot(moving[i] - v[i], outward))
        np.testing.assert_allclose(samples["f_shapes"][i], force * outward, atol=1e-9, err_msg=f"tick {i}")


def test_11_ball_flies_by_the_opposite_force(visited: tuple[str, ScenePlay]) -> None:
    name, play = visited
    place, _ = flown(play.samples)
    assert (np.linalg.norm(place[-1] - BALL) > 0.02) == (name == "ball"), "it was pushed away, where it was visited"
    np.testing.assert_allclose(play.pose("ball")[:3], place[-1], atol=1e-9)
