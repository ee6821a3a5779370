"""The developer's overlay: what it shows is where it should be, and it leaves no trace."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.clock import VirtualClock
from mimics_app.rendering.visual.displays.desktop import compute_tangents
from mimics_app.rendering.visual.figures.hud import HUD_ROW, Hud
from mimics_app.rendering.visual.overlay.frame_graph import draw_frame_graph
from mimics_app.rendering.visual.overlay.layers import LAYERS, Arrow
from mimics_app.rendering.visual.overlay.line_set import LineSet, box_lines, circle_lines
from mimics_app.rendering.visual.overlay.stage_times import FrameTimes, StageTimes
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import box, plane
from mimics_app.world.content.world import World

SIZE = (480, 270)
SETTINGS = RenderSettings(msaa=0, shadow_size=256, fog_density=0.0)
IN_WORLD = tuple(layer for layer in LAYERS if layer != "graph")


def make_world() -> World:
    """A floor, a box, a sun with a shadow, a bulb and a spot."""
    world = World()
    world.environment = Sky((0.10, 0.12, 0.16), (0.10, 0.12, 0.16), (0.10, 0.12, 0.16), 0.6)
    world.replace_mesh("floor", plane(4.0, 4.0, segments=4))
    world.replace_mesh("box", box(0.6, 0.6, 0.6))
    world.set_material(Material("grey", "lit", (0.4, 0.4, 0.4, 1.0)))
    world.root.create_child("floor").create_entity("floor", "grey")
    world.root.create_child("box", (0.0, 0.3, 0.0)).create_entity("box", "grey")
    sun = world.root.create_child("sun", (1.0, 2.0, 1.0))
    sun.create_light("directional", intensity=0.8, casts_shadow=True)
    sun.look_at((0.0, 0.0, 0.0))
    bulb = world.root.create_child("bulb", (-1.0, 0.8, 0.4))
    bulb.create_light("point", colour=(0.2, 0.4, 1.0), intensity=0.4, range=0.5)
    spot = world.root.create_child("spot", (1.0, 1.2, -0.4))
    spot.create_light("spot", intensity=0.5, range=1.0, inner_cone=0.2, outer_cone=0.4)
    spot.look_at((1.0, 0.0, -0.4), (1.0, 0.0, 0.0))
    world.update()
    return world


def make_view(rectangle: tuple[int, int, int, int] = (0, 0, *SIZE)) -> View:
    pose = compose_look_at((1.6, 1.5, 2.6), (0.0, 0.3, 0.0))
    return View(pose, compute_tangents(0.8, rectangle[2:]), rectangle)


def shot(renderer: Renderer, surface, views: list[View] | None = None) -> np.ndarray:
    renderer.draw(views or [make_view()])
    assert surface.ctx.error == "GL_NO_ERROR"
    return read_pixels(surface)[..., :3].astype(int)


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
def test_every_layer_looks_as_it_was_looked_at(backend, assert_golden):
    with create_surface(backend, SIZE) as surface:
        renderer = Renderer(surface, make_world(), SETTINGS)
        for layer in IN_WORLD:
            renderer.overlay.toggle(layer)
        renderer.overlay.chosen = renderer.world.find("box").index
        place = np.array([0.0, 0.6, 0.0])
        renderer.overlay.arrows = [Arrow(place, np.array([0.0, 0.5, 0.0]), (1.0, 0.45, 0.2, 1.0))]
        picture = shot(renderer, surface)
        renderer.release()
    # Where the rasterisers of two versions put a thin line differs by a pixel here and there.
    assert_golden(picture.astype(np.uint8), "overlay", level=8, wanted=0.99)


@pytest.mark.parametrize("layer", LAYERS)
def test_a_layer_that_is_taken_off_leaves_no_trace(layer):
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, make_world(), SETTINGS)
        before = shot(renderer, surface)
        renderer.overlay.arrows = [Arrow(np.array([0.0, 0.6, 0.0]), np.array([0.0, 0.5, 0.0]), (1.0, 0.4, 0.2, 1.0))]
        renderer.overlay.toggle(layer)
        shot(renderer, surface)
        with_layer = shot(renderer, surface)
        assert (with_layer != before).any(axis=-1).mean() > 0.001, "it is seen"
        renderer.overlay.toggle(layer)
        assert np.array_equal(shot(renderer, surface), before)
        renderer.release()


def test_an_arrow_ends_where_it_is_said_to_and_nothing_comes_from_behind_the_eye():
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, make_world(), RenderSettings(msaa=0, shadow_size=0))
        plain = shot(renderer, surface)
        view, origin, vector = make_view(), np.array([-0.5, 0.9, 0.5]), np.array([1.0, 0.2, 0.0])
        renderer.overlay.toggle("forces")
        renderer.overlay.arrows = [Arrow(origin, vector, (1.0, 0.0, 1.0, 1.0))]
        drawn = np.argwhere((shot(renderer, surface) != plain).any(axis=-1)[60:])[:, ::-1] + (0, 60)
        ends = []
        for point in (origin, origin + vector):
            x, y, _, w = view.clip_from_world @ [*point, 1.0]
            ends.append(((x / w + 1.0) * SIZE[0] / 2, (1.0 - y / w) * SIZE[1] / 2))
        assert drawn[:, 0].min() == pytest.approx(ends[0][0], abs=4.0)
        assert drawn[:, 0].max() == pytest.approx(ends[1][0], abs=4.0)
        behind = view.eye_world + 2.0 * view.world_from_eye[:3, 2]
        renderer.overlay.arrows = [Arrow(behind, 0.5 * view.world_from_eye[:3, 2], (1.0, 0.0, 1.0, 1.0))]
        assert np.array_equal(shot(renderer, surface)[60:], plain[60:])
        # From behind the eye to before it: only the part before the near plane.
        renderer.overlay.arrows = [Arrow(behind, origin - behind, (1.0, 0.0, 1.0, 1.0))]
        changed = (shot(renderer, surface)[60:] != plain[60:]).any(axis=-1)
        assert 0.0005 < changed.mean() < 0.2
        renderer.release()


def test_what_a_wall_hides_has_bounds_of_another_colour():
    world = make_world()
    world.replace_mesh("wall", box(6.0, 3.0, 0.2))
    world.root.create_child("wall", (0.0, 1.5, 0.8)).create_entity("wall", "grey")
    for number in range(80):
        place = (0.25 * (number % 10) - 1.1, 0.2 + 0.2 * (number // 10), -0.5)
        world.root.create_child(f"crate{number}", place, scale=(0.2, 0.2, 0.2)).create_entity("box", "grey")
    world.update()
    view = View(compose_look_at((0.0, 1.5, 4.0), (0.0, 1.4, 0.0)), compute_tangents(0.5, SIZE), (0, 0, *SIZE))
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, RenderSettings(msaa=0, shadow_size=0))
        plain = shot(renderer, surface, [view])
        renderer.overlay.toggle("bounds")
        picture = shot(renderer, surface, [view])[60:]
        assert renderer.draw([view]).hidden > 40
        orange = (picture[..., 0] > plain[60:, :, 0] + 15) & (picture[..., 0] > picture[..., 2] + 15)
        assert orange.sum() > 300
        renderer.release()


def test_an_atlas_without_maps_says_so(monkeypatch):
    """As when the governor has given shadows up: the key is not without an answer."""
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, make_world(), SETTINGS)
        said: list[str] = []
        monkeypatch.setattr(renderer.overlay.hud, "text", lambda x, y, text, *more, **how: said.append(text))
        renderer.overlay.toggle("lights")
        renderer.overlay.toggle("atlas")
        for size in (256, 0, 128):
            renderer.set_quality(shadow_size=size)
            shot(renderer, surface)
        renderer.release()
    with_maps, without = "lights, shadow atlas", "lights, shadow atlas: no map of shadows is drawn"
    assert said == [with_maps, without, with_maps]


def test_every_view_has_its_own_overlay():
    halves = [make_view((0, 0, SIZE[0] // 2, SIZE[1])), make_view((SIZE[0] // 2, 0, SIZE[0] // 2, SIZE[1]))]
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, make_world(), SETTINGS)
        for layer in ("wires", "bounds", "lights"):
            renderer.overlay.toggle(layer)
        picture = shot(renderer, surface, halves)
        away = np.abs(picture[60:, : SIZE[0] // 2] - picture[60:, SIZE[0] // 2 :])
        assert away.max() <= 1  # an edge of a line rounds otherwise at another place of the screen
        renderer.release()


def test_a_picture_without_overlay_imports_none_of_it():
    program = """
import json, sys
from tests.golden.test_safe_pictures import view_from_above
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.world.content.world import World
with create_surface("egl", (16, 16)) as surface:
    Renderer(surface, World()).draw([view_from_above()])
print(json.dumps([name for name in sys.modules if ".overlay." in name]))
"""
    root = Path(__file__).parents[2]
    done = subprocess.run([sys.executable, "-c", program], cwd=root, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout) == []


def test_lines_of_boxes_and_circles_are_where_geometry_says():
    matrix = np.array([[0.0, 0.0, 2.0, 1.0], [0.0, 1.0, 0.0, 2.0], [-1.0, 0.0, 0.0, 3.0], [0.0, 0.0, 0.0, 1.0]])
    edges = box_lines(matrix[None], np.zeros((1, 3)), np.array([[1.0, 2.0, 3.0]]))
    assert edges.shape == (12, 2, 3)
    lengths = np.sort(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1))
    assert lengths == pytest.approx([2.0] * 4 + [4.0] * 4 + [12.0] * 4)
    assert edges.reshape(-1, 3).min(axis=0) == pytest.approx([1.0 - 6.0, 0.0, 2.0])
    ring = circle_lines(np.zeros((1, 3)), np.array([[2.0, 0.0, 0.0]]), np.array([[0.0, 2.0, 0.0]]))
    assert np.linalg.norm(ring, axis=-1) == pytest.approx(np.full((32, 2), 2.0))
    assert ring[0, 0] == pytest.approx(ring[-1, 1], abs=1e-12), "closed"


def test_lines_keep_their_place_far_from_the_origin():
    """A kilometre away a millimetre is still a millimetre: the eye is taken off in float64."""
    lines, far = LineSet(), np.array([1e6, 0.0, 0.0])
    lines.add(np.array([[far, far + (0.001, 0.0, 0.0)]]), (1.0, 1.0, 1.0, 1.0))
    rows = lines.rows(far - (0.0, 0.0, 1.0))
    assert rows["end"][0, 0] - rows["begin"][0, 0] == pytest.approx(0.001, rel=1e-6)


class _Clock(VirtualClock):
    def wait(self, milliseconds: float) -> None:
        self.sleep_until_ns(self.now_ns() + round(milliseconds * 1e6))


@pytest.mark.parametrize("defers", [True, False])
def test_stages_are_timed_one_by_one(defers):
    with create_surface("egl", (8, 8)) as surface:
        clock = _Clock()
        times = StageTimes(surface.ctx, clock, defers=defers)
        for number in range(300):
            times.begin()
            with times.stage("first"):
                clock.wait(2.0)
            with times.stage("second"):
                clock.wait(3.0 + number)
            times.count(9, 4, 3)
        assert len(times.frames) == 240
        assert times.frames[0].cpu_ms == pytest.approx({"first": 2.0, "second": 63.0})
        assert (times.frames[-1].items, times.frames[-1].culled, times.frames[-1].hidden) == (9, 4, 3)
        assert bool(times.frames[0].gpu_ms) != defers
        assert set(times.frames[0].gpu_ms) == (set() if defers else {"first", "second"})


def test_bars_stand_on_each_other_and_end_at_the_sum():
    frames = [FrameTimes({"a": 4.0, "b": 6.0}, {}), FrameTimes({"a": 5.0}, {}), FrameTimes()]
    hud = Hud()
    draw_frame_graph(hud, frames)
    rows = hud.rows()
    bars = rows[np.abs(rows["box"][:, 2] - 2.0) < 1e-6]
    per_ms = 120.0 / 20.0
    assert sorted(bars["box"][:, 3]) == pytest.approx([4.0 * per_ms, 5.0 * per_ms, 6.0 * per_ms])
    tops = bars["box"][:, 1] + bars["box"][:, 3]
    base = bars["box"][:, 1].min()
    assert sorted(tops - base) == pytest.approx([4.0 * per_ms, 5.0 * per_ms, 10.0 * per_ms])
    draw_frame_graph(hud, [])
    draw_frame_graph(hud, [FrameTimes()])


def test_many_rectangles_at_once_keep_the_order_of_all():
    hud = Hud()
    hud.box(1.0, 0.0, 1.0, 1.0, (1.0,) * 4)
    many = np.zeros(3, HUD_ROW)
    many["box"][:, 0] = 2.0
    before = hud.revision
    hud.extend(many)
    hud.box(3.0, 0.0, 1.0, 1.0, (1.0,) * 4)
    assert hud.rows()["box"][:, 0].tolist() == [1.0, 2.0, 2.0, 2.0, 3.0] and hud.revision > before
    assert not hud.empty
    hud.clear()
    assert hud.empty and len(hud.rows()) == 0
