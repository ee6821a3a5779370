"""Film of recorded runs, drawn without a window."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from mimics_app.app.picture.drawn import Drawn
from mimics_app.app.picture.picture import picture_quality
from mimics_app.app.picture.video import Film
from mimics_app.app.replay_view.pane import Panes
from mimics_app.app.replay_view.replayed_scene import ReplayedScene
from mimics_app.contracts.clock import FRAMES_PER_SECOND, SECOND_NS, MonotonicClock
from mimics_app.contracts.errors import OutputError
from mimics_app.rendering.visual.frame_set import FrameSet
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.headless import open_offscreen
from mimics_app.rendering.visual.surfaces.surface import Size, Surface

__all__ = ["draw_replay", "quality_of"]


def draw_replay(
    runs: Sequence[ReplayedScene],
    video: Path,
    size: Size,
    camera: str = "",
    *,
    forces: bool,
    speed: float = 1.0,
    backend: str = "auto",
) -> Drawn:
    """Draw one run, or two side by side, into a film of 60 frames per second.

    Args:
        runs: The runs, one or two; both show the same time from their first frame on, and the longer one ends the film.
        video: File of the film, see `video.film_place`.
        size: Size of the picture [px].
        camera: See `Panes`.
        forces: See `Panes`.
        speed: Session time per time of the film.
        backend: "auto", "egl" or "osmesa".

    Raises:
        SceneError: A scene has no camera of that name.
        OutputError: The film cannot be written, or not to its end.
        DeviceError: The OpenGL context is not available.
    """
    surface = open_offscreen(backend, size)
    panes = Panes(surface, runs, quality_of, camera, forces=forces)
    film, clock, spent = Film(surface, video, live=False), MonotonicClock(), []
    length_ns = max(int(run.times_ns[-1]) for run in runs)
    for number in range(1 + round(length_ns / speed * FRAMES_PER_SECOND / SECOND_NS)):
        film_ns = number * SECOND_NS // FRAMES_PER_SECOND
        began_ns = clock.now_ns()
        for run in runs:
            run.to(run.number_at(speed * film_ns))
        panes.draw(film_ns)
        spent.append(1e-6 * (clock.now_ns() - began_ns))
        film.take(film_ns)
    film.close()
    drawn = Drawn.on(surface, FrameSet([film.place], sorted(spent)[len(spent) // 2]))
    panes.close()
    if film.problem:
        raise OutputError(film.place, film.problem, "free some space, or give another --video")
    return drawn


def quality_of(replayed: ReplayedScene, _: Surface) -> RenderSettings:
    """Return the quality of a run's pictures, as the session drew them without a window."""
    return picture_quality(replayed.scene, replayed.profile)
