"""Draws a world on a surface of one backend and checks the driver's conscience afterwards.

Run as a script it draws the tunnel in a process of its own, because a dying X server takes its clients along:

    python -m tests.golden.drawing BACKEND OUT.npy
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.world import World
from tests.golden.demo_world import make_tunnel_world

SIZE = (480, 270)
Picture = NDArray[np.uint8]


def draw_world(
    surface: Surface, world: World, views: Sequence[View], settings: RenderSettings | None = None, hud: bool = False
) -> Picture:
    """The picture of a world, RGBA [height, width, 4], row 0 at the top. Fails on any GL error."""
    renderer = Renderer(surface, world, settings)
    if hud:
        lay_out(renderer.hud, surface.size)
    for _ in range(2):  # the second frame meets buffers and caches the first one left
        stats = renderer.draw(views)
        assert surface.ctx.error == "GL_NO_ERROR"
    assert stats.draws > 0
    picture = read_pixels(surface)
    renderer.release()
    assert surface.ctx.error == "GL_NO_ERROR"
    return picture


def draw_offscreen(
    world: World, views: Sequence[View], size: tuple[int, int] = SIZE, settings: RenderSettings | None = None
) -> Picture:
    """The picture under EGL."""
    with create_surface("egl", size) as surface:
        return draw_world(surface, world, views, settings)


def draw_tunnel(surface: Surface) -> Picture:
    """The tunnel with its heads-up display: every pass, every technique."""
    world = make_tunnel_world()
    return draw_world(surface, world, desktop_views(world.cameras[0], surface.size), hud=True)


def lay_out(hud: Hud, size: tuple[int, int]) -> None:
    """One of everything a heads-up display can show."""
    hud.width = 720.0 * size[0] / size[1]
    hud.box(20.0, 640.0, 320.0, 60.0, (0.06, 0.08, 0.11, 0.62), radius=12.0)
    hud.text(36.0, 667.0, "Tunnel", 20.0)
    hud.text(324.0, 667.0, "34 %", 20.0, bold=True, align="right")
    hud.bar((36.0, 650.0, 288.0, 10.0), 0.34, (0.30, 0.74, 0.92, 1.0))
    hud.box(560.0, 40.0, 160.0, 60.0, (0.9, 0.3, 0.1, 1.0), radius=16.0, border=4.0)


def main(backend: str, out: Path) -> None:
    """Draw the tunnel; for a window what its back buffer holds, after one resize there and back."""
    with create_surface(backend, SIZE) as surface:
        picture = draw_tunnel(surface)
        if backend == "window":
            picture = _through_the_glass(surface)
        np.save(out, picture)


def _through_the_glass(surface: Surface) -> Picture:
    from mimics_app.rendering.visual.surfaces.window import WindowSurface

    assert isinstance(surface, WindowSurface)
    surface.swap()
    surface.poll()
    surface.resize((320, 200))
    surface.resize(SIZE)
    draw_tunnel(surface)
    surface.present()
    screen = surface.ctx.screen.read(viewport=(0, 0, *SIZE), components=4)
    _ = surface.ctx.error  # moderngl reads a colour attachment that windows lack; this clears the error
    pixels = np.frombuffer(screen, np.uint8).reshape(SIZE[1], SIZE[0], 4)[::-1]
    assert surface.ctx.error == "GL_NO_ERROR"
    return pixels.copy()


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
