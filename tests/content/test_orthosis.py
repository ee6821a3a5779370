"""The drawn orthosis: its parts follow hips and knees over a gait cycle, its drives are as long as the simulated ones.

The oracle of the lengths is the plant's linkage at the joint angles that turn the legs; the oracle of the
cuffs is the person's skin as it is bent in each frame.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from mimics_app.app.scenes.loading import check_scene, read_scene
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system.resources import root
from mimics_app.maths.gait_series import knee_series, series_at, step_of, thigh_series
from mimics_app.rendering.haptic.devices.simulated_lokomat import SETTINGS
from mimics_app.rendering.haptic.kernels.lokomat.linkage import eta_of
from mimics_app.scenarios.parts.touch_scene import TouchScene
from mimics_app.world.content.world import World
from mimics_app.world.files.gltf.file import load_gltf
from mimics_app.world.files.scene.world_construction import build
from tests.support.core_play import change_component

SCENES = [root() / "scenes" / "examples" / f"lokomat_{name}.json" for name in ("free_swing", "wall", "obstacle")]
MODEL = root() / "assets" / "models" / "orthosis" / "orthosis.glb"
HEIGHT, SPEED, PHASES = 1.75, 0.6, 12
SIDES = ("left", "right")
CUFFS = [("thigh", -0.195), ("thigh", -0.343), ("shank", -0.120), ("shank", -0.294)]
"""Segment and height of the middle of each cuff relative to hip or knee [m]."""
BINS = 24
SCALE = 1.021
"""Of the person in the scenes."""


@dataclass
class Phase:
    """One frame of the walk: joints of both legs [rad], world matrices of entities, skin [m]."""

    q: F8
    poses: dict[str, F8]
    skin: F8

    def distance(self, first: str, second: str) -> float:
        return float(np.linalg.norm(self.poses[first][:3, 3] - self.poses[second][:3, 3]))


@pytest.fixture(scope="module")
def walk() -> list[Phase]:
    """A gait cycle by the joints of the device, as in a session."""
    scene = check_scene(read_scene(SCENES[0]))
    world, phases = build(scene), []
    for number in range(PHASES):
        q = np.concatenate([_joints((number / PHASES + 0.5 * leg) % 1.0) for leg in range(2)])
        world.motion.joints = q
        world.motion.time += 0.1
        world.update()
        names = [entity.id for entity in scene.entities if entity.id in world]
        phases.append(Phase(q, {name: world.find(name).world_matrix().copy() for name in names}, _skin(world)))
    return phases


def _joints(phase: float) -> F8:
    """Hip and knee of the reference at a phase [rad]."""
    knee, least = knee_series(HEIGHT)
    angles = []
    for series, x in ((thigh_series(HEIGHT), step_of(SPEED, HEIGHT)), (knee, float(np.hypot(SPEED, least)))):
        angles += series_at(np.array([1.0, x, x * x]) @ series, np.array([phase])).tolist()
    return np.array(angles)


def _skin(world: World) -> F8:
    """Points all over skin and clothes in the finest level, world [m]."""
    shares = np.array([(i, j, 8 - i - j) for i in range(9) for j in range(9 - i)]) / 8.0
    clouds = []
    for body in world.motion.bodies.values():
        pose = world.node(body.entity).world_matrix()
        number = {key: int(key.partition("#")[2].partition("/")[0]) for key in body.meshes}
        for key in (key for key in body.meshes if number[key] == min(number.values())):
            points = world.mesh_positions(key) @ pose[:3, :3].T + pose[:3, 3]
            corners = points[body.meshes[key].indices.reshape(-1, 3)]
            clouds.append(np.einsum("tcx,sc->tsx", corners, shares).reshape(-1, 3))
    return np.concatenate(clouds)


def test_the_model_is_moderate() -> None:
    document = load_gltf(MODEL)
    assert 8_000 < sum(part.mesh.triangle_count for mesh in document.meshes for part in mesh.primitives) < 30_000
    assert sum(file.stat().st_size for file in MODEL.parent.iterdir()) < 1_500_000


@pytest.mark.parametrize("scene", SCENES, ids=lambda file: file.stem)
def test_all_three_scenes_show_it(scene) -> None:
    shown = {entity.id for entity in check_scene(read_scene(scene)).entities}
    assert {"treadmill", "frame", "harness", "left_thigh", "right_shank", "left_knee_rod", "ego", "shoulder"} <= shown


def test_a_drawn_drive_is_as_long_as_the_simulated_one(walk) -> None:
    """Within a millimetre over the cycle, while the shafts move by 3 cm and more."""
    for leg, side in enumerate(SIDES):
        for joint, name in enumerate(("hip", "knee")):
            link = np.array([*(SETTINGS[f"{name}_{what}"] for what in ("fixed_arm", "moved_arm", "offset")), -1.0])
            drawn = np.array([phase.distance(f"{side}_{name}_pivot", f"{side}_{name}_lever") for phase in walk])
            eta = np.array([eta_of(link, float(phase.q[2 * leg + joint])) for phase in walk])
            assert np.abs(drawn - eta).max() < 1e-3 and np.ptp(eta) > 0.03


def test_housing_and_rod_lie_on_one_line_and_overlap(walk) -> None:
    """Neither ends before the other begins, nor beyond the other's pivot by more than its eye."""
    document = load_gltf(MODEL)
    long = {
        mesh.name: -min(float(part.mesh.positions[:, 2].min()) for part in mesh.primitives) for mesh in document.meshes
    }
    for phase in walk:
        for side in SIDES:
            for joint in ("hip", "knee"):
                drive, rod = (phase.poses[f"{side}_{joint}_{what}"] for what in ("drive", "rod"))
                between = rod[:3, 3] - drive[:3, 3]
                distance = float(np.linalg.norm(between))
                for pose, sign in ((drive, -1.0), (rod, 1.0)):
                    np.testing.assert_allclose(pose[:3, 2], sign * between / distance, atol=1e-9)
                assert long[f"{joint}_drive"] + long[f"{joint}_rod"] > distance + 5e-3
                assert max(long[f"{joint}_drive"], long[f"{joint}_rod"]) < distance + 0.01


@pytest.mark.parametrize(("segment", "height"), CUFFS)
def test_a_cuff_stays_on_its_segment_and_out_of_the_skin(walk, segment: str, height: float) -> None:
    """Its middle is within 2 cm of the leg's; skin or cloth comes through it by 4 mm at most."""
    shell = _shell(segment, height)
    axis = 0.5 * (shell.min(axis=0) + shell.max(axis=0))
    for phase in walk:
        from_world = np.linalg.inv(phase.poses[f"left_{segment}"])
        leg = phase.skin @ from_world[:3, :3].T + from_world[:3, 3]
        leg = leg[np.abs(leg[:, 1] - height / SCALE) < 0.015]
        leg = leg[(leg[:, 0] > -0.085) & (np.hypot(leg[:, 0], leg[:, 2]) < 0.135)]
        middle = 0.5 * (leg.min(axis=0) + leg.max(axis=0))
        assert np.hypot(*(middle - axis)[[0, 2]]) < 0.02
        through = _radii(leg, axis, np.max) - _radii(shell, axis, np.min)
        assert np.isfinite(through).sum() > 0.5 * BINS and np.nanmax(through) < 0.004


def _shell(segment: str, height: float) -> F8:
    """Vertices of the lower edge of a cuff of the left leg, in the frame of its bone [m]."""
    mesh = next(mesh for mesh in load_gltf(MODEL).meshes if mesh.name == f"left_{segment}")
    points = np.concatenate([part.mesh.positions for part in mesh.primitives]).astype(np.float64)
    below = points[:, 1] - height / SCALE
    return points[(below < -0.012) & (below > -0.045) & (np.hypot(points[:, 0], points[:, 2]) < 0.125)]


def _radii(points: F8, axis: F8, pick: Callable[[F8], float]) -> F8:
    """Smallest or largest distance from an axis by angle, NaN where there is no point [m]."""
    away = points[:, [0, 2]] - axis[[0, 2]]
    bins = np.floor((np.arctan2(away[:, 1], away[:, 0]) / (2.0 * np.pi) + 0.5) * BINS).astype(int) % BINS
    lengths = np.hypot(*away.T)
    return np.array([pick(lengths[bins == k]) if (bins == k).any() else np.nan for k in range(BINS)])


def test_a_leg_is_turned_by_the_device_or_reaches(tmp_path) -> None:
    """Both at once is refused, and so is a device without the joints of two legs."""
    document = json.loads(SCENES[0].read_text())
    reach = {"reach": [{"limb": "left_leg", "target": "hand"}], "joints": True}
    document["entities"].append({"id": "other", "components": {"mesh": {"source": "walker"}, "avatar": reach}})
    file = tmp_path / "both.json"
    file.write_text(json.dumps(document))
    with pytest.raises(SceneError, match="the left leg turns by the joints of the device"):
        check_scene(read_scene(file))
    scene = check_scene(read_scene(SCENES[0]))
    change_component(scene, "robot", device="simulated_leg", settings={})
    with pytest.raises(SceneError, match="has not the joints of two legs"):
        TouchScene(scene, build(scene))
