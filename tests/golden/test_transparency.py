"""Glass: what is inside is seen, far before near, and order does not hang on how the scene lists it."""

from __future__ import annotations

import numpy as np

from mimics_app.rendering.visual.displays.desktop import compute_tangents, desktop_views
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material, TextureData
from mimics_app.world.content.meshes.primitives import plane
from mimics_app.world.content.world import World
from tests.golden.demo_world import make_tunnel_world
from tests.golden.drawing import draw_offscreen

PLAIN = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0)
SIZE = (96, 64)


def test_the_ball_is_seen_through_the_tunnel():
    """Nearly all of the ball's pixels differ from the empty tunnel's by what a person notices, 30 of 255."""
    world = make_tunnel_world()
    views = desktop_views(world.cameras[0], (480, 270))
    settings = RenderSettings(shadow_size=0)
    with_ball = draw_offscreen(world, views, (480, 270), settings).astype(int)
    world.find("ball").entity.visible = False
    world.update()
    without = draw_offscreen(world, views, (480, 270), settings).astype(int)
    world.find("tube").entity.visible = False
    world.find("ball").entity.visible = True
    world.update()
    bare = draw_offscreen(world, views, (480, 270), settings).astype(int)
    world.find("ball").entity.visible = False
    world.update()
    nothing = draw_offscreen(world, views, (480, 270), settings).astype(int)
    ball = np.abs(bare - nothing).max(axis=-1) > 60
    assert ball.sum() > 60
    assert (np.abs(with_ball - without).max(axis=-1)[ball] >= 30).mean() > 0.95


def panes(order: tuple[str, ...]) -> World:
    """A red and a blue pane, half opaque, the blue one nearer to the eye at +z."""
    world = World()
    world.environment = Sky((0.0,) * 3, (0.0,) * 3, (0.0,) * 3, 0.0)
    world.set_material(Material("red", "unlit", (1.0, 0.0, 0.0, 0.5), alpha_mode="blend", double_sided=True))
    world.set_material(Material("blue", "unlit", (0.0, 0.0, 1.0, 0.5), alpha_mode="blend", double_sided=True))
    world.meshes["pane"] = plane()
    upright = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
    for name in order:
        node = world.root.create_child(name, (0.0, 0.0, -1.0 if name == "red" else -0.5), upright)
        node.create_entity("pane", name)
    world.update()
    return world


def view(distance: float) -> View:
    eye = compose_look_at((0.0, 0.0, distance), (0.0, 0.0, -0.75))
    return View(eye, compute_tangents(0.5, SIZE), (0, 0, *SIZE))


def test_far_panes_are_drawn_first_from_either_side():
    for order in (("red", "blue"), ("blue", "red")):
        front = draw_offscreen(panes(order), [view(1.0)], SIZE, PLAIN)[32, 48]
        assert np.abs(front[:3].astype(int) - (64, 0, 128)).max() <= 1
        behind = draw_offscreen(panes(order), [view(-2.5)], SIZE, PLAIN)[32, 48]
        assert np.abs(behind[:3].astype(int) - (128, 0, 64)).max() <= 1


def test_a_masked_material_is_cut_out_at_its_cutoff():
    world = panes(())
    alpha = np.zeros((1, 4, 4), np.uint8)
    alpha[0, :, :3], alpha[0, :, 3] = 255, (0, 100, 150, 255)
    world.textures["t"] = TextureData(alpha, filter="nearest", wrap=("clamp", "clamp"))
    material = Material("cut", "unlit", (1.0,) * 4, base_texture="t", alpha_mode="mask", alpha_cutoff=0.5)
    world.set_material(material)
    upright = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
    world.root.create_child("pane", (0.0, 0.0, 0.0), upright).create_entity("pane", "cut")
    world.update()
    eye = compose_look_at((0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    row = draw_offscreen(world, [View(eye, (-0.5, 0.5, -0.5, 0.5), (0, 0, 64, 64))], (64, 64), PLAIN)[32, :, 0]
    assert [int(row[x]) for x in (8, 24, 40, 56)] == [0, 0, 255, 255]
