"""Both eyes in one pass: the picture of two passes, from each eye's own place, with the calls to the driver of one."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from mimics_app.lab.groups.stereo import body_world, show_stereo
from mimics_app.rendering.visual.displays.headset_file import EyeSpec, HeadsetSpec
from mimics_app.rendering.visual.displays.headset_session import HeadsetDisplay
from mimics_app.rendering.visual.displays.simulated_headset import SimulatedRuntime
from mimics_app.rendering.visual.displays.stereo import StereoDisplay
from mimics_app.rendering.visual.presenting.presenter import Presenter
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.stages.eye_pairs import group_views
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.view import View
from mimics_app.world.components.effects import Projector
from mimics_app.world.components.pictures import Mirror
from mimics_app.world.content.cords import Cord
from mimics_app.world.content.live_pictures import show_mirror
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import box, plane, sphere
from mimics_app.world.content.world import World

SETTINGS = RenderSettings(msaa=0, tone_map="none", occlusion="off")
SIZE = (320, 120)
CLEAR = replace(SETTINGS, fog_density=0.0, ambient_radius=0.4)
SINGLE = ("viewports", "clip_distance")


def far_apart(one: np.ndarray, other: np.ndarray) -> int:
    return int((np.abs(one.astype(int) - other).max(axis=-1) > 8).sum())


def room() -> World:
    """Bodies, a wet one, a pane of glass and a cord."""
    world = body_world(30, 2, own_materials=True)
    world.set_material(Material("wet", "lit", (0.1, 0.1, 0.12, 1.0), roughness=0.12))
    world.set_material(Material("pane", "glass", (0.3, 0.6, 0.9, 0.4)))
    world.meshes |= {"large": sphere(0.5, 32), "bubble": sphere(0.3, 24)}
    world.root.create_child("", (0.7, 0.1, -2.2)).create_entity("large", "wet")
    world.root.create_child("", (-0.4, 0.0, -1.6)).create_entity("bubble", "pane")
    world.cords["cord"] = Cord(np.array([[-0.8, 0.5, -1.5], [0.8, 0.4, -1.8]]), 2.0, 0.04)
    world.update()
    return world


def draw(world: World, kind: str, settings: RenderSettings, backend: str = "egl"):
    with create_surface(backend, SIZE) as surface:
        presenter = Presenter(StereoDisplay(kind), surface)
        renderer = Renderer(presenter.drawn, world, settings)
        presenter.begin(0)
        stats = renderer.draw(presenter.views(world.cameras[0]))
        assert surface.ctx.error == "GL_NO_ERROR"
        picture = read_pixels(presenter.drawn)
        renderer.release()
        presenter.release()
    return picture, stats


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
def test_one_pass_draws_the_picture_of_two(backend: str) -> None:
    world = room()
    two, slow = draw(world, "sbs", replace(SETTINGS, stereo="two_pass"), backend)
    assert far_apart(two[:, :160], two[:, 160:]) > 500  # the eyes differ
    one, quick = draw(world, "sbs", SETTINGS, backend)
    assert np.array_equal(one, two)
    assert quick.draws < 0.6 * slow.draws


def test_each_eye_sees_what_an_eye_alone_would_with_its_own_highlights() -> None:
    """A queue from between the eyes changes no picture: not the edges, nor where a wet ball shines."""
    world = room()
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, SETTINGS)
        presenter = Presenter(StereoDisplay("sbs"), surface)
        presenter.begin(0)
        views = presenter.views(world.cameras[0])
        renderer.draw(views)
        together = read_pixels(surface)
        for view, half in zip(views, (slice(0, 160), slice(160, 320)), strict=True):
            renderer.draw([replace(view, pair=-1)])
            alone = read_pixels(surface)
            # A pixel at an edge may fall to either side: places are rounded from elsewhere.
            assert far_apart(alone[:, half], together[:, half]) <= 12
        renderer.release()


def test_what_only_one_eye_sees_is_drawn_for_it() -> None:
    world = World()
    world.set_material(Material("white", "unlit", (1.0, 1.0, 1.0, 1.0)))
    world.meshes["ball"] = sphere(0.02, 16)
    # 0.5 m away, before a screen at 2 m, each eye sees 24 mm farther to its own side than an eye between them.
    half = math.tan(0.5) * SIZE[0] / 2 / SIZE[1]
    for x in (-0.5 * half, 0.5 * half):
        world.root.create_child("", (x, 0.0, -0.5)).create_entity("ball", "white")
    world.root.create_child("eye").create_camera(1.0, 0.05, 80.0)
    world.update()
    picture, _ = draw(world, "sbs", replace(SETTINGS, fog_density=0.0))
    lit = [(picture[:, part, :3].min(axis=-1) > 250).sum() for part in (slice(0, 160), slice(160, 320))]
    assert min(lit) > 20
    two, _ = draw(world, "sbs", replace(SETTINGS, fog_density=0.0, stereo="two_pass"))
    assert np.array_equal(picture, two)


def furnished() -> World:
    """The room in the sun, with balls in a corner and a mirror in it; projectors cast light and a stain."""
    world = room()
    downwards = (-math.sin(0.45), 0.0, 0.0, math.cos(0.45))
    world.root.create_child("sun", (1.0, 3.0, 2.0), downwards).create_light("directional", casts_shadow=1)
    world.meshes |= {"sheet": plane(0.7, 0.5), "floor": plane(6.0, 6.0), "block": box(0.4, 0.4, 0.4)}
    world.root.create_child("", (0.0, -0.7, -3.0)).create_entity("floor", "paint 3")
    world.root.create_child("", (0.1, -0.5, -1.9)).create_entity("block", "paint 9")
    world.root.create_child("", (0.35, -0.55, -1.6)).create_entity("bubble", "paint 20")
    node = world.root.create_child("mirror", (-0.6, -0.35, -1.7), (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)))
    node.create_entity("sheet", "wet")
    show_mirror(world, node, Mirror())
    for place, blend in (((0.5, 0.0, -1.0), "light"), ((0.0, -0.3, -1.0), "stain")):
        index = world.root.create_child("", place).index
        world.effects.add(index, Projector(kind="slide", fov=0.5, depth=6.0, blend=blend))
    world.update()
    return world


def canted_eye(sign: float, cant: float) -> EyeSpec:
    turn = (0.0, -sign * math.sin(0.5 * cant), 0.0, math.cos(0.5 * cant))
    return EyeSpec(tangents=(-0.7, 0.7, -0.5, 0.5), position=(0.032 * sign, 0.0, 0.0), rotation=turn)


def canted(surface: Surface, cant: float = 0.05) -> Presenter:
    """Panels beside each other, each turned outwards [rad]."""
    spec = HeadsetSpec(left=canted_eye(-1.0, cant), right=canted_eye(1.0, cant))
    presenter = Presenter(HeadsetDisplay("sim-hmd", SimulatedRuntime(spec)), surface)
    presenter.begin(0)
    return presenter


@pytest.mark.parametrize(
    "change",
    [
        {"ambient_occlusion": 1.0},
        {"shadows": "stencil_additive", "ambient_occlusion": 1.0},
        {"shadows": "stencil_modulative"},
    ],
    ids=["ambient", "stencil", "darkened"],
)
def test_one_pass_has_openness_volumes_mirrors_and_what_is_thrown_as_two_have(change: dict[str, object]) -> None:
    """Eyes that do not look in one direction, so that nothing of one can stand in for the other."""
    world, settings = furnished(), replace(CLEAR, **change)
    with create_surface("egl", SIZE) as surface:
        presenter, drawn = canted(surface), {}
        views = presenter.views(world.cameras[0])
        for passes in ("two_pass", "clip_distance"):
            renderer = Renderer(presenter.drawn, world, replace(settings, stereo=passes))
            stats = renderer.draw(views)
            assert surface.ctx.error == "GL_NO_ERROR"
            drawn[passes] = read_pixels(presenter.drawn), stats.draws
            renderer.release()
        presenter.release()
    two, slow = drawn["two_pass"]
    assert far_apart(two[:, :160], two[:, 160:]) > 500
    one, quick = drawn["clip_distance"]
    assert np.array_equal(one, two)
    assert quick < 0.7 * slow


def test_each_of_them_is_seen_in_the_room_that_is_compared() -> None:
    """What could be left out unseen would prove nothing above."""
    settings = replace(CLEAR, shadows="stencil_additive", ambient_occlusion=1.0)
    whole, _ = draw(furnished(), "sbs", settings)

    def check(world: World, settings: RenderSettings) -> None:
        world.update()
        without, _ = draw(world, "sbs", settings)
        assert all(far_apart(whole[:, half], without[:, half]) > 50 for half in (slice(0, 160), slice(160, 320)))

    check(furnished(), replace(settings, ambient_occlusion=0.0))
    check(furnished(), replace(settings, shadow_size=0))
    world = furnished()
    world.find("mirror").remove()
    check(world, settings)
    world = furnished()
    world.effects.remove(list(world.effects.projectors))
    check(world, settings)


def test_eyes_above_each_other_are_clipped_by_viewports_alone() -> None:
    world, settings = furnished(), replace(CLEAR, shadows="stencil_additive", ambient_occlusion=1.0)
    two, slow = draw(world, "tb", replace(settings, stereo="two_pass"))
    for passes, calls in (("clip_distance", 1.0), ("viewports", 0.7)):
        one, stats = draw(world, "tb", replace(settings, stereo=passes))
        assert np.array_equal(one, two)
        assert stats.draws <= calls * slow.draws


def test_pairs_are_found_wherever_they_stand() -> None:
    def view(pair: int) -> View:
        return View(np.eye(4), (-1.0, 1.0, -1.0, 1.0), (0, 0, 8, 8), pair=pair)

    assert group_views([view(-1), view(-1)]) == [(0,), (1,)]
    assert group_views([view(k) for k in (0, 1, 0, 1)]) == [(0, 2), (1, 3)]
    assert group_views([view(k) for k in (0, 0, 0)]) == [(0,), (1,), (2,)]  # three eyes are no pair


def test_the_laboratory_finds_no_pixel_that_differs() -> None:
    world = body_world(40, 2, own_materials=True)
    for single in SINGLE:
        assert np.array_equal(*show_stereo(world, (213, 117), "two_pass", single))
