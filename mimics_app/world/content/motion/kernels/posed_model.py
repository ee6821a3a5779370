"""Pose of one model inside compiled code: its arrays by slot, and one slot's pose from its parent's and back."""

from __future__ import annotations

from typing import NamedTuple

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4
from mimics_app.world.content.motion.kernels.chain import follow_one, localise

__all__ = ["PosedModel", "follow", "turn_to"]


class PosedModel(NamedTuple):
    """Arrays of one model by slot: passing it costs nothing inside compiled code, and 2 us into it.

    Attributes:
        parents: Slot each slot hangs on.
        between: 1 for a slot without a name of its own between two that have one, such as a twist bone or a vertebra.
        rest_r: Rotations at rest in the model's frame.
        local_t: Local translations of the pose [m].
        local_r: Its local rotations.
        local_s: Its local scales.
        t: Places in the model's frame [m].
        r: Rotations there.
        s: Scales there.
    """

    parents: I4
    between: I4
    rest_r: F8
    local_t: F8
    local_r: F8
    local_s: F8
    t: F8
    r: F8
    s: F8


@kernel
def follow(model: PosedModel, slot: int) -> None:
    """Compute the pose of a slot in the model's frame from that of the nearest slot above that has a name."""
    first, parents = slot, model.parents
    while parents[first] >= 0 and model.between[parents[first]]:
        first = parents[first]
    while True:
        follow_one(first, parents, model.local_t, model.local_r, model.local_s, model.t, model.r, model.s)
        if first == slot:
            return
        below = slot
        while parents[below] != first:
            below = parents[below]
        first = below


@kernel
def turn_to(model: PosedModel, slot: int, wanted: F8) -> None:
    """Set the rotation of a slot in the model's frame; its parent's pose is up to date."""
    localise(slot, wanted, model.parents, model.r, model.local_r)
