"""A session without processes, as tests play it: the parts of the product, with a scene's components changed."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np

from mimics_app.app.session.core import SessionCore, open_core
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.preparation import prepare_scene
from mimics_app.app.session.switched_off import NullRecorder
from mimics_app.app.settings import RunSettings
from mimics_app.world.files.scene.scene import Scene

__all__ = ["CorePlay", "KeepingRecorder", "change_component"]


def change_component(scene: Scene, component: str, **values: Any) -> None:
    """Give fields of the first component of a type other values, as if its file had said so.

    What was derived from the scene is derived anew where its source has changed; call it before a session is prepared.
    """
    for entity in scene.entities:
        if component in entity.components:
            entity.components[component] = msgspec.structs.replace(entity.components[component], **values)
            scene.take_over(scene)
            scene._derived.clear()
            return
    raise KeyError(component)


class KeepingRecorder(NullRecorder):
    """Keeps every parameter block and the tables beside it, by sequence number."""

    def __init__(self, memory: Any) -> None:
        super().__init__(memory)
        self.blocks: dict[int, Any] = {}
        self.rows: dict[int, Any] = {}

    def parameters(self, block: Any, rows: Any = None) -> None:
        sequence = int(block[0]["sequence"])
        self.blocks[sequence] = block.copy()
        if rows is not None:
            self.rows[sequence] = type(rows)(*(table.copy() for table in rows))


class CorePlay:
    """One session, frame by frame, every sample kept.

    Attributes:
        core: As the product assembles it.
        recorder: What stands in the recorder's place.
        frames: As the product steps them.
    """

    def __init__(self, core: SessionCore, *, frames: Frames | None = None) -> None:
        self.core = core
        self.recorder: Any = core.recorder
        self.frames = frames or Frames(core)
        self._kept: list[Any] = []

    @classmethod
    def of(cls, scene: Scene, seed: int, **settings: Any) -> CorePlay:
        """A scene as `mimics run --seed` has it, and with more of its options."""
        return cls(open_core(prepare_scene(scene, RunSettings(scene.path, seed=seed, **settings)), KeepingRecorder))

    def step(self) -> None:
        """Play one frame."""
        self.frames.advance_frame()
        self._kept.append(self.recorder.samples())

    @property
    def samples(self) -> Any:
        """SAMPLE rows of every tick so far."""
        return np.concatenate(self._kept)
