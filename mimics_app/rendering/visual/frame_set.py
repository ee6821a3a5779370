"""Frames one after another, each a PNG file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from mimics_app.rendering.visual.presenting.presenter import Presenter
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.surfaces.headless import save_png
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.view import View

__all__ = ["FrameSet", "render_frames"]


@dataclass(frozen=True)
class FrameSet:
    """What `render_frames` made: the files in order, and the median time of drawing a frame [ms]."""

    files: list[Path]
    ms_median: float


def render_frames(
    renderer: Renderer,
    surface: Surface,
    count: int,
    views: Callable[[int], Sequence[View]],
    folder: Path,
    presenter: Presenter | None = None,
) -> FrameSet:
    """Draw frames and save each as frame_00000.png, frame_00001.png, ...; see `Presenter.save` for more eyes than one.

    The first is drawn once before, so that the driver's compiling is not counted.

    Args:
        renderer: Draws on `surface`.
        surface: Any; a window shows the frames too.
        count: Number of frames, >= 1.
        views: Called with the number of each frame before it is drawn: moves the world, returns the eyes.
        folder: Where the files go; made when it is missing.
        presenter: Of the display, None for a plain picture.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files, spent = [], []
    renderer.draw(views(0))
    surface.ctx.finish()
    for number in range(count):
        spent.append(renderer.draw_finished(views(number)).cpu_ms)
        file = folder / f"frame_{number:05d}.png"
        if presenter is None:
            save_png(surface, file)
            files.append(file)
        else:
            presenter.present()
            files += presenter.save(file)
        surface.swap()
    return FrameSet(files, median(spent))
