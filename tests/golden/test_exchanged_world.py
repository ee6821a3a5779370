"""A renderer that is given another world draws that one, whatever it drew of the one before."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.headless import open_offscreen, read_pixels
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.file import build_world, load_scene

_SCENE = """{"format": "mimics-scene", "version": 1, "entities": [
    {"id": "sun", "components": {"light": {"target": [-1, -2, -1]}}},
    {"id": "eye", "transform": {"translation": [0, 0, 3]}, "components": {"camera": {"target": [0, 0, 0]}}},
    {"id": "cube", "components": {"mesh": {"primitive": {"shape": "box", "size": [0.5, 0.5, 0.5]}}}}]}"""


def moved_by(path, steps: list[float]) -> World:
    """The world of the scene, whose mesh was written once for each step upwards [m]."""
    path.write_text(_SCENE)
    world = build_world(load_scene(path))
    buffer = world.open_mesh(next(name for name in world.meshes))
    for step in steps:
        buffer.positions[:, 1] += step
        buffer.update()
    world.update()
    return world


def pixels(renderer: Renderer, surface) -> F8:
    renderer.draw_finished(desktop_views(renderer.world.cameras[0], surface.size))
    return read_pixels(surface)[..., :3].astype(float)


def test_a_mesh_of_the_same_name_and_revision_is_that_of_the_new_world(tmp_path):
    """Both meshes were written as often, so their revisions are alike and no written range tells them apart."""
    low, high = (moved_by(tmp_path / "cube.json", steps) for steps in ([-0.2, -0.2], [0.2, 0.2]))
    settings = RenderSettings(shadow_size=0)
    with open_offscreen("auto", (96, 64)) as surface:
        renderer = Renderer(surface, low, settings)
        below = pixels(renderer, surface)
        renderer.world = high
        above = pixels(renderer, surface)
        alone = pixels(Renderer(surface, high, settings), surface)
    assert np.abs(above - below).max() > 50
    assert np.array_equal(above, alone)
