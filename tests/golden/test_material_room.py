"""One of every material, light and shadow on one sheet, today and tomorrow, under EGL and OSMesa."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.surface import Surface
from tests.golden.drawing import draw_world
from tests.golden.material_world import make_room

KINDS = ("texture_additive", "texture_modulative", "stencil_additive", "stencil_modulative")
SIZE = (320, 180)


def draw_sheet(surface: Surface) -> NDArray[np.uint8]:
    """The room with each kind of shadows, two by two."""
    pictures = []
    for kind in KINDS:
        world = make_room()
        settings = RenderSettings(shadow_size=1024, shadows=kind, shadow_distance=12.0, fog_density=0.0)
        pictures.append(draw_world(surface, world, desktop_views(world.cameras[0], SIZE), settings))
    return np.concatenate([np.concatenate(pictures[:2], axis=1), np.concatenate(pictures[2:], axis=1)])


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
def test_the_room_looks_as_it_did(backend, assert_golden):
    try:
        surface = create_surface(backend, SIZE)
    except DeviceError as error:
        pytest.skip(str(error))
    with surface:
        software = "llvmpipe" in surface.ctx.info["GL_RENDERER"]
        sheet = draw_sheet(surface)
    assert_golden(sheet, "material_room", *((1, 0.999) if software else (12, 0.97)))
