"""The viewer without a window: one picture, or a turntable, as PNG files."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from mimics_app.app.settings import Profile
from mimics_app.app.viewer.page import draw_caption
from mimics_app.app.viewer.shown import Shown
from mimics_app.app.viewer.stage import ViewerStage
from mimics_app.rendering.visual.headless import open_offscreen, save_png
from mimics_app.rendering.visual.surface import Size

__all__ = ["ViewerStills", "draw_turntable"]


@dataclass(frozen=True, slots=True)
class ViewerStills:
    """What was drawn: files, backend, driver, and median time per frame [ms]."""

    files: list[Path]
    backend: str
    gl: str
    ms_median: float


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
) -> ViewerStills:
    """Draw a thing from as many sides as there are frames, spread over one turn.

    Args:
        shown: What.
        output: The PNG file; of several frames NAME_000.png and so on.
        size: Of the picture [px].
        frames: How many, >= 1.
        backend: "auto", "egl", "osmesa" or "window".
        profile: Quality of a scene's picture.
        camera: As `ViewerStage`.
        caption: True writes name and notes over the picture.

    Raises:
        SceneError: there is nothing to see, or no camera of that name.
        DeviceError: the context cannot be had.
    """
    output.parent.mkdir(parents=True, exist_ok=True)
    surface = open_offscreen(backend, size)
    stage = ViewerStage(surface, shown, profile, camera)
    if caption:
        stage.renderer.hud.width = 720.0 * size[0] / size[1]
        draw_caption(stage.renderer.hud, shown.title, [shown.size], shown.notes)
    files, spent = [], []
    stage.draw()
    surface.ctx.finish()
    for number in range(frames):
        spent.append(stage.draw_finished().cpu_ms)
        file = output if frames == 1 else output.with_name(f"{output.stem}_{number:03d}{output.suffix}")
        save_png(surface, file)
        files.append(file)
        stage.eye.yaw += 2.0 * math.pi / frames
    info = surface.ctx.info
    stills = ViewerStills(
        files, surface.backend, f"{info['GL_VERSION']}, {info['GL_RENDERER']}", round(median(spent), 3)
    )
    stage.release()
    surface.close()
    return stills
