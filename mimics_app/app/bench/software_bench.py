"""`mimics bench software`: what each part of drawing in software saves, by turns with and without it in one session."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from statistics import median
from typing import Any

from mimics_app.app.picture.picture import Picture, live_quality
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.scene_search import find_scene
from mimics_app.app.session.core import open_core
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.preparation import prepare_scene
from mimics_app.app.session.switched_off import NullRecorder
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.clock import process_seconds
from mimics_app.rendering.visual.surfaces.headless import open_offscreen
from mimics_app.rendering.visual.surfaces.rasteriser import leave_out, rasteriser_of
from mimics_app.rendering.visual.surfaces.surface import Size
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["measure_software"]

_SCENES = (Path("wavy_tunnel"), Path("pick_and_place"), Path("avatar_cord"))
_WARM_UP = 6
"""Number of frames drawn first, in which the driver compiles and pictures begin to be kept."""


def measure_software(scenes: Sequence[Path], size: Size, frames: int, report: Callable[[str], None]) -> dict[str, Any]:
    """Return the processor time of a frame with every part over that without one of them, by scene and part.

    All pictures of a scene show the same session on the virtual clock, at the quality of a live one, each in a context
    of its own; in every frame all of them are drawn in turn.

    Args:
        scenes: Scene files; () for three of the shipped ones.
        size: Size of the picture [px].
        frames: Number of frames.
        report: Called with the name of each scene before it is played.

    Returns:
        By scene: `ms` of a frame with all parts, and the median ratio of each part by its name; no part where a
        graphics card draws. The copy to a window is in no picture, and the place of threads saves time, not processor
        time.
    """
    found = {}
    for path in scenes or _SCENES:
        scene = load_checked_scene(find_scene(path))
        report(f"software: {scene.name}")
        found[scene.name] = _measure_scene(scene, size, frames)
    return {"scenes": found}


def _measure_scene(scene: Scene, size: Size, count: int) -> dict[str, Any]:
    core = open_core(prepare_scene(scene, RunSettings(scene.path, size=size)), NullRecorder)
    with ExitStack() as closing:
        closing.callback(core.stop)
        frames = Frames(core)
        frames.play_to_start()
        pictures: dict[str, Picture] = {}
        for part in (None, *_parts()):
            pictures["" if part is None else part.__name__] = picture = _open(scene, core.world, size, part)
            closing.callback(_close, picture)
        spent: dict[str, list[float]] = {name: [] for name in pictures}
        for number in range(_WARM_UP + count):
            frames.advance_frame()
            for name, picture in pictures.items() if number % 2 else reversed(pictures.items()):
                spent[name].append(_draw(frames, picture))
    whole = spent.pop("")[_WARM_UP:]
    ratios = {
        name: round(median(a / b for a, b in zip(whole, each[_WARM_UP:], strict=True)), 3)
        for name, each in spent.items()
    }
    return {"ms": round(1e3 * median(whole), 2), "ratios": ratios}


def _parts() -> tuple[type, ...]:
    with open_offscreen("auto", (8, 8)) as surface:
        return rasteriser_of(surface.ctx).parts


def _open(scene: Scene, world: World, size: Size, part: type | None) -> Picture:
    surface = open_offscreen("auto", size)
    if part is not None:
        leave_out(surface.ctx, part)
    settings = live_quality(scene, "training", surface)
    return Picture(surface, scene, world, settings)


def _draw(frames: Frames, picture: Picture) -> float:
    """Draw a frame; return its processor time, over all threads [s]."""
    with picture.surface.ctx:
        views = picture.views
        started = process_seconds()
        picture.lay_out(frames.board, views)
        picture.renderer.draw_finished(views)
        return process_seconds() - started


def _close(picture: Picture) -> None:
    entered = ExitStack()
    entered.enter_context(picture.surface.ctx)
    picture.close()
    entered.pop_all()  # the context has ended, and is not left
