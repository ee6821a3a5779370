"""The viewer without a window: one picture, or a turntable, as PNG files."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from statistics import median

from mimics_app.app.picture.drawn import Drawn
from mimics_app.app.picture.video import draw_film
from mimics_app.app.settings import Profile
from mimics_app.app.viewer.page import draw_caption
from mimics_app.app.viewer.shown import Shown
from mimics_app.app.viewer.viewport import Viewport
from mimics_app.rendering.visual.frame_set import FrameSet
from mimics_app.rendering.visual.surfaces.headless import open_offscreen, save_png
from mimics_app.rendering.visual.surfaces.surface import Size
from mimics_app.rendering.visual.view import View

__all__ = ["draw_turntable"]


def draw_turntable(
    shown: Shown,
    output: Path,
    size: Size,
    *,
    frames: int = 1,
    backend: str = "auto",
    profile: Profile = "training",
    camera: str = "",
    caption: bool = False,
    video: Path | None = None,
) -> Drawn:
    """Draw one picture per frame, spread over one full rotation of the camera.

    Args:
        shown: The model or scene.
        output: The PNG file; for several frames NAME_000.png and so on.
        size: Size of the picture [px].
        frames: Number of frames, >= 1.
        backend: "auto", "egl", "osmesa" or "window".
        profile: Quality of a scene's picture.
        camera: See `Viewport`.
        caption: True draws name and notes over the picture.
        video: File of a video (see `video.film_place`) instead of PNG files, or None.

    Raises:
        SceneError: Nothing is visible, or there is no camera of that name.
        DeviceError: The OpenGL context is not available.
    """
    output.parent.mkdir(parents=True, exist_ok=True)
    surface = open_offscreen(backend, size)
    viewport = Viewport(surface, shown, profile, camera)
    if caption:
        viewport.renderer.hud.fit(size)
        draw_caption(viewport.renderer.hud, shown.title, [shown.size], shown.notes)
    yaw = viewport.orbit.yaw

    def views(number: int) -> list[View]:
        viewport.orbit.yaw = yaw + 2.0 * math.pi * number / frames
        return viewport.views()

    viewport.draw()
    surface.ctx.finish()
    if video is not None:
        made = draw_film(viewport.renderer, surface, frames, views, video)
    else:
        made = _draw_files(viewport, frames, views, output)
    drawn = Drawn.on(surface, made)
    viewport.release()
    surface.close()
    return drawn


def _draw_files(viewport: Viewport, frames: int, views: Callable[[int], list[View]], output: Path) -> FrameSet:
    """Draw one PNG file per frame; a single frame goes to the requested file itself."""
    files, spent = [], []
    for number in range(frames):
        spent.append(viewport.renderer.draw_finished(views(number)).cpu_ms)
        file = output if frames == 1 else output.with_name(f"{output.stem}_{number:03d}{output.suffix}")
        save_png(viewport.surface, file)
        files.append(file)
    return FrameSet(files, median(spent))
