"""Nodes of a drawn gait orthosis: marks on its belt, and the lamps of both legs."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.contracts.messages.stage_messages import HapticSnapshot
from mimics_app.world.components.orthosis_view import OrthosisView
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["OrthosisNodes"]

_FREE = (GaitState.LEG_RELEASED, GaitState.EXPLORING)
"""States in which the lamps of the free leg shine."""


class OrthosisNodes:
    """Marks and lamps of the scene's `orthosis_view`; without one nothing.

    Args:
        scene: The checked scene.
        world: The world built from it.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        self._view = scene.first(OrthosisView)
        view = self._view or OrthosisView()
        self._marks = [(node, np.array(node.position)) for node in map(world.find, view.marks)]
        self._lamps = [[world.find(name) for name in names] for names in (view.left_lamps, view.right_lamps)]
        self._lit = -1

    def follow(self, snapshot: HapticSnapshot) -> None:
        """Place the marks where the belt has brought them, and light the lamps of the leg that is free."""
        view = self._view
        if view is None:
            return
        behind, ahead = view.belt
        for node, place in self._marks:
            z = behind + (place[2] - behind - snapshot.belt_travel) % (ahead - behind)
            node.set_position((place[0], place[1], z))
        lit = snapshot.free_leg if snapshot.gait_state in _FREE else -1
        if lit != self._lit:
            self._lit = lit
            for leg, nodes in enumerate(self._lamps):
                material = view.lit if leg == lit else view.dark
                for node in nodes:
                    if node.entity is not None and material is not None:
                        node.entity.set_material(material)
