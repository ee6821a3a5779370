"""Boxes as draw items without a driver, for probes and tests of culling."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.drawing.draw_items import DrawItems

__all__ = ["box_items"]


def box_items(rows: NDArray[np.int32], half: NDArray[np.float64]) -> DrawItems:
    """Return solid boxes around the origins of their nodes, all of one mesh and one state.

    Args:
        rows: Row of the transform of each box's node, [n].
        half: Half sizes [m], [n, 3].
    """
    count = len(rows)
    zeros, yes = np.zeros(count, np.int32), np.ones(count, np.bool_)
    return DrawItems(
        rows=rows,
        entities=rows,
        states=zeros,
        small_states=zeros - 1,
        shadow_states=zeros,
        meshes=zeros,
        instance_params=np.ones((count, 4), np.float32),
        local=np.concatenate([np.zeros((count, 3)), np.linalg.norm(half, axis=1)[:, None]], axis=1),
        half=half,
        drawable=np.ones(count, np.uint8),
        transparent=~yes,
        solid=yes,
        one_sided=np.ones(count, np.uint8),
        casting=yes,
        levels=np.zeros(count, np.uint8),
        families=zeros - 1,
        mesh_names=["box"],
        ranges=np.array([[36, 0, 0]], np.int32),
        listed=np.zeros((1, 2), np.int32),
        bodies={},
        of_state=[],
        of_shadow=[],
    )
