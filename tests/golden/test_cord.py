"""The cord's vertex shader against the same in float64, and the picture it makes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.maths.cord import Ripple
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.passes.cord import CORD_BLOCK, RINGS, SIDES, fill_cord_block
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_block import VIEW_BLOCK
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.cords import Cord
from mimics_app.world.content.world import World
from tests.golden.drawing import draw_offscreen

UP = np.array([0.0, 1.0, 0.0])


def shader_vertices(cord: Cord, time_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Places (relative to an eye at the origin) and normals as the shader has them, [n, 3] each."""
    count = RINGS * (SIDES + 1)
    with create_surface("egl", (8, 8)) as surface:
        ctx = surface.ctx
        program = ShaderLibrary(ctx).feedback("cord/cord.vert", ("position_eye", "normal")).program
        data = np.zeros((), CORD_BLOCK)
        fill_cord_block(data, cord, np.zeros(3), UP, time_s)
        block, view = ctx.buffer(data.tobytes()), ctx.buffer(reserve=VIEW_BLOCK.itemsize)
        block.bind_to_uniform_block(7)
        view.bind_to_uniform_block(0)
        out = ctx.buffer(reserve=count * 24)
        surface.framebuffer.use()
        ctx.vertex_array(program, []).transform(out, vertices=count)
        read = np.frombuffer(out.read(), np.float32).reshape(count, 6).astype(np.float64)
    return read[:, :3], read[:, 3:] / np.linalg.norm(read[:, 3:], axis=1, keepdims=True)


def grid(cord: Cord) -> tuple[np.ndarray, np.ndarray]:
    s, theta = np.meshgrid(
        np.linspace(0.0, cord.curve.length, RINGS), np.linspace(0.0, 2 * math.pi, SIDES + 1), indexing="ij"
    )
    return s.ravel(), theta.ravel()


CORDS = {
    "hanging": Cord(np.array([[0.1, 0.4, -0.5], [0.3, 0.6, -1.6]]), 1.6, 0.03),
    "taut": Cord(np.array([[0.1, 0.4, -0.5], [0.3, 0.6, -1.6]]), 1.0, 0.03),
    "nearly taut": Cord(np.array([[0.0, 0.4, -0.5], [0.0, 0.4, -1.5]]), 1.00002, 0.03),
    "steep": Cord(np.array([[0.0, 1.4, -0.5], [0.05, 0.2, -0.6]]), 1.4, 0.01),
    "swung": Cord(np.array([[0.1, 0.4, -0.5], [0.3, 0.6, -1.6]]), 1.6, 0.03, swing=0.5),
}


@pytest.mark.parametrize("name", CORDS)
def test_the_shader_draws_what_float64_says(name: str) -> None:
    cord = CORDS[name]
    s, theta = grid(cord)
    wanted, normals = cord.waves.surface(cord.curve, cord.radius, [], s, theta)
    places, found = shader_vertices(cord, 0.0)
    assert np.abs(places - wanted).max() <= 1e-6
    assert np.degrees(np.arccos(np.clip((found * normals).sum(axis=1), -1, 1))).max() <= 0.1
    # Both ends are on their sockets: the ring's middle is.
    rings = places.reshape(RINGS, SIDES + 1, 3)[:, :-1].mean(axis=1)
    assert np.abs(rings[[0, -1]] - cord.ends).max() <= 1e-6


def test_ripples_of_the_shader_have_height_and_normals_of_float64() -> None:
    cord = Cord(np.array([[0.1, 0.4, -0.5], [0.3, 0.6, -1.6]]), 1.3, 0.05)
    cord.tap(0.5, 0.7, 0.0, 0.01)
    cord.tap(0.8, -2.0, 0.1, 0.008)
    ripples = [Ripple(0.5, 0.7, 0.3, 0.01), Ripple(0.8, -2.0, 0.2, 0.008)]
    s, theta = grid(cord)
    wanted, normals = cord.waves.surface(cord.curve, cord.radius, ripples, s, theta)
    places, found = shader_vertices(cord, 0.3)
    # float32 turns the phase of a wave 5 cm long by 1e-5 at most: 1e-7 m of a crest of 1 cm.
    assert np.abs(places - wanted).max() <= 3e-6
    # Where the shortest way round changes sides the surface has an edge, and no normal.
    smooth = np.ones(len(s), bool)
    for ripple in ripples:
        turn = np.remainder(theta - ripple.theta, 2 * math.pi)
        smooth &= (np.abs(turn - math.pi) > 0.02) & (
            np.hypot(s - ripple.s, 0.05 * np.minimum(turn, 6.28 - turn)) > 0.003
        )
    angle = np.degrees(np.arccos(np.clip((found * normals).sum(axis=1), -1, 1)))
    assert angle[smooth].max() <= 0.1
    assert np.abs(np.linalg.norm(places - cord.curve.point(s), axis=1) - 0.05).max() > 0.004  # there are ripples


def test_the_ball_throws_its_shadow_on_the_cord_and_length_changes_what_is_seen() -> None:
    view = View(compose_look_at((0.0, 0.5, 1.0), (0.0, 0.1, 0.0)), (-0.8, 0.8, -0.45, 0.45), (0, 0, 320, 180))
    settings = RenderSettings(msaa=0, shadow_size=0, fog_density=0.0)

    def picture(change) -> np.ndarray:
        world = World()
        world.cords["cord"] = Cord(np.array([[-0.5, 0.3, 0.0], [0.5, 0.3, 0.0]]), 1.05, 0.06)
        sun = world.root.create_child("sun", (0.0, 2.0, 0.2))
        sun.create_light("directional")
        world.update()
        sun.look_at((0.0, 0.0, 0.0))
        world.update()
        change(world.cords["cord"])
        return draw_offscreen(world, [view], (320, 180), settings)[..., :3].astype(int)

    def shade(cord: Cord) -> None:
        place, _ = cord.place(0.5, 0.0, 0.05)
        cord.ball[:] = (*place, 0.03)

    plain, shaded, longer, hidden = (
        picture(change)
        for change in (
            lambda cord: None,
            shade,
            lambda cord: setattr(cord, "length", 1.5),
            lambda cord: setattr(cord, "visible", False),
        )
    )
    cord_pixels = np.abs(plain - hidden).max(axis=-1) > 8
    darker = (plain - shaded).max(axis=-1) > 8
    assert 200 < cord_pixels.sum()
    assert 20 < darker.sum() < 0.4 * cord_pixels.sum()
    assert not (darker & ~cord_pixels).any()
    assert not ((shaded - plain).max(axis=-1) > 8).any()  # a shadow makes nothing lighter
    assert (np.abs(longer - plain).max(axis=-1) > 8).sum() > 200
