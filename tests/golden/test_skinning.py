"""Both ways to bend a body against float64: what lies in the buffer all passes draw from, and what is seen."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.motion.posing import mix_duals, mix_matrices
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.model_world import load_model_world
from tests.support.gltf_maker import GltfMaker, write_gltf
from tests.support.skin_maker import add_clip, bar, turn

SIZE = (160, 200)
PLAIN = {"msaa": 0, "shadow_size": 256, "tone_map": "none", "fog_density": 0.0}
TOLERANCE = {"linear": 1e-6, "dual": 2e-6}
"""Of the model's size, in single precision: products of some ten roundings of 6e-8 each."""


def _maker(*, influences: int = 4) -> GltfMaker:
    """A bar of 6 joints that bends and swells, its vertices bound to up to 8 joints."""
    maker = bar(6)
    primitive = maker.more["meshes"][0]["primitives"][0]
    count = maker.accessors[0]["count"]
    rng = np.random.default_rng(2)
    primitive["targets"] = [
        {name: maker.array(rng.normal(size=(count, 3)).astype("f4") * 0.03) for name in ("POSITION", "NORMAL")}
        for _ in range(3)
    ]
    maker.more["meshes"][0]["weights"] = [0.5, 0.0, 0.25]
    if influences > 4:
        attributes = primitive["attributes"]
        attributes["JOINTS_1"] = maker.array(rng.integers(0, 6, (count, 4)).astype(np.uint8))
        attributes["WEIGHTS_1"] = maker.array(rng.uniform(0.0, 0.3, (count, 4)).astype("f4"))
    turns = [(2, "z", 40), (3, "x", -50), (4, "y", 120), (5, "z", 60)]
    channels = [
        (node, "rotation", [0.0, 1.0], [turn(axis, 0), turn(axis, degrees)], "LINEAR") for node, axis, degrees in turns
    ]
    add_clip(maker, "bend", channels)
    return maker


def _world(path: Path, skinning: str, at: float, *, shadow: bool = True) -> World:
    world = load_model_world(path)
    (body,) = world.motion.bodies.values()
    body.skinning = skinning
    (animator,) = world.motion.animators.values()
    animator.play("bend", at=at, speed=0.0)
    world.root.create_light("directional", casts_shadow=shadow)
    world.update()
    return world


def _view() -> View:
    pose = compose_look_at((1.5, 1.5, 4.0), (0.0, 1.0, 0.0))
    return View(pose, (-0.4, 0.4, -0.5, 0.5), (0, 0, *SIZE), 0.1, 50.0)


def _exact(world: World) -> np.ndarray:
    """The body's vertices out of float64 joints: no palette in single precision in between."""
    (body,) = world.motion.bodies.values()
    (mesh,) = body.meshes.values()
    table = world.transforms
    back = np.linalg.inv(table.world[table.row(body.entity)])
    matrices = back @ table.world[table.rows(body.binding.joints)] @ body.binding.inverse_bind
    positions = mesh.positions.astype(np.float64)
    for share, morph in zip(body._morphs, mesh.morphs, strict=True):
        positions += share * morph.positions
    if body.method == "linear":
        return mix_matrices(positions, mesh.weights, matrices[:, :3])
    return mix_duals(positions, mesh.weights, _duals(matrices))


def _duals(matrices: np.ndarray) -> np.ndarray:
    """Dual quaternions of rigid matrices, computed here."""
    found = np.zeros((len(matrices), 8))
    for k, matrix in enumerate(matrices):
        values, vectors = np.linalg.eigh(_davenport(matrix[:3, :3]))
        x, y, z, w = vectors[:, np.argmax(values)]
        tx, ty, tz = matrix[:3, 3]
        found[k] = (x, y, z, w, *_half_product((tx, ty, tz, 0.0), (x, y, z, w)))
    return found


def _davenport(r: np.ndarray) -> np.ndarray:
    """The matrix whose foremost eigenvector is the quaternion xyzw of a rotation (Bar-Itzhack 2000)."""
    (a, b, c), (d, e, f), (g, h, i) = r
    return np.array(
        [
            [a - e - i, d + b, g + c, h - f],
            [d + b, e - a - i, h + f, c - g],
            [g + c, h + f, i - a - e, d - b],
            [h - f, c - g, d - b, a + e + i],
        ]
    )


def _half_product(p: tuple[float, ...], q: tuple[float, ...]) -> np.ndarray:
    """Half of the product of two quaternions xyzw."""
    a, b = np.array(p[:3]), np.array(q[:3])
    return 0.5 * np.append(p[3] * b + q[3] * a + np.cross(a, b), p[3] * q[3] - a @ b)


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
@pytest.mark.parametrize("by", ["processor", "feedback"])
@pytest.mark.parametrize("skinning", ["linear", "dual"])
@pytest.mark.parametrize("influences", [4, 8])
def test_the_vertices_agree_with_float64(tmp_path, by, skinning, influences, backend):
    path = write_gltf(tmp_path / "bar.gltf", _maker(influences=influences).document())
    with create_surface(backend, SIZE) as surface:
        for at in (0.4, 1.0):
            world = _world(path, skinning, at)
            renderer = Renderer(surface, world, RenderSettings(skinning=by, **PLAIN))
            renderer.draw([_view()])
            (body,) = world.motion.bodies.values()
            (name,) = body.meshes
            known = renderer._arena.ranges[name]
            data = np.frombuffer(renderer._arena.vertices.read(), np.float32).reshape(-1, 8)
            ours = data[known.base_vertex : known.base_vertex + known.vertices]
            exact = _exact(world)
            assert np.abs(ours[:, :3] - exact).max() < TOLERANCE[skinning] * 2.0
            assert np.allclose(np.linalg.norm(ours[:, 3:6], axis=1), 1.0, atol=1e-5)
            assert np.abs(exact - body.meshes[name].positions).max() > 0.2, "nothing bent"
            assert surface.ctx.error == "GL_NO_ERROR"
            renderer.release()


def test_both_ways_show_the_same_picture_and_bend_once_for_all_views(tmp_path, assert_same):
    path = write_gltf(tmp_path / "bar.gltf", _maker().document())
    pictures = []
    with create_surface("egl", SIZE) as surface:
        for by in ("processor", "feedback"):
            world = _world(path, "dual", 0.8)
            renderer = Renderer(surface, world, RenderSettings(skinning=by, **PLAIN))
            assert renderer.draw([_view(), _view()]).bent == 104
            assert renderer.draw([_view()]).bent == 0, "what did not move is bent no second time"
            pictures.append(read_pixels(surface))
            renderer.release()
    assert len(np.unique(pictures[0].reshape(-1, 4), axis=0)) > 20
    assert_same(pictures[0], pictures[1], "feedback beside processor")


def test_a_body_that_nobody_sees_is_not_bent(tmp_path):
    path = write_gltf(tmp_path / "bar.gltf", _maker().document())
    with create_surface("egl", SIZE) as surface:
        world = _world(path, "linear", 0.8, shadow=False)
        renderer = Renderer(surface, world, RenderSettings(**PLAIN))
        away = View(compose_look_at((1.5, 1.5, 4.0), (1.5, 1.5, 9.0)), (-0.4, 0.4, -0.5, 0.5), (0, 0, *SIZE))
        assert renderer.draw([away]).bent == 0
        assert renderer.draw([_view()]).bent == 104
        renderer.release()


def test_twist_keeps_its_volume_by_dual_quaternions_alone(tmp_path):
    """Linear blending shrinks the ring half way to cos(angle / 2) of its radius; dual quaternions keep it."""
    maker = bar(2)
    add_clip(maker, "bend", [(2, "rotation", [0.0, 1.0], [turn("y", 0), turn("y", 150)], "LINEAR")])
    path = write_gltf(tmp_path / "bar.gltf", maker.document())
    for skinning, wanted in (("linear", np.cos(np.radians(75.0))), ("dual", 1.0)):
        exact = _exact(_world(path, skinning, 1.0))
        middle = exact[np.abs(exact[:, 1] - 1.0) < 1e-6]
        assert len(middle) == 8
        assert np.allclose(np.hypot(middle[:, 0], middle[:, 2]), 0.1 * wanted, atol=1e-6)
