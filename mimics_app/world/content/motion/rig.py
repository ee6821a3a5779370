"""Nodes of a model as slots, which poses and clips address."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.contracts.errors import nearest
from mimics_app.world.content.motion.pose import Pose

__all__ = ["Rig"]


@dataclass(frozen=True, eq=False)
class Rig:
    """The nodes of a model as slots, parents before children.

    Attributes:
        names: Names of the nodes in the file, "" for none.
        entities: Entity index of each node, int32 [slots].
        parents: Slot of each parent, -1: the model's root; int32 [slots].
        rest: Rest pose, that of the file.
        morph_first: First morph weight of each slot, int32 [slots + 1].
        morph_names: Names of all morph weights, "" for none.
        fixed: Number of leading slots that the scene places, so that poses do not move them.
        bones: Slots of the bones of a person that the file names itself (VRM), by VRM 1.0 name.
    """

    names: tuple[str, ...]
    entities: I4
    parents: I4
    rest: Pose
    morph_first: I4
    morph_names: tuple[str, ...]
    fixed: int = 0
    bones: Mapping[str, int] = field(default_factory=dict)

    def slot(self, name: str) -> int:
        """Return the slot of a node.

        Raises:
            KeyError: there is none of that name; the message names the nearest.
        """
        if name not in self.names:
            raise KeyError(f'no node "{name}" in the model; {nearest(name, self.names)}')
        return self.names.index(name)

    def below(self, slot: int) -> list[int]:
        """Return a slot and all its descendants."""
        inside = {slot}
        for each in range(slot + 1, len(self.names)):
            if int(self.parents[each]) in inside:
                inside.add(each)
        return sorted(inside)

    def rest_places(self) -> F8:
        """Return where the slots are at rest [m], [slots, 3]; no compiled code, which reading a file must not need."""
        rest, count = self.rest, len(self.names)
        u, w, basis = rest.rotations[:, None, :3], rest.rotations[:, None, 3:], np.tile(np.eye(3), (count, 1, 1))
        turned = basis + 2.0 * np.cross(u, np.cross(u, basis) + w * basis)
        axes = np.ascontiguousarray(np.swapaxes(turned, 1, 2)) * rest.scales[:, None, :]
        places = rest.translations.copy()
        for slot, parent in enumerate(self.parents.tolist()):
            if parent >= 0:
                axes[slot] = axes[parent] @ axes[slot]
                places[slot] = places[parent] + axes[parent] @ rest.translations[slot]
        return places
