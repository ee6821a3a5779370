"""A sequence of frames, each saved as a PNG file."""

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
    """Result of `render_frames`: the files in order, and the median drawing time of a frame [ms]."""

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
    """Draw frames and save them as frame_00000.png, frame_00001.png, ...; see `Presenter.save` for several eyes.

    The first frame is drawn once beforehand, so that shader compilation is not measured.

    Args:
        renderer: Renderer that draws on `surface`.
        surface: Any surface; a window shows the frames too.
        count: Number of frames, >= 1.
        views: Called with the frame number before each frame: moves the world, returns the views.
        folder: Folder of the files; created when missing.
        presenter: Presenter of the display; None for a plain picture.
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
