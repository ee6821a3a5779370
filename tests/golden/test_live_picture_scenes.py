"""Shipped scenes whose picture is what they are for, looked at once and kept, under EGL and OSMesa."""

from __future__ import annotations

import pytest

from mimics_app.app.picture.picture import picture_quality
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.world.files.scene.file import build_world, load_scene
from tests.golden.drawing import draw_world

SIZE = (480, 270)


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
@pytest.mark.parametrize("name", ["lanterns", "mirrors"])
def test_the_example_looks_as_it_did(backend, name, assert_golden):
    """At rest, and without the hand, whose size and place the robot's loop gives it."""
    scene = load_scene(root() / "scenes" / "examples" / f"{name}.json")
    world = build_world(scene)
    if "hand" in world:
        world.find("hand").visible = False
        world.update()
    try:
        surface = create_surface(backend, SIZE)
    except DeviceError as error:
        pytest.skip(str(error))
    with surface:
        software = "llvmpipe" in surface.ctx.info["GL_RENDERER"]
        settings = picture_quality(scene, "training")
        picture = draw_world(surface, world, desktop_views(world.cameras[0], SIZE), settings)
    assert_golden(picture, f"example_{name}", *((1, 0.999) if software else (12, 0.97)))


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
@pytest.mark.parametrize(("name", "view"), [("city_walk", "main_street"), ("canyon_walk", "free"), ("soccer", "free")])
def test_the_walk_looks_as_it_did(backend, name, view, assert_golden):
    """Through one of its cameras, before anybody has moved but for the person on the beam."""
    scene = load_scene(root() / "scenes" / f"{name}.json")
    world = build_world(scene)
    if name == "canyon_walk":
        world.find("person").set_position((0.0, 0.0, -60.0))
    world.update()
    (camera,) = [each for each in world.cameras if each.node.name == view]
    try:
        surface = create_surface(backend, SIZE)
    except DeviceError as error:
        pytest.skip(str(error))
    with surface:
        software = "llvmpipe" in surface.ctx.info["GL_RENDERER"]
        picture = draw_world(surface, world, desktop_views(camera, SIZE), picture_quality(scene, "training"))
    assert_golden(picture, f"walk_{name}", *((1, 0.999) if software else (12, 0.97)))
