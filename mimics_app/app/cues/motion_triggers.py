"""What moving models did in a frame that may be heard: feet that touch the ground, by kind, material and strength."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.messages import SoundTrigger
from mimics_app.world.world import World

__all__ = ["motion_triggers"]


def motion_triggers(world: World, now_ns: int) -> Iterator[SoundTrigger]:
    """A trigger for each event that the clips of models passed in this frame, where it happened."""
    for index, event in world.motion.happened:
        x, y, z = _place_of(world, index, event.node)
        yield SoundTrigger(
            event.kind,
            now_ns,
            material=event.material,
            position_world=(float(x), float(y), float(z)),
            strength=event.strength,
        )


def _place_of(world: World, index: int, node: str) -> NDArray[np.float64]:
    """Where a node of a model is, or the model itself, world [m], shape [3]."""
    name = f"{world.graph.name(index)}/{node}"
    return world.graph.world_matrix(world.graph.find(name) if node and name in world else index)[:3, 3]
