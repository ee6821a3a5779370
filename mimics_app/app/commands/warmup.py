"""`mimics warmup`: compile the kernels now, so that the first run starts at once."""

from __future__ import annotations

import argparse
import gc
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from mimics_app.app.terminal.output import answer

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["PARTS", "add_arguments", "compile_beside", "run"]

_COLLECTOR = (50_000, 20, 20)
"""Thresholds of the garbage collector while compiling: a compiler makes millions of live objects.
At Python's own thresholds, scanning them takes 8 % of the time."""
_MEGABYTE = 1e6
_SIZE = (64, 36)
_SECONDS = 0.1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics warmup`: none."""


def run(args: argparse.Namespace) -> int:
    """Compile every kernel of a run that is not in the cache yet."""
    from mimics_app.compiled.cache_folder import cache_folder
    from mimics_app.compiled.kernel_sweep import cache_bytes
    from mimics_app.contracts.clock import MonotonicClock

    clock = MonotonicClock()
    started = clock.now_ns()
    if not args.json:
        sys.stderr.write("compiling kernels: some minutes the first time ...\n")
    _compile_everything()
    seconds = (clock.now_ns() - started) * 1e-9
    folder, size = "", 0
    if cache_folder is not None:
        folder, size = str(cache_folder), cache_bytes(cache_folder)
    if not args.json:
        kept = f"{folder} ({size / _MEGABYTE:.0f} MB)" if folder else "memory only"
        sys.stderr.write(f"kernels ready in {seconds:.1f} s, kept in {kept}\n")
    answer(args, {"seconds": seconds, "cache": folder, "bytes": size}, ())
    return 0


def _compile_everything() -> None:
    """Compile the large parts in parallel, then what the shipped scenes still need."""
    from mimics_app.app.terminal.progress import ProgressBar

    tasks = _shipped_tasks()
    with ProgressBar(sys.stderr, len(tasks)) as bar:
        for part in compile_beside(tasks):
            bar.step(part)


def _shipped_tasks() -> dict[str, Callable[[], None]]:
    """Return tasks that compile all that shipped scenes need: `PARTS`, then each scene, those without a loop first.

    The scenes are not loaded: the code that checks them would compile a part in this process.
    """
    from mimics_app.app.scenes.shipped import is_only_looked_at
    from mimics_app.contracts.system.resources import root

    files = sorted((root() / "scenes").glob("*.json"), key=lambda file: (not is_only_looked_at(file), file))
    return {**PARTS, **{file.stem: partial(_draw_start, file) for file in files}}


def compile_beside(tasks: Mapping[str, Callable[[], None]]) -> Iterator[str]:
    """Run tasks in order on all processors; yield the name of each when it is done."""
    from concurrent.futures import ProcessPoolExecutor, as_completed
    from multiprocessing import get_context

    workers = min(len(tasks), os.cpu_count() or 1)
    context = get_context("spawn")
    with ProcessPoolExecutor(workers, context, initializer=gc.set_threshold, initargs=_COLLECTOR) as pool:
        working = {pool.submit(task): name for name, task in tasks.items()}
        for done in as_completed(working):
            done.result()
            yield working[done]


def _draw_start(file: Path) -> None:
    """Play a scene for a moment and draw it small; without graphics run its loop alone."""
    from mimics_app.app.play.stills import draw_stills
    from mimics_app.app.scenes.loading import load_checked_scene
    from mimics_app.app.scenes.scenario_choice import is_playable
    from mimics_app.app.settings import RunSettings
    from mimics_app.contracts.errors import DeviceError

    with TemporaryDirectory(prefix="mimics-") as folder:
        try:
            draw_stills(RunSettings(file, size=_SIZE), Path(folder), seconds=_SECONDS)
        except DeviceError:
            scene = load_checked_scene(file)
            if is_playable(scene):
                _play_start(scene)


def _objects() -> None:
    """Compile all haptic objects but tunnels."""
    from mimics_app.rendering.haptic import simulate  # noqa: F401


def _loops() -> None:
    """Compile the tick: live, untimed and replayed."""
    from mimics_app.rendering.haptic import live_loop, loop, replay_loop  # noqa: F401


def _devices() -> None:
    """Compile the shipped devices and force fields."""
    from mimics_app.rendering.haptic import cord_field, standard_fields  # noqa: F401
    from mimics_app.rendering.haptic.devices import (  # noqa: F401
        pointer,
        replay,
        simulated_impedance,
        simulated_leg,
        simulated_lokomat,
    )


PARTS: Mapping[str, Callable[[], None]] = {"objects": _objects, "loop": _loops, "devices": _devices}
"""Functions that compile a part by importing it, in a process of its own; longest first."""


def _play_start(scene: Scene) -> None:
    """Play a scene up to the start of its first trial, without a picture."""
    from mimics_app.app.session.core import open_core
    from mimics_app.app.session.frame import Frames
    from mimics_app.app.session.preparation import prepare_scene
    from mimics_app.app.settings import RunSettings

    with open_core(prepare_scene(scene, RunSettings(scene.path))) as core:
        Frames(core).play_to_start()
