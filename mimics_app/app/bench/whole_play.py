"""A scene played under a given plan, each tick and each drawn frame of it timed as a whole."""

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
from mimics_app.contracts.clock import FRAMES_PER_SECOND, MonotonicClock
from mimics_app.contracts.object_rows import Rows
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.rendering.haptic.object_statics import ObjectStatics
from mimics_app.rendering.haptic.replay import replay_run
from mimics_app.rendering.visual.surfaces.headless import open_offscreen, read_pixels
from mimics_app.world.scene.scene import Scene

__all__ = ["WholePlay"]

_SEED = 1
_LONGEST_START = 20 * FRAMES_PER_SECOND
"""Frames; a robot that is not at its start by then never will be."""

_TICKS, _CALLS = 1000, 5
"""Ticks of a call that is timed, and how many calls."""

_WARM_UP, _DRAWN = 2, 5
"""Frames drawn first, in which the driver compiles and buffers grow, and frames that are timed."""

_SIZE = (640, 360)
"""Of what is drawn [px]."""


class _Keeper(NullRecorder):
    """Keeps every parameter block and the tables beside it, by sequence number."""

    def __init__(self, memory: SessionMemory) -> None:
        super().__init__(memory)
        self.blocks: dict[int, NDArray[Any]] = {}
        self.rows: dict[int, Rows] = {}

    def parameters(self, block: NDArray[Any], rows: Rows | None = None) -> None:
        """Keep copies."""
        number = int(block[0]["sequence"])
        self.blocks[number] = block.copy()
        if rows is not None:
            self.rows[number] = Rows(*(table.copy() for table in rows))


class WholePlay:
    """The first moments of a scene, from where the person acts. A context: leaving it closes the device.

    Args:
        scene: A checked scene of its own: its methods are set.
        plan: What runs.
        frames: To play.

    Raises:
        SceneError: the scene cannot be played.
    """

    def __init__(self, scene: Scene, plan: Plan, frames: int) -> None:
        self._clock = MonotonicClock()
        self._scene = scene
        settings = RunSettings(scene.path, seed=_SEED, profile=plan.profile, size=_SIZE)
        self._core = open_core(prepare_scene(scene, settings, plan=plan), self._keep)
        self._frames = Frames(self._core)
        self._samples = np.concatenate([*self._to_start(), *(self._one_frame() for _ in range(frames))])
        statics = self._core.side.statics
        self._statics = ObjectStatics.from_arrays(statics.arrays, statics.fields)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._core.stop()

    def tick_us(self) -> float:
        """Cost of a tick [us], simulated robot and person included: the least mean of a few long calls.

        What handing a call over costs is no part of a tick.
        """
        means = []
        for _ in range(_CALLS):
            self._keeper.wait_for_room(_TICKS)
            started = self._clock.now_ns()
            self._core.haptics.advance(_TICKS)
            means.append((self._clock.now_ns() - started) * 1e-3 / _TICKS)
        return min(means)

    def draw(self, plan: Plan) -> tuple[float, NDArray[np.uint8]]:
        """Cost of a frame under a plan [us], and the picture.

        The cost is of every stage of the main thread, to the last pixel.

        Time is frozen meanwhile, so every plan draws the same moment.

        Raises:
            DeviceError: nothing here draws without a display.
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
        """Root mean square difference of the force on the user [N] if this hand had moved under the other's methods.

        What the methods set differs in the two first parameter blocks and tables: those values are put into all of
        this play's, and its ticks are simulated again.
        """
        ours, theirs = self._keeper, other._keeper
        first, changed = min(ours.blocks), min(theirs.blocks)
        blocks = {
            number: _laid_over(block, ours.blocks[first], theirs.blocks[changed])
            for number, block in ours.blocks.items()
        }
        rows = {number: self._rows_under(tables, theirs, first, changed) for number, tables in ours.rows.items()}
        again = replay_run(self._samples, blocks, rows, self._statics).samples
        apart = np.linalg.norm(again["f_user_world"] - self._samples["f_user_world"], axis=1)
        return float(np.sqrt(np.mean(apart**2)))

    def _rows_under(self, tables: Rows, theirs: _Keeper, first: int, changed: int) -> Rows:
        pairs = zip(tables, self._keeper.rows[first], theirs.rows[changed], strict=True)
        return Rows(*(_laid_over(*each) for each in pairs))

    def _keep(self, memory: SessionMemory) -> _Keeper:
        self._keeper = _Keeper(memory)
        return self._keeper

    def _to_start(self) -> list[NDArray[Any]]:
        """Play until the person acts; the samples of each frame."""
        kept = []
        while not self._frames.orders.person_may_act and self._frames.number < _LONGEST_START:
            kept.append(self._one_frame())
        return kept

    def _one_frame(self) -> NDArray[Any]:
        self._frames.play_on()
        return self._keeper.samples()


def _laid_over(records: NDArray[Any], first: NDArray[Any], changed: NDArray[Any]) -> NDArray[Any]:
    """Records in which every field that differs between `first` and `changed` has the latter's value."""
    made = records.copy()
    for name in records.dtype.names or ():
        if records.dtype[name].names:
            made[name] = _laid_over(records[name], first[name], changed[name])
        elif len(records) == len(first) == len(changed) and not np.array_equal(first[name], changed[name]):
            made[name] = changed[name]
    return made
