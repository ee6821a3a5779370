"""Component type of a hand that grasps objects: the entities of its fingers and their travel. SI units."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.world.components.bounds import PositiveForce
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component, component, register_check

__all__ = ["GraspingHand"]

Opening = Annotated[float, Meta(gt=0, le=1)]
"""Half opening of a hand [m]."""


@component("grasping_hand")
class GraspingHand(Component, frozen=True):
    """The visible hand; its entity is between the fingertips. Trials start at its position in the scene."""

    fingers: Annotated[
        tuple[str, str], Meta(description="Ids of the entities at its -x and +x side that open and close along its x")
    ]
    open: Annotated[
        Opening, Meta(description="Distance from the centre to the inner side of a finger, hand open [m]")
    ] = 0.045
    closed: Annotated[Opening, Meta(description="The same distance with the hand closed on nothing [m]")] = 0.006
    closing_force: Annotated[PositiveForce, Meta(description="Grasp force that closes it on nothing [N]")] = 2.0


def _check(hand: GraspingHand, pointer: str, scene: CheckedScene) -> list[Issue]:
    named = {f"{pointer}/fingers/{i}": finger for i, finger in enumerate(hand.fingers)}
    issues = scene.check_names(named, "no entity", scene.by_id)
    if hand.closed >= hand.open:
        issues.append(scene.issue(f"{pointer}/closed", f"{hand.closed:g} is not below open, {hand.open:g}", "lower it"))
    return issues


register_check("grasping_hand", _check)
