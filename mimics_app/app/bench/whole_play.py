"""A scene played with the methods of a plan, whose whole ticks and whole frames are timed."""

from __future__ import annotations

from statistics import median
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.picture.methods import with_methods
from mimics_app.app.picture.picture import Picture, picture_quality
from mimics_app.app.planner.plan import Plan
from mimics_app.app.session.core import open_core
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.preparation import prepare_scene
from mimics_app.app.session.switched_off import NullRecorder
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.arrays import U1
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.loop.object_rows import Rows
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.rendering.haptic.object_statics import ObjectStatics
from mimics_app.rendering.haptic.replay import replay_run
from mimics_app.rendering.visual.surfaces.headless import open_offscreen, read_pixels
from mimics_app.world.files.scene.scene import Scene

__all__ = ["WholePlay"]

_SEED = 1

_TICKS, _CALLS = 1000, 5
"""Number of ticks of a timed call, and of calls."""

_WARM_UP, _DRAWN = 2, 5
"""Number of frames drawn first, in which the driver compiles and buffers grow, and of timed frames."""

_SIZE = (640, 360)
"""Size of the picture [px]."""


class _MemoryRecorder(NullRecorder):
    """Recorder in memory: parameter blocks with their tables by sequence number, and the samples of each frame."""

    def __init__(self, memory: SessionMemory) -> None:
        super().__init__(memory)
        self.blocks: dict[int, NDArray[Any]] = {}
        self.rows: dict[int, Rows] = {}
        self.batches: list[NDArray[Any]] = []

    def wait_for_room(self, ticks: int) -> None:
        """Keep the samples of the previous frame."""
        self.batches.append(self.samples())

    def parameters(self, block: NDArray[Any], rows: Rows | None = None) -> None:
        """Keep copies."""
        number = int(block[0]["sequence"])
        self.blocks[number] = block.copy()
        if rows is not None:
            self.rows[number] = Rows(*(table.copy() for table in rows))


class WholePlay:
    """Beginning of a scene, played until the person has acted for some frames. A context: its end closes the device.

    Args:
        scene: A checked scene; its methods are replaced by those of the plan.
        plan: The methods that run.
        frames: Number of frames to play.

    Raises:
        SceneError: The scene cannot be played.
    """

    def __init__(self, scene: Scene, plan: Plan, frames: int) -> None:
        self._clock = MonotonicClock()
        self._scene = scene
        settings = RunSettings(scene.path, seed=_SEED, profile=plan.profile, size=_SIZE)
        self._core = open_core(prepare_scene(scene, settings, plan=plan), self._keep)
        self._frames = Frames(self._core)
        self._frames.play_to_start()
        for _ in range(frames):
            self._frames.advance_frame()
        self._samples = np.concatenate([*self._recorder.batches, self._recorder.samples()])
        statics = self._core.side.statics
        self._statics = ObjectStatics.from_arrays(statics.arrays, statics.fields)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._core.stop()

    def tick_us(self) -> float:
        """Return the cost of a tick [us], simulated robot and person included: the smallest mean of long calls."""
        means = []
        for _ in range(_CALLS):
            self._recorder.samples()
            started = self._clock.now_ns()
            self._core.haptics.advance(_TICKS)
            means.append((self._clock.now_ns() - started) * 1e-3 / _TICKS)
        return min(means)

    def draw(self, plan: Plan) -> tuple[float, U1]:
        """Return the cost of a frame with the methods of a plan [us], and its picture.

        The cost includes every stage of the main thread, to the last pixel. Session time does not advance meanwhile, so
        that every plan draws the same moment.

        Raises:
            DeviceError: No OpenGL context is available without a display.
        """
        quality = with_methods(picture_quality(self._scene, plan.profile), plan.settings)
        picture = Picture(open_offscreen("auto", _SIZE), self._scene, self._core.world, quality)
        spent = []
        for _ in range(_WARM_UP + _DRAWN):
            started = self._clock.now_ns()
            self._frames.step()
            views = picture.views
            picture.lay_out(self._frames.board, views)
            picture.renderer.draw_finished(views)
            spent.append((self._clock.now_ns() - started) * 1e-3)
        shown = read_pixels(picture.surface)
        picture.close()
        return median(spent[_WARM_UP:]), shown

    def force_apart(self, other: WholePlay) -> float:
        """Return the RMS difference of the force on the user [N] that the other play's methods make for this motion.

        The values that the methods set are those that differ between the two first parameter blocks and tables: they
        replace this play's own, and its ticks are simulated again.
        """
        ours, theirs = self._recorder, other._recorder
        first, changed = min(ours.blocks), min(theirs.blocks)
        blocks = {
            number: _laid_over(block, ours.blocks[first], theirs.blocks[changed])
            for number, block in ours.blocks.items()
        }
        rows = {number: self._rows_under(tables, theirs, first, changed) for number, tables in ours.rows.items()}
        again = replay_run(self._samples, blocks, rows, self._statics).samples
        apart = np.linalg.norm(again["f_user_world"] - self._samples["f_user_world"], axis=1)
        return float(np.sqrt(np.mean(apart**2)))

    def _rows_under(self, tables: Rows, theirs: _MemoryRecorder, first: int, changed: int) -> Rows:
        pairs = zip(tables, self._recorder.rows[first], theirs.rows[changed], strict=True)
        return Rows(*(_laid_over(*each) for each in pairs))

    def _keep(self, memory: SessionMemory) -> _MemoryRecorder:
        self._recorder = _MemoryRecorder(memory)
        return self._recorder


def _laid_over(records: NDArray[Any], first: NDArray[Any], changed: NDArray[Any]) -> NDArray[Any]:
    """Return the records with the value of `changed` in every field that differs between `first` and `changed`."""
    made = records.copy()
    for name in records.dtype.names or ():
        if records.dtype[name].names:
            made[name] = _laid_over(records[name], first[name], changed[name])
        elif len(records) == len(first) == len(changed) and not np.array_equal(first[name], changed[name]):
            made[name] = changed[name]
    return made
