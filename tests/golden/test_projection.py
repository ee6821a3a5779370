"""Where a known point lands on the screen, from any eye, however far from the origin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.contracts.errors import UsageError
from mimics_app.rendering.visual.displays.desktop import compute_tangents, desktop_views
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.view import View, compute_frustum_planes
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import ring, sphere
from mimics_app.world.content.world import World
from tests.golden.demo_world import make_tunnel_world
from tests.golden.drawing import SIZE, draw_offscreen, draw_world

F8 = NDArray[np.float64]

PLAIN = RenderSettings(msaa=4, shadow_size=0, tone_map="none", fog_density=0.0)
# A disc of radius r px drawn with n samples per pixel: the centroid's error falls with the number of samples on its
# outline, about 0.3 / (r sqrt(n)) px = 0.01 px for r = 15 px, n = 4.
CENTROID_TOLERANCE_PX = 0.05


def make_disc_world(points: list[F8], eye_axes: F8, radius: float) -> World:
    """White discs at points of the world, parallel to the eye's picture, on black."""
    world = World()
    world.environment = Sky((0.0,) * 3, (0.0,) * 3, (0.0,) * 3, 0.0)
    world.set_material(Material("white", "unlit", (1.0, 1.0, 1.0, 1.0)))
    world.meshes["disc"] = ring(0.0, radius, segments=256)
    # The ring faces +y; turn its y to the eye's back and its z to the eye's -y: a proper rotation.
    turn = eye_axes @ np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    for point in points:
        node = world.root.create_child("", point, quaternion(turn))
        node.create_entity("disc", "white")
    world.update()
    return world


def quaternion(rotation: F8) -> F8:
    """xyzw of a rotation matrix, from the eigenvector of its axis-angle form."""
    m = rotation
    k = np.array(
        [
            [m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2]],
            [m[0, 1] + m[1, 0], m[1, 1] - m[0, 0] - m[2, 2], m[1, 2] + m[2, 1], m[0, 2] - m[2, 0]],
            [m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], m[2, 2] - m[0, 0] - m[1, 1], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], m.trace()],
        ]
    )
    return np.linalg.eigh(k)[1][:, -1]


def centroid(picture: NDArray[np.uint8]) -> tuple[float, float]:
    """Centre of light [px], x from the left, y from the bottom."""
    light = picture[::-1, :, 0].astype(float)
    x, y = np.arange(light.shape[1]) + 0.5, np.arange(light.shape[0]) + 0.5
    return float((light.sum(0) * x).sum() / light.sum()), float((light.sum(1) * y).sum() / light.sum())


@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), (4.0e5, 120.0, -7.0e5)], ids=["near", "700 km away"])
@pytest.mark.parametrize(
    "tangents",
    [(-0.5, 0.5, -0.4, 0.4), (-0.9434, 1.0599, -0.8, 0.6), (0.1, 0.9, -0.7, -0.05)],
    ids=["symmetric", "headset", "wall beside the eye"],
)
def test_a_point_lands_where_the_closed_form_says(tangents, origin):
    eye = np.array(origin) + [0.3, 1.1, 0.4]
    pose = compose_look_at(eye, eye + [0.4, -0.2, -1.0])
    left, right, bottom, top = tangents
    x, y = left + 0.37 * (right - left), bottom + 0.58 * (top - bottom)
    point = eye + pose[:3, :3] @ (1.3 * np.array([x, y, -1.0]))
    world = make_disc_world([point], pose[:3, :3], 0.03 * (right - left))
    size = (400, 300)
    picture = draw_offscreen(world, [View(pose, tangents, (0, 0, *size))], size, PLAIN)
    assert centroid(picture) == pytest.approx((0.37 * 400, 0.58 * 300), abs=CENTROID_TOLERANCE_PX)


def test_depth_is_minus_one_at_near_and_one_at_far():
    view = View(np.eye(4), (-0.3, 0.5, -0.2, 0.4), (0, 0, 8, 8), 0.25, 40.0)
    for distance, depth in ((0.25, -1.0), (40.0, 1.0)):
        clip = view.clip_from_world @ [0.0, 0.0, -distance, 1.0]
        assert clip[2] / clip[3] == pytest.approx(depth, abs=1e-12)


def test_frustum_corners_lie_on_their_planes():
    pose = compose_look_at((3.0, -2.0, 5.0), (1.0, 0.0, 0.0))
    left, right, bottom, top = tangents = (-0.2, 0.7, -0.5, 0.1)
    view = View(pose, tangents, (0, 0, 8, 8), 0.5, 20.0)
    planes = compute_frustum_planes(view.clip_from_world)
    for depth, plane in ((0.5, 4), (20.0, 5)):
        for x, side in ((left, 0), (right, 1)):
            for y, lower in ((bottom, 2), (top, 3)):
                corner = pose @ np.array([x * depth, y * depth, -depth, 1.0])
                offsets = planes @ corner
                assert np.abs(offsets[[plane, side, lower]]).max() < 1e-11
                assert offsets.min() > -1e-11


def test_a_part_of_a_view_has_its_projection_cropped():
    view = View(compose_look_at((3.0, -2.0, 5.0), (1.0, 0.0, 0.0)), (-0.2, 0.7, -0.5, 0.1), (0, 0, 96, 64), 0.5, 20.0)
    part = view.through((16, 32, 48, 16), (96, 64))
    assert part.tangents == pytest.approx((-0.05, 0.4, -0.2, -0.05))
    assert np.allclose(part.clip_from_world, replace(part).clip_from_world, rtol=0.0, atol=1e-12)


def test_culling_never_takes_what_is_seen(monkeypatch):
    """Random spheres, stretched and sheared, half in and out of an off-axis view: the picture without culling."""
    rng = np.random.default_rng(11)
    world = World()
    world.environment = Sky((0.0,) * 3, (0.0,) * 3, (0.0,) * 3, 0.0)
    world.set_material(Material("white", "unlit", (1.0, 1.0, 1.0, 1.0)))
    world.meshes["ball"] = sphere(0.1, 12)
    for _ in range(150):
        parent = world.root.create_child("", rng.uniform(-3.0, 3.0, 3), rng.normal(size=4), rng.uniform(0.3, 3.0, 3))
        parent.create_child("", rng.uniform(-0.2, 0.2, 3), rng.normal(size=4)).create_entity("ball", "white")
    world.update()
    view = View(compose_look_at((0.0, 0.0, 2.0), (0.0, 0.0, 0.0)), (-0.2, 0.6, -0.5, 0.3), (0, 0, *SIZE))
    with create_surface("egl", SIZE) as surface:
        culled = draw_world(surface, world, [view], PLAIN)
        fewer = Renderer(surface, world, PLAIN).draw([view]).triangles
        monkeypatch.setattr(View, "frustum_planes", np.array([[0.0, 0, 0, 1.0]] * 6))
        whole = draw_world(surface, world, [replace(view)], PLAIN)
        every = Renderer(surface, world, PLAIN).draw([replace(view)]).triangles
    assert np.array_equal(culled, whole)
    assert 0 < fewer < 0.7 * every, "the test's spheres are to be half in and half out"


def test_two_views_side_by_side_equal_each_alone():
    world = make_tunnel_world()
    pose = desktop_views(world.cameras[0], SIZE)[0].world_from_eye
    eyes = []
    for shift in (-0.03, 0.03):
        eye = pose.copy()
        eye[:3, 3] += shift * pose[:3, 0]
        eyes.append(eye)
    tangents = [(-0.4, 0.5, -0.4, 0.4), (-0.5, 0.4, -0.4, 0.4)]
    both = [
        View(eye, t, (200 * i, 0, 200, 180), screen=i) for i, (eye, t) in enumerate(zip(eyes, tangents, strict=True))
    ]
    settings = RenderSettings(msaa=4)
    together = draw_offscreen(world, both, (400, 180), settings)
    for i in range(2):
        alone = draw_offscreen(world, [View(eyes[i], tangents[i], (0, 0, 200, 180))], (200, 180), settings)
        away = np.abs(together[:, 200 * i : 200 * (i + 1)].astype(int) - alone)
        # The rectangle's place enters the rasteriser's float32: single pixels round to the next code value.
        assert away.max() <= 1
        assert (away > 0).mean() < 0.001


@pytest.mark.parametrize("double_sided", [False, True])
def test_a_mirrored_node_keeps_its_outside(double_sided):
    """A negative scale turns faces over; what the mesh calls outside must be lit and seen still."""
    world = World()
    world.environment = Sky((0.0,) * 3, (0.0,) * 3, (0.0,) * 3, 0.0)
    world.set_material(Material("white", roughness=1.0, double_sided=double_sided))
    world.meshes["ball"] = sphere(0.3, 64)
    world.root.create_child("ball", scale=(-1.0, 1.0, 1.0)).create_entity("ball", "white")
    sun = world.root.create_child("sun", (0.0, 0.0, 5.0))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", intensity=1.0)
    world.update()
    view = View(compose_look_at((0.0, 0.0, 2.0), (0.0, 0.0, 0.0)), compute_tangents(0.5, (64, 64)), (0, 0, 64, 64))
    assert draw_offscreen(world, [view], (64, 64), PLAIN)[32, 32, 0] > 200


@pytest.mark.parametrize("tangents", [(0.2, 0.2, -1.0, 1.0), (-1.0, 1.0, 0.5, -0.5)])
def test_an_empty_frustum_is_refused(tangents):
    with pytest.raises(UsageError):
        View(np.eye(4), tangents, (0, 0, 8, 8))


def test_a_frame_without_views_is_refused():
    with create_surface("egl", (16, 16)) as surface, pytest.raises(UsageError):
        Renderer(surface, World()).draw([])


def test_a_camera_without_a_far_plane_draws_what_one_far_away_does():
    """glTF lets a camera leave `zfar` out."""
    world = World()
    world.set_material(Material("m", "unlit", (0.8, 0.1, 0.4, 1.0)))
    world.meshes["ball"] = sphere(0.5, 32)
    for distance in (2.0, 40.0, 900.0):
        place = (0.02 * distance, 0.1 * distance - 0.3, -distance)
        world.root.create_child(f"ball{distance}", place, scale=(0.1 * distance,) * 3).create_entity("ball", "m")
    world.update()
    pictures = [
        draw_offscreen(world, [View(np.eye(4), (-0.4, 0.4, -0.3, 0.3), (0, 0, *SIZE), 0.1, far)], SIZE, PLAIN)
        for far in (1e6, np.inf)
    ]
    assert len(np.unique(pictures[0].reshape(-1, pictures[0].shape[-1]), axis=0)) > 3, "there is something to see"
    assert np.array_equal(*pictures)
