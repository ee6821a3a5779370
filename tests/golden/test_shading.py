"""Light on a sphere against the equations, computed here in float64 from the ray through each pixel."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.rendering.visual.displays.desktop import compute_tangents
from mimics_app.rendering.visual.lighting import gather_lighting
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material, TextureData
from mimics_app.world.content.meshes.primitives import plane, sphere
from mimics_app.world.content.world import World
from tests.golden.drawing import draw_offscreen

F8 = NDArray[np.float64]

SIZE = (160, 120)
RADIUS, DISTANCE = 0.5, 2.0
PLAIN = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0)
BLACK = Sky((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0)

# Half a code value of rounding, and as much again for the sphere's facets and float32.
CODE_TOLERANCE = 1.0


def encode(linear: F8) -> F8:
    """IEC 61966-2-1, to 0-255."""
    clipped = np.clip(linear, 0.0, 1.0)
    curve = np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1.0 / 2.4) - 0.055)
    return 255.0 * curve


def decode(code: F8) -> F8:
    """The same backwards."""
    value = np.asarray(code, np.float64) / 255.0
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def make_ball(material: Material, sky: Sky = BLACK, towards_sun: tuple[float, float, float] | None = None) -> World:
    world = World()
    world.environment = sky
    world.set_material(material)
    world.meshes["ball"] = sphere(RADIUS, 384)
    world.root.create_child("ball").create_entity("ball", material.name)
    if towards_sun is not None:
        sun = world.root.create_child("sun", towards_sun)
        sun.look_at((0.0, 0.0, 0.0))
        sun.create_light("directional", colour=(1.0, 0.9, 0.8), intensity=0.9)
    world.update()
    return world


def front_view() -> View:
    return View(compose_look_at((0.0, 0.0, DISTANCE), (0.0, 0.0, 0.0)), compute_tangents(0.6, SIZE), (0, 0, *SIZE))


def hit_sphere(view: View) -> tuple[NDArray[np.bool_], F8, F8]:
    """Which pixels' rays hit the sphere well inside its outline, the normals there, and directions to the eye."""
    left, right, bottom, top = view.tangents
    x = left + (np.arange(SIZE[0]) + 0.5) / SIZE[0] * (right - left)
    y = top + (np.arange(SIZE[1]) + 0.5) / SIZE[1] * (bottom - top)
    rays = np.stack(np.broadcast_arrays(x[None, :], y[:, None], -1.0), axis=-1)
    rays = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
    along = -rays @ np.array([0.0, 0.0, DISTANCE])
    inside = along**2 - DISTANCE**2 + RADIUS**2
    hit = inside > (0.2 * RADIUS) ** 2
    points = (along - np.sqrt(np.maximum(inside, 0.0)))[..., None] * rays + [0.0, 0.0, DISTANCE]
    return hit, points / RADIUS, -rays


def test_a_matt_sphere_follows_lambert_from_centre_to_edge():
    towards = np.array([0.3, 0.5, 0.8]) / np.linalg.norm([0.3, 0.5, 0.8])
    albedo = np.array([0.8, 0.5, 0.2])
    world = make_ball(Material("m", base_colour=(*albedo, 1.0), roughness=1.0), towards_sun=tuple(5.0 * towards))
    view = front_view()
    picture = draw_offscreen(world, [view], SIZE, PLAIN)
    hit, normals, _ = hit_sphere(view)
    light = 0.9 * np.array([1.0, 0.9, 0.8])
    expected = encode(np.maximum(normals @ towards, 0.0)[..., None] * albedo * light)
    # sRGB is steep at black: leave out the terminator, where a code is less than a facet's error in the cosine.
    bright = hit & ((normals @ towards) > 0.05)
    assert bright.sum() > 2000
    assert np.abs(picture[..., :3] - expected)[bright].max() <= CODE_TOLERANCE
    dark = hit & ((normals @ towards) < -0.01)
    assert picture[dark][:, :3].max() == 0


def test_light_creeps_round_a_soft_sphere_and_none_is_added():
    """((c + w) / (1 + w))^(1 + 2 w) by colour, w = softness x (0.42, 0.19, 0.12): on the whole as much as Lambert."""
    towards = np.array([0.8, 0.5, 0.3]) / np.linalg.norm([0.8, 0.5, 0.3])
    albedo, creep = np.array([0.8, 0.5, 0.4]), 0.8 * np.array([0.42, 0.19, 0.12])
    cosines = np.linspace(-1.0, 1.0, 20001)[:, None]
    wrapped = np.maximum((cosines + creep) / (1.0 + creep), 0.0) ** (1.0 + 2.0 * creep)
    assert wrapped.mean(axis=0) == pytest.approx(np.maximum(cosines, 0.0).mean(), rel=1e-3)
    material = Material("m", base_colour=(*albedo, 1.0), roughness=1.0, softness=0.8)
    view = front_view()
    picture = draw_offscreen(make_ball(material, towards_sun=tuple(5.0 * towards)), [view], SIZE, PLAIN)
    hit, normals, _ = hit_sphere(view)
    share = np.maximum(((normals @ towards)[..., None] + creep) / (1.0 + creep), 0.0) ** (1.0 + 2.0 * creep)
    expected = encode(share * albedo * 0.9 * np.array([1.0, 0.9, 0.8]))
    assert np.abs(picture[..., :3] - expected)[hit & ((normals @ towards) > -0.05)].max() <= CODE_TOLERANCE


def test_a_glossy_metal_sphere_follows_ggx():
    towards = np.array([0.2, 0.3, 0.9]) / np.linalg.norm([0.2, 0.3, 0.9])
    base, metallic, roughness = np.array([0.7, 0.4, 0.2]), 0.3, 0.5
    material = Material("m", base_colour=(*base, 1.0), metallic=metallic, roughness=roughness)
    view = front_view()
    picture = draw_offscreen(make_ball(material, towards_sun=tuple(5.0 * towards)), [view], SIZE, PLAIN)
    hit, n, v = hit_sphere(view)
    expected = encode(0.9 * np.array([1.0, 0.9, 0.8]) * np.pi * ggx(n, v, towards, base, metallic, roughness))
    bright = hit & ((n @ towards) > 0.1)
    assert np.abs(picture[..., :3] - expected)[bright].max() <= CODE_TOLERANCE


def ggx(n: F8, v: F8, light: F8, base: F8, metallic: float, roughness: float) -> F8:
    """BRDF times cosine of glTF 2.0 appendix B, straight from its text: D, G2 / (4 nl nv), F."""
    h = (v + light) / np.linalg.norm(v + light, axis=-1, keepdims=True)
    nl, nv = np.maximum(n @ light, 1e-9), np.maximum((n * v).sum(-1), 1e-9)
    nh, vh = (n * h).sum(-1), (v * h).sum(-1)
    a2 = roughness**4
    d = a2 / (np.pi * (nh**2 * (a2 - 1.0) + 1.0) ** 2)
    lambda_l, lambda_v = (0.5 * (np.sqrt(1.0 + a2 * (1.0 / c**2 - 1.0)) - 1.0) for c in (nl, nv))
    g = 1.0 / (1.0 + lambda_l + lambda_v)
    f0 = 0.04 * (1.0 - metallic) + base * metallic
    f = f0 + (1.0 - f0) * (1.0 - vh[..., None]) ** 5
    specular = f * (d * g / (4.0 * nl * nv))[..., None]
    return nl[..., None] * ((1.0 - f) * base * (1.0 - metallic) / np.pi + specular)


@pytest.mark.parametrize("value", [0.0, 0.002, 0.0031308, 0.01, 0.18, 0.5, 0.9, 1.0, 3.0])
def test_unlit_colours_are_srgb_encoded(value):
    world = make_ball(Material("m", "unlit", (value, 0.5 * value, 0.25 * value, 1.0)))
    picture = draw_offscreen(world, [front_view()], SIZE, PLAIN)
    expected = encode(np.array([value, 0.5 * value, 0.25 * value]))
    assert np.abs(picture[60, 80, :3] - expected).max() <= 0.51


def shown_flat(colour: tuple[float, float, float]) -> NDArray[np.uint8]:
    """What an unlit ball of a colour looks like, in code values."""
    neutral = RenderSettings(msaa=0, shadow_size=0, fog_density=0.0)
    return draw_offscreen(make_ball(Material("m", "unlit", (*colour, 1.0))), [front_view()], SIZE, neutral)[60, 80, :3]


def test_the_neutral_tone_map_keeps_colours_and_bends_lights():
    """Below 0.76 the map takes off 0.04 x / (x + 0.08) of the least channel x; white never clips."""
    assert abs(int(shown_flat((0.5, 0.5, 0.5))[0]) - encode(np.array(0.5 - 0.04 * 0.5 / 0.58))) <= 0.51
    light = 4.0 - 0.04 * 4.0 / 4.08
    compressed = 1.0 - 0.24**2 / (light + 0.24 - 0.76)
    assert abs(int(shown_flat((4.0, 4.0, 4.0))[0]) - encode(np.array(compressed))) <= 0.51


@pytest.mark.parametrize("level", [0.005, 0.02, 0.06])
def test_the_toe_leaves_the_hue_of_what_is_dark(level):
    """Grey asphalt in shade: of a channel no more than half is taken off, and blue does not become twice as blue."""
    colour = level * np.array([1.0, 1.3, 1.7])
    shown = decode(shown_flat(tuple(colour)))
    # Half a code value is 2 % of these lights at least, 8 % of the darkest.
    assert (shown >= 0.5 * colour - decode(np.array(1.0))).all()
    assert shown[2] / shown[0] < 2.0 * 1.7 / 1.0 * 1.08


def test_light_from_all_around_is_the_mean_of_the_sky_that_is_drawn():
    """Against the integral over the hemisphere before the surface, within 0.025 of what the colours differ by."""
    zenith, horizon, ground = np.eye(3)
    world = World()
    world.environment = Sky(tuple(zenith), tuple(horizon), tuple(ground), 0.7)
    a, b, c = gather_lighting(world).sky_light()
    for height in np.linspace(-1.0, 1.0, 9):
        wanted = 0.7 * mean_of_sky(height)
        assert np.abs(a + b * height + c * height**2 - wanted).max() < 0.7 * 0.025
        assert (a + b * height + c * height**2).sum() == pytest.approx(0.7, rel=1e-9)


def mean_of_sky(height: float) -> F8:
    """Shares of zenith, horizon and ground for a surface whose normal has this height; shaders/common/sky.glsl."""
    count = 400
    away, angle = np.meshgrid(np.sqrt((np.arange(count) + 0.5) / count), 2 * np.pi * (np.arange(count) + 0.5) / count)
    # Points spread evenly over the disc under the hemisphere are directions weighed by their cosine (Nusselt).
    up = height * np.sqrt(1.0 - away**2) + np.sqrt(1.0 - height**2) * away * np.cos(angle)
    low = (1.0 - np.clip(up, 0.0, 1.0)) ** 3
    down = np.clip(-4.0 * up, 0.0, 1.0)
    below = down**2 * (3.0 - 2.0 * down)
    return np.array([((1 - low) * (1 - below)).mean(), (low * (1 - below)).mean(), below.mean()])


def test_a_uniform_sky_lights_a_matt_sphere_evenly():
    sky = Sky((0.5, 0.5, 0.5), (0.5, 0.5, 0.5), (0.5, 0.5, 0.5), 0.8)
    world = make_ball(Material("m", base_colour=(0.6, 0.6, 0.6, 1.0), roughness=1.0), sky)
    view = front_view()
    picture = draw_offscreen(world, [view], SIZE, PLAIN)
    hit = hit_sphere(view)[0]
    expected = encode(np.array(0.8 * 0.5 * 0.6))
    assert np.abs(picture[..., :3][hit] - expected).max() <= CODE_TOLERANCE


def test_a_texture_lies_the_right_way_up():
    """Row 0 of a picture is its top and lies at v = 0 (glTF); the plane's v runs along +z, towards the eye."""
    world = World()
    world.environment = BLACK
    pixels = np.zeros((2, 2, 4), np.uint8)
    pixels[0, 0], pixels[0, 1], pixels[1, 0], pixels[1, 1] = (
        (255, 0, 0, 255),
        (0, 255, 0, 255),
        (0, 0, 255, 255),
        (188, 188, 188, 255),
    )
    world.textures["t"] = TextureData(pixels, filter="nearest", wrap=("clamp", "clamp"))
    world.set_material(Material("m", "unlit", (1.0, 1.0, 1.0, 1.0), base_texture="t"))
    world.meshes["plane"] = plane()
    world.root.create_child("plane").create_entity("plane", "m")
    world.update()
    pose = compose_look_at((0.0, 1.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    picture = draw_offscreen(world, [View(pose, (-0.4, 0.4, -0.4, 0.4), (0, 0, 64, 64))], (64, 64), PLAIN)
    assert [tuple(int(c) for c in picture[y, x, :3]) for y, x in ((16, 16), (16, 48), (48, 16), (48, 48))] == [
        (255, 0, 0),
        (0, 255, 0),
        (0, 0, 255),
        (188, 188, 188),
    ]


@pytest.mark.parametrize("kind", ["point", "spot"])
def test_a_placed_light_falls_off_with_the_square_of_distance(kind):
    """A matt floor under a lamp 0.8 m up: albedo intensity cos / d^2, and nothing outside a spot's cone."""
    world = World()
    world.environment = BLACK
    world.set_material(Material("m", base_colour=(0.5, 0.5, 0.5, 1.0), roughness=1.0))
    world.meshes["floor"] = plane(4.0, 4.0)
    world.root.create_child("floor").create_entity("floor", "m")
    lamp = world.root.create_child("lamp", (0.0, 0.8, 0.0))
    lamp.look_at((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    cone = {"inner_cone": 0.3, "outer_cone": 0.4} if kind == "spot" else {}
    lamp.create_light(kind, colour=(1.0, 1.0, 1.0), intensity=0.9, **cone)
    world.update()
    pose = compose_look_at((0.0, 2.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    picture = draw_offscreen(world, [View(pose, (-0.4, 0.4, -0.3, 0.3), (0, 0, *SIZE))], SIZE, PLAIN)
    x = 2.0 * 0.4 * (2.0 * (np.arange(SIZE[0]) + 0.5) / SIZE[0] - 1.0)
    y = 2.0 * 0.3 * (2.0 * (np.arange(SIZE[1]) + 0.5) / SIZE[1] - 1.0)
    aside = np.hypot(x[None, :], y[:, None])
    distance = np.hypot(aside, 0.8)
    expected = encode(0.5 * 0.9 * 0.8 / distance**3)
    seen = picture[..., 0].astype(float)
    angle = np.arctan2(aside, 0.8)
    inside = angle < (0.29 if kind == "spot" else 2.0)
    assert np.abs(seen - expected)[inside].max() <= CODE_TOLERANCE
    if kind == "spot":
        assert seen[angle > 0.41].max() == 0


def test_a_light_that_comes_and_goes_is_seen():
    world = make_ball(Material("m", roughness=1.0))
    dark = draw_offscreen(world, [front_view()], SIZE, PLAIN)
    world.root.create_child("lamp", (0.0, 0.0, 2.0)).create_light("point", intensity=1.0)
    world.update()
    lit = draw_offscreen(world, [front_view()], SIZE, PLAIN)
    assert dark[60, 80, :3].max() == 0 and lit[60, 80, :3].min() > 100
