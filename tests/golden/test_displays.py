"""Displays as they are drawn: walls to half a pixel, stereo to a tenth, every composition by its formula."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.ports.display_port import Eye, Viewpoint
from mimics_app.maths.poses import pose_from_parts
from mimics_app.rendering.visual.displays.desktop import compute_tangents
from mimics_app.rendering.visual.displays.headset import RawHeadset
from mimics_app.rendering.visual.displays.headset_file import HeadsetSpec
from mimics_app.rendering.visual.displays.headset_session import HeadsetDisplay
from mimics_app.rendering.visual.displays.simulated_headset import SimulatedRuntime
from mimics_app.rendering.visual.displays.stereo import DUBOIS_RED_CYAN, StereoDisplay
from mimics_app.rendering.visual.displays.wall_file import load_walls
from mimics_app.rendering.visual.displays.walls import WallDisplay
from mimics_app.rendering.visual.presenting.presenter import Presenter
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.world import World
from tests.golden.test_projection import PLAIN, centroid, make_disc_world
from tests.support.lens import undistort

FOV = math.radians(50.0)
SIZE = (320, 240)


def camera_world(points: list[np.ndarray], radius: float) -> World:
    world = make_disc_world(points, np.eye(3), radius)
    world.root.create_child("eye").create_camera(FOV, 0.05, 50.0)
    world.update()
    return world


def show(display, world: World, size=SIZE, backend: str = "egl"):
    """The picture that is shown and the one that was drawn, rows from the top, and the eyes."""
    with create_surface(backend, size) as surface:
        presenter = Presenter(display, surface)
        renderer = Renderer(presenter.drawn, world, PLAIN)
        presenter.begin(0)
        views = presenter.views(world.cameras[0])
        renderer.draw(views)
        presenter.present()
        assert surface.ctx.error == "GL_NO_ERROR"
        shown, drawn = read_pixels(surface), read_pixels(presenter.drawn)
        eyes = display.eyes(Viewpoint(world.cameras[0].world_from_eye, FOV), presenter.drawn.size, 0)
        renderer.release()
        presenter.release()
    return shown, drawn, eyes


def part(picture: np.ndarray, eye: Eye) -> np.ndarray:
    x, y, width, height = eye.rectangle
    top = picture.shape[0] - y - height
    return picture[top : top + height, x : x + width]


@pytest.mark.parametrize("depth", [1.0, 2.0, 4.0])
def test_stereo_parallax_as_drawn(depth: float) -> None:
    """The parallax on the screen, right minus left, is e (Z - Z0) / Z."""
    display = StereoDisplay("anaglyph", 0.063, 2.0)
    _, drawn, (left, right) = show(display, camera_world([np.array([0.0, 0.0, -depth])], 0.09 * depth))
    at = [centroid(part(drawn, eye)) for eye in (left, right)]
    metres_per_px = 2.0 * (left.tangents[1] - left.tangents[0]) / SIZE[0]
    assert abs((at[1][0] - at[0][0]) - 0.063 * (depth - 2.0) / depth / metres_per_px) <= 0.1
    assert abs(at[1][1] - at[0][1]) <= 0.05


def test_markers_stand_where_the_walls_say(tmp_path: Path) -> None:
    walls = [
        {"name": "front", "lower_left": [-1, 0, -1], "lower_right": [1, 0, -1], "upper_left": [-1, 2, -1]},
        {"name": "right", "lower_left": [1, 0, -1], "lower_right": [1, 0, 1], "upper_left": [1, 2, -1]},
    ]
    file = tmp_path / "walls.json"
    file.write_text(json.dumps({"format": "mimics.walls/1", "head": [0.2, 1.2, 0.1], "walls": walls}))
    display = WallDisplay("cave", load_walls(file))
    # In the room (0.5, 1.4, -1) and (1, 1.4, -0.5), at the walls; the camera is at the head, at the world's origin.
    for number, at in enumerate(([0.5, 1.4, -1.0], [1.0, 1.4, -0.5])):
        place = np.array(at) - [0.2, 1.2, 0.1]
        eye_axes = display.eyes(Viewpoint(np.eye(4), FOV), (200, 100), 0)[number].world_from_eye[:3, :3]
        world = make_disc_world([place], eye_axes, 0.07)
        world.root.create_child("eye").create_camera(FOV, 0.05, 50.0)
        world.update()
        shown, _, eyes = show(display, world, (200, 200))
        assert shown.shape[:2] == (200, 400)
        x, y = centroid(part(shown, eyes[number]))
        across = (at[0] + 1.0) / 2.0 if number == 0 else (at[2] + 1.0) / 2.0
        assert abs(x - 200 * across) <= 0.5
        assert abs(y - 200 * at[1] / 2.0) <= 0.5  # centroids count from below


def linear(display_value: np.ndarray) -> np.ndarray:
    v = display_value / 255.0
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
def test_glasses_get_the_mixture_of_dubois_in_linear_light(backend: str) -> None:
    world = camera_world([np.array([0.1, 0.0, -1.2]), np.array([-0.3, 0.1, -2.5])], 0.25)
    shown, drawn, (left, right) = show(StereoDisplay("anaglyph"), world, SIZE, backend)
    both = np.concatenate([linear(part(drawn, eye)[..., :3].astype(float)) for eye in (left, right)], axis=-1)
    mixed = np.clip(both @ DUBOIS_RED_CYAN.T, 0.0, 1.0)
    wanted = 255.0 * np.where(mixed <= 0.0031308, 12.92 * mixed, 1.055 * mixed ** (1 / 2.4) - 0.055)
    assert np.abs(shown[..., :3] - wanted).max() <= 1.0
    assert np.abs(shown[..., 0].astype(int) - shown[..., 1]).max() > 100  # the eyes differ


def test_rows_alternate_beginning_with_the_left_eye_on_top() -> None:
    world = camera_world([np.array([0.1, 0.0, -1.2])], 0.25)
    shown, drawn, (left, right) = show(StereoDisplay("interleaved"), world)
    np.testing.assert_array_equal(shown[0::2], part(drawn, left)[0::2])
    np.testing.assert_array_equal(shown[1::2], part(drawn, right)[1::2])
    swapped, _, _ = show(StereoDisplay("interleaved", swap=True), world)
    assert np.abs(swapped.astype(int) - shown).max() > 100


def test_a_lens_shows_a_grid_straight() -> None:
    """Points at known directions are found on the panel where the lens's inverse says, per colour."""
    spec = HeadsetSpec()
    world = camera_world([np.array([0.25, 0.2, -1.0]) - [0.0315, 0.0, 0.0]], 0.10)
    shown, _, _ = show(RawHeadset(spec), world, (800, 400))
    left = shown[:, :400]
    eye = spec.left
    centre = np.array(eye.lens.centre)
    for channel, k in enumerate((eye.lens.red, eye.lens.green, eye.lens.blue)):
        # The disc's edge bends with the lens; its middle is taken from where many of its points are shown.
        angle = np.linspace(0, 2 * np.pi, 720, endpoint=False)
        radii = np.sqrt((np.arange(24) + 0.5) / 24) * 0.10
        disc = np.array([0.25, 0.2]) + (radii[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], -1)).reshape(
            -1, 2
        )
        panel = undistort(disc - centre, k) + centre
        # Panel area per direction: the picture's centroid weighs by it.
        r2 = np.sum((panel - centre) ** 2, axis=-1)
        stretch = (1 + k[0] * r2 + k[1] * r2**2) * (1 + 3 * k[0] * r2 + 5 * k[1] * r2**2)
        at = (panel / stretch[:, None]).sum(axis=0) / (1 / stretch).sum()
        x = (at[0] - eye.tangents[0]) / (eye.tangents[1] - eye.tangents[0]) * 400
        y = (eye.tangents[3] - at[1]) / (eye.tangents[3] - eye.tangents[2]) * 400
        weight = linear(left[..., channel].astype(float)) ** (1 / 2.2)
        ys, xs = np.mgrid[0:400, 0:400] + 0.5
        found = (weight * xs).sum() / weight.sum(), (weight * ys).sum() / weight.sum()
        assert math.dist(found, (x, y)) <= 0.5


def test_the_head_is_asked_once_more_and_the_picture_is_from_there() -> None:
    """A frame queued from one place and latched at another is that of the other, to rounding."""
    world = camera_world([np.array([0.1, 0.0, -1.2]), np.array([-0.3, 0.1, -2.5])], 0.25)
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)
        before = np.eye(4)
        after = pose_from_parts((0.02, -0.01, 0.03), (0.0, math.sin(0.01), 0.0, math.cos(0.01)))
        tangents = compute_tangents(FOV, SIZE)
        queued, moved = (View(pose, tangents, (0, 0, *SIZE)) for pose in (before, after))
        renderer.draw([moved])
        wanted = read_pixels(surface).astype(int)
        renderer.draw([queued])
        old = read_pixels(surface).astype(int)
        renderer.draw([queued], lambda: [moved])
        found = read_pixels(surface).astype(int)
        renderer.release()
    assert (np.abs(wanted - old).max(axis=-1) > 8).sum() > 200
    assert (np.abs(wanted - found).max(axis=-1) > 8).sum() == 0


@pytest.mark.parametrize("kind", ["sbs", "sbs-half", "tb", "anaglyph"])
def test_a_pointer_points_into_the_picture_of_the_eye_it_is_over(kind: str) -> None:
    """The ray through where a ball is seen meets the ball, in either half; where the eyes lie over each other too."""
    place = np.array([0.2, 0.1, -2.0])
    world = camera_world([place], 0.1)
    with create_surface("egl", SIZE) as surface:
        presenter = Presenter(StereoDisplay(kind), surface)
        presenter.begin(0)
        for view in presenter.views(world.cameras[0]):
            seen = view.clip_from_world @ [*place, 1.0]
            x, y, width, height = view.rectangle if kind != "anaglyph" else (0, 0, *SIZE)
            whole = SIZE
            at = (np.array([x, y]) + 0.5 * (seen[:2] / seen[3] + 1.0) * (width, height)) / whole * 2.0 - 1.0
            origin, direction = presenter.ray(world.cameras[0], *at.tolist())
            nearest = origin + direction * ((place - origin) @ direction) / (direction @ direction)
            assert np.linalg.norm(nearest - place) <= (1e-9 if kind != "anaglyph" else 0.032)
        presenter.release()


def test_a_headset_of_other_panels_than_the_window_is_mirrored_in_it() -> None:
    spec = HeadsetSpec(pixels=(120, 100))
    display = HeadsetDisplay("sim-hmd", SimulatedRuntime(spec))
    world = camera_world([np.array([0.0, 0.0, -1.5])], 0.3)
    with create_surface("egl", (320, 160)) as surface:
        presenter = Presenter(display, surface)
        renderer = Renderer(presenter.drawn, world, PLAIN)
        presenter.begin(0)
        renderer.draw(presenter.views(world.cameras[0]))
        presenter.present()
        panels, mirror = read_pixels(presenter.drawn), read_pixels(surface)
        assert surface.ctx.error == "GL_NO_ERROR"
        renderer.release()
        presenter.release()
    assert panels.shape[:2] == (100, 240) and mirror.shape[:2] == (160, 320)
    share = [float((picture[..., 0] > 128).mean()) for picture in (panels, mirror)]
    assert share[0] > 0.01 and share[1] == pytest.approx(share[0], rel=0.05)
