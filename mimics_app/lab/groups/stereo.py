"""Methods to draw two eyes, one after the other or both at once.

Cost: processor time of finished frames of both eyes side by side: of a thousand small bodies with a material each,
bound by calls to the driver, and of fewer and larger ones that share one; sizes count bodies of the first kind. Error:
share of the pixels that differ from two passes. Viewports need eyes that are not side by side: there one is above the
other.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from statistics import median

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.clock import process_seconds
from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.lab.visual.probe import differing_pixels
from mimics_app.rendering.visual.displays.stereo import StereoDisplay
from mimics_app.rendering.visual.presenting.presenter import Presenter
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings, StereoPasses
from mimics_app.rendering.visual.surfaces.headless import open_offscreen, read_pixels
from mimics_app.rendering.visual.surfaces.surface import Size, Surface
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import box, icosphere, plane
from mimics_app.world.content.world import World

__all__ = ["WORKLOADS", "body_world", "show_stereo", "turns"]


WORKLOADS: dict[str, tuple[int, int, bool, Size]] = {
    "draws": (1000, 0, True, (64, 72)),
    "small bodies": (400, 1, False, (160, 180)),
    "bodies": (200, 2, False, (320, 360)),
    "vertices": (20, 5, False, (640, 720)),
    "pixels": (10, 3, False, (960, 1080)),
}
"""Number of bodies, subdivisions (20 x 4^n triangles), whether each has a material, and size of an eye's picture."""

_TURNS = 15
_WALL, _DISTANCE = 3.0, 4.0
"""Side of the square that the bodies fill, and its distance [m]."""
_SETTINGS = RenderSettings(msaa=0, tone_map="none", occlusion="off")
_ERROR_SIZE = (640, 360)


def body_world(bodies: int, subdivisions: int, *, own_materials: bool) -> World:
    """Return balls and boxes in rows, all visible to both eyes, in the sun and over a floor."""
    across = math.ceil(math.sqrt(bodies))
    step = _WALL / across
    world = World()
    world.environment = Sky((0.3, 0.5, 0.9), (0.7, 0.75, 0.8), (0.3, 0.3, 0.3), 0.6)
    world.meshes |= {"ball": icosphere(0.4 * step, subdivisions), "floor": plane(30.0, 30.0)}
    world.meshes["box"] = box(0.6 * step, 0.6 * step, 0.6 * step)
    names = [f"paint {k}" for k in range(bodies if own_materials else 1)]
    for k, name in enumerate(names):
        shade = 0.2 + 0.6 * (k % 97) / 97.0
        world.set_material(Material(name, "lit", (shade, 1.0 - shade, 0.5, 1.0), roughness=0.3))
    world.root.create_child("", (0.0, -0.5 * _WALL, -10.0)).create_entity("floor", names[0])
    for k in range(bodies):
        across_k, up_k = k % across - 0.5 * (across - 1), k // across - 0.5 * (across - 1)
        place = (step * across_k, step * up_k, -_DISTANCE - 0.3 * (k % 5))
        world.root.create_child("", place).create_entity("box" if k % 4 == 3 else "ball", names[k % len(names)])
    world.root.create_child("eye").create_camera(1.0, 0.05, 80.0)
    world.update()
    return world


@contextmanager
def _opened(world: World, eye_size: Size, *passes: StereoPasses) -> Iterator[list[Callable[[], NDArray[np.uint8]]]]:
    """Open a surface; yield for each method a function that draws a frame of both eyes and returns it."""
    above = "viewports" in passes
    size = (eye_size[0], 2 * eye_size[1]) if above else (2 * eye_size[0], eye_size[1])
    with open_offscreen("auto", size) as surface:
        presenter = Presenter(StereoDisplay("tb" if above else "sbs"), surface)
        renderers = [Renderer(surface, world, replace(_SETTINGS, stereo=each)) for each in passes]
        presenter.begin(0)
        views = presenter.views(world.cameras[0])
        yield [partial(_draw, renderer, views, surface) for renderer in renderers]
        for renderer in renderers:
            renderer.release()
        presenter.release()


def _draw(renderer: Renderer, views: Sequence[View], surface: Surface) -> NDArray[np.uint8]:
    renderer.draw_finished(views)
    return read_pixels(surface)


def show_stereo(world: World, eye_size: Size, *passes: StereoPasses) -> list[NDArray[np.uint8]]:
    """Return the pictures of both eyes side by side by each method; one above the other where one is viewports.

    RGBA, row 0 at the top.
    """
    with _opened(world, eye_size, *passes) as drawn:
        return [draw() for draw in drawn]


def turns(workload: str, *passes: StereoPasses) -> list[list[float]]:
    """Return the processor time of frames of a workload by each method [us], alternately, over all threads.

    Elapsed time would include the other load of the machine.

    Raises:
        DeviceError: No driver works without a display.
    """
    bodies, subdivisions, own, size = WORKLOADS[workload]
    with _opened(body_world(bodies, subdivisions, own_materials=own), size, *passes) as drawn:
        for draw in drawn:
            draw()
        frames = [[_processor_us(draw) for draw in drawn] for _ in range(_TURNS)]
    return [list(times) for times in zip(*frames, strict=True)]


def _processor_us(work: Callable[[], object]) -> float:
    started = process_seconds()
    work()
    return 1e6 * (process_seconds() - started)


def _three_frames_us(passes: StereoPasses) -> float:
    """Return the sum over workloads bound by calls and by bodies of different sizes [us]."""
    return sum(median(turns(workload, passes)[0]) for workload in ("draws", "small bodies", "bodies"))


def _cost_us(passes: StereoPasses, bodies: int) -> float:
    world = body_world(bodies, 0, own_materials=True)
    with _opened(world, WORKLOADS["draws"][3], passes) as drawn:
        drawn[0]()
        return median(_processor_us(drawn[0]) for _ in range(_TURNS))


def _error(passes: StereoPasses) -> float:
    one, other = show_stereo(body_world(60, 3, own_materials=True), _ERROR_SIZE, "two_pass", passes)
    return differing_pixels(one, other)


def _rival(passes: StereoPasses, name: str, source: str, valid: str) -> Rival:
    return Rival(name, source, valid, {"stereo": passes}, (passes,), cost=partial(_three_frames_us, passes))


compare(
    __name__,
    "three frames of both eyes: of 1000 bodies of as many materials, of 400 and of 200 of one; error: share "
    "of pixels that differ at all from two passes",
    "share of pixels",
    [
        _rival("two_pass", "two passes", "one eye after the other, over one queue", "any"),
        _rival(
            "viewports",
            "two viewports",
            "every second instance for the other eye, into a viewport of its own",
            "eyes not side by side, GL_ARB_shader_viewport_layer_array, no vertex shader that a scene brings",
        ),
        _rival(
            "clip_distance",
            "two halves",
            "every second instance for the other eye, into its half of one viewport, clipped at the middle "
            "(Wilson 2015)",
            "eyes side by side; no vertex shader that a scene brings",
        ),
    ],
    Probes(_cost_us, _error),
    default="two halves",
    growth=Growth(work="bodies", sizes=(1, 10, 100, 1000)),
    why_default="one pass saves a quarter of a frame that is bound by its draws and costs no more elsewhere "
    "(`mimics bench displays` measures each kind of frame; this chart adds three of them)",
)
