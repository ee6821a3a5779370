"""Sky box, dome and plane lie where they should; haze follows its formulas."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Backdrop, Fog, Sky
from mimics_app.world.content.materials.material import Material, TextureData
from mimics_app.world.content.meshes.primitives import plane
from mimics_app.world.content.world import World
from tests.golden.test_shading import encode

PLAIN = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0)
BLACK = ((0.0,) * 3,) * 3
SIDE = 32
# Towards +x -x +y -y +z -z, and what is up in the view.
TOWARDS = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
UPWARDS = [(0, 1, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1), (0, 1, 0), (0, 1, 0)]


def looking(world: World, towards: tuple[float, ...], up: tuple[float, ...] = (0.0, 1.0, 0.0)) -> np.ndarray:
    """A view of 90 degrees."""
    world.update()
    pose = compose_look_at((0.0, 0.0, 0.0), towards, up)
    with create_surface("egl", (SIDE, SIDE)) as surface:
        renderer = Renderer(surface, world, PLAIN)
        renderer.draw([View(pose, (-1.0, 1.0, -1.0, 1.0), (0, 0, SIDE, SIDE))])
        assert surface.ctx.error == "GL_NO_ERROR"
        assert renderer.take_issues() == []
        picture = read_pixels(surface)
        renderer.release()
    return picture[..., :3].astype(int)


def make_sky(kind: str, textures: dict[str, np.ndarray], **more: float) -> World:
    world = World()
    world.environment = Sky(*BLACK, 0.0, backdrop=Backdrop(kind, tuple(textures), **more))
    for key, pixels in textures.items():
        world.textures[key] = TextureData(pixels, filter="linear", wrap=("repeat", "clamp"))
    return world


def test_each_face_of_a_box_is_seen_as_its_picture_lies():
    """Four quadrants per picture, all of the 24 of different colours, seen unmirrored and upright."""
    rng = np.random.default_rng(11)
    faces = {}
    for name in "abcdef":
        colours = rng.integers(0, 256, (2, 2, 4), np.uint8)
        colours[..., 3] = 255
        faces[name] = np.kron(colours, np.ones((16, 16, 1), np.uint8))
    world = make_sky("box", faces)
    for face, towards, up in zip(faces.values(), TOWARDS, UPWARDS, strict=True):
        seen = looking(world, towards, up)
        for row, column in ((4, 4), (4, 28), (28, 4), (28, 28)):
            assert np.abs(seen[row, column] - face[row, column, :3]).max() <= 1


def test_a_dome_shows_longitude_and_latitude():
    """Code values count longitude in u (red) and latitude in v (green), decoded exactly by their own picture."""
    v, u = np.mgrid[0:128, 0:256]
    pixels = np.stack([u, 2 * v, 0 * u, 0 * u + 255], axis=-1).astype(np.uint8)
    world = make_sky("dome", {"dome": pixels})
    for towards in ((0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (-0.5, 0.4, -0.7), (0.6, 0.5, 0.3)):
        d = np.array(towards) / np.linalg.norm(towards)
        longitude, latitude = 0.5 + np.arctan2(d[0], -d[2]) / (2 * np.pi), np.arccos(d[1]) / np.pi
        seen = looking(world, towards)[15:17, 15:17].reshape(-1, 3).mean(axis=0)
        # A pixel in the middle of 90 degrees over 32 spans 2.5 of 256 texels; the mean of four lies at their centre.
        assert seen[0] == pytest.approx(256 * longitude - 0.5, abs=2.0)
        assert seen[1] == pytest.approx(2 * (128 * latitude - 0.5), abs=2.0)


def test_a_plane_is_seen_at_its_height_and_not_below_the_horizon():
    """Half a picture red, half green, 4 m wide, 2 m up: straight up, x from -2 to 2 m fills the view."""
    pixels = np.zeros((8, 64, 4), np.uint8)
    pixels[:, :32], pixels[:, 32:] = (255, 0, 0, 255), (0, 255, 0, 255)
    world = make_sky("plane", {"clouds": pixels}, height=2.0, tile=4.0)
    above = looking(world, (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    # x / 4 m in [0, 1/2) is red: x in [0, 2), the right half of the view; to the left the repeated green half.
    assert tuple(above[16, 24]) == (255, 0, 0)
    assert tuple(above[16, 8]) == (0, 255, 0)
    assert looking(world, (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)).max() == 0
    assert looking(world, (0.0, 0.0, -1.0))[17:].max() == 0


def test_a_box_with_a_picture_missing_gives_one_line_and_the_colours():
    world = make_sky("box", {name: np.full((4, 4, 4), 255, np.uint8) for name in "abcdef"})
    del world.textures["c"]
    world.environment = Sky((0.5,) * 3, (0.5,) * 3, (0.5,) * 3, 0.0, backdrop=world.environment.backdrop)
    world.update()
    with create_surface("egl", (8, 8)) as surface:
        renderer = Renderer(surface, world, PLAIN)
        for _ in range(2):
            renderer.draw([View(np.eye(4), (-1.0, 1.0, -1.0, 1.0), (0, 0, 8, 8))])
        assert [issue.what for issue in renderer.take_issues()] == [
            "backdrop of the sky: no texture c; drawn without it"
        ]
        assert np.abs(read_pixels(surface)[..., :3].astype(int) - 188).max() <= 1


@pytest.mark.parametrize(
    ("fog", "seen"),
    [
        (Fog("squared", 0.3), np.exp(-((0.3 * 4.0) ** 2))),
        (Fog("exponential", 0.3), np.exp(-0.3 * 4.0)),
        (Fog("exponential", 0.3, start=3.0), np.exp(-0.3)),
        (Fog("linear", 0.2, start=1.0), 1.0 - 0.2 * 3.0),
        (Fog("linear", 2.0, start=1.0), 0.0),
        (Fog("linear", 2.0, start=5.0), 1.0),
        (Fog("exponential", 0.3, colour=(0.1, 0.2, 0.9)), np.exp(-0.3 * 4.0)),
    ],
)
def test_haze_follows_its_formula(fog, seen):
    world = World()
    horizon = (0.2, 0.5, 0.3)
    world.environment = Sky((0.0,) * 3, horizon, (0.0,) * 3, 0.0, fog=fog)
    world.set_material(Material("m", "unlit", (0.8, 0.1, 0.4, 1.0), double_sided=True))
    world.meshes["wall"] = plane(40.0, 40.0)
    world.root.create_child("wall", (0.0, -4.0, 0.0)).create_entity("wall", "m")
    picture = looking(world, (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))[15:17, 15:17].reshape(-1, 3).mean(axis=0)
    light = seen * np.array([0.8, 0.1, 0.4]) + (1.0 - seen) * np.array(fog.colour or horizon)
    # The four middle pixels look 1/32 beside the axis: 0.1 % farther.
    assert picture == pytest.approx(encode(light), abs=1.0)
