"""Pictures drawn over a kept backdrop, where many sprites change: the same pixels as drawn as a whole."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from mimics_app.rendering.visual.kernels.particles import SPRITE
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.software.software_rasteriser import KeptBackdrop
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.world.components.effects import Billboard, Particles
from mimics_app.world.components.pictures import Inset, Mirror
from mimics_app.world.content.live_pictures import show_mirror
from mimics_app.world.content.meshes.primitives import plane
from mimics_app.world.content.world import World
from tests.golden.test_still_picture import PLAIN, SIZE, draw_whole, dress, make_world, view

pytestmark = pytest.mark.software


def make_cloudy_world() -> World:
    """The boxes, with trees behind and before them, and many particles between."""
    world = make_world()
    for number, (x, z) in enumerate(((-1.2, -2.6), (0.0, -3.1), (1.4, 1.2))):
        node = world.root.create_child(f"tree{number}", (x, 0.0, z))
        upright = number != 1
        tree = Billboard(size=(1.4, 1.6), facing="upright" if upright else "free", pivot="bottom", lit=True)
        world.effects.add(node.index, tree)
    dots = Particles(rate=400.0, lifetime=(1.0, 1.5), box=(2.0, 0.5, 1.5), size=(0.03, 0.08), speed=(0.1, 0.3))
    paper = Particles(rate=40.0, lifetime=(1.0, 1.5), box=(2.0, 0.5, 1.0), shape="paper", blend="mask", size=(0.1, 0.1))
    world.effects.add(world.root.create_child("dots", (0.0, 0.5, 0.2)).index, dots)
    world.effects.add(world.root.create_child("paper", (0.0, 0.5, 0.3)).index, paper)
    world.update()
    return world


@pytest.fixture
def kept(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The number of sprites in the backdrop, for each frame that was drawn over a kept one."""
    shown: list[int] = []
    before = KeptBackdrop.use

    def use(backdrop: KeptBackdrop, sprites: bytes) -> bool:
        found = before(backdrop, sprites)
        if found:
            shown.append(len(sprites))
        return found

    monkeypatch.setattr(KeptBackdrop, "use", use)
    return shown


CHANGES: dict[int, Callable[[World], object]] = {
    6: lambda world: world.find("ball").set_position((0.3, 0.9, 0.3)),
    9: lambda world: setattr(world.find("tree1"), "visible", False),
    12: lambda world: setattr(world.find("box7"), "visible", False),
    15: lambda world: dress(world, "box8", "red"),
    18: lambda world: world.find("mark").set_position((0.6, 0.0, 0.6)),
    21: lambda world: world.find("lamp").set_position((-0.8, 1.5, 1.0)),
    24: lambda world: world.find("tree0").set_position((-1.1, 0.0, -2.5)),
}
"""What happens to the world before which frame."""


@pytest.mark.parametrize(
    "settings",
    [
        PLAIN,
        replace(PLAIN, msaa=4),
        replace(PLAIN, scale=0.5),
        replace(PLAIN, fxaa=True, shadow_distance=4.0, cascades=2),
        replace(PLAIN, bloom=0.5, ambient_occlusion=1.0, ambient_radius=0.4),
    ],
    ids=["plain", "samples", "small", "filtered", "bloom and occlusion"],
)
def test_sprites_drawn_over_a_backdrop_are_those_drawn_with_all_of_it(settings: RenderSettings, kept: list[int]):
    world, rendered = make_cloudy_world(), []
    with create_surface("egl", SIZE) as surface:
        steady = Renderer(surface, world, settings)
        for step in range(30):
            CHANGES.get(step, lambda world: None)(world)
            world.effects.time = 2.0 + step / 60.0
            world.update()
            before = len(kept)
            steady.draw([view(0.1 if step >= 28 else 0.0)])
            ours = read_pixels(surface)
            if len(kept) > before:
                rendered.append(step)
            apart = np.abs(ours.astype(int) - draw_whole(steady, view(0.1 if step >= 28 else 0.0)))
            assert apart.max() <= (3 if settings.scale < 1.0 else 0), step  # scaled to be kept it is rounded otherwise
        assert surface.ctx.error == "GL_NO_ERROR"
    assert [step for step in rendered if step in {*CHANGES, 28, 29}] == []
    assert len(rendered) >= 12
    trees = [length // SPRITE.itemsize for length in kept]
    assert trees == sorted(trees, reverse=True) and {*trees} == {2, 1, 0}, "one is hidden, the other one moves"


def test_a_tree_leaves_the_backdrop_when_a_cloud_comes_behind_it_and_returns_later(kept: list[int]):
    world = make_cloudy_world()
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, replace(PLAIN, shadow_size=0))
        for step in range(140):
            if step in (6, 8):
                world.find("dots").set_position((0.0, 0.5, -2.8 if step == 6 else 0.2))
            world.effects.time = 2.0 + step / 60.0
            world.update()
            renderer.draw([view()])
            if step < 10 or step > 130:
                ours = read_pixels(surface)
                assert np.array_equal(ours, draw_whole(renderer, view())), step
    trees = [length // SPRITE.itemsize for length in kept]
    assert trees[0] == trees[-1] == 2
    assert trees.count(0) >= 60


def test_a_backdrop_is_drawn_once_and_costs_no_triangles_afterwards(kept: list[int]):
    world = make_cloudy_world()
    with create_surface("egl", SIZE) as surface:
        renderer, triangles = Renderer(surface, world, PLAIN), []
        for step in range(8):
            world.effects.time = 2.0 + step / 60.0
            world.update()
            triangles.append(renderer.draw([view()]).triangles)
    floor_and_boxes = 12 * 12
    assert len(kept) >= 4
    assert triangles[0] - triangles[-1] > floor_and_boxes


@pytest.mark.parametrize("kind", ["volumes", "mirror", "an eye that moves"])
def test_where_a_backdrop_would_be_another_one_the_picture_is_drawn_as_a_whole(kind: str, kept: list[int]):
    world, settings = make_cloudy_world(), PLAIN
    if kind == "volumes":
        settings = replace(PLAIN, shadows="stencil_additive")
    elif kind == "mirror":
        world.meshes["glass"] = plane(2.0, 1.0)
        mirror = world.root.create_child("mirror", (0.0, 0.7, -1.7), (0.5**0.5, 0.0, 0.0, 0.5**0.5))
        mirror.create_entity("glass", "default")
        show_mirror(world, mirror, Mirror())
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, settings)
        for step in range(8):
            seen = view(0.01 * step if kind == "an eye that moves" else 0.0)
            world.effects.time = 2.0 + step / 60.0
            world.update()
            renderer.draw([seen])
            if kind == "mirror":
                ours = read_pixels(surface)
                assert np.array_equal(ours, draw_whole(renderer, seen)), step
        assert surface.ctx.error == "GL_NO_ERROR"
    assert kept == []


def test_an_inset_over_a_backdrop_shows_the_sprites_of_its_frame(kept: list[int]):
    world = make_cloudy_world()
    world.root.create_child("eye", (-2.0, 1.5, 0.0)).create_camera(0.8, 0.05, 20.0)
    world.find("eye").look_at((0.0, 0.3, 0.3))
    world.insets["eye"] = Inset("eye", (0.7, 0.7, 0.25, 0.25))
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)
        for step in range(8):
            world.effects.time = 2.0 + step / 60.0
            world.update()
            renderer.draw([view()])
            ours = read_pixels(surface)
            assert np.array_equal(ours, draw_whole(renderer, view())), step
    assert len(kept) >= 4
