"""Component type of a hand that grasps objects: the entities of its fingers and their travel. SI units."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.world.components.bounds import Name, PositiveForce
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component, component, register_check
from mimics_app.world.components.visible import MeshComponent

__all__ = ["GraspingHand"]

Opening = Annotated[float, Meta(gt=0, le=1)]
"""Half opening of a hand [m]."""

_ARMS = "take mimics:assets/models/hands/woman_mara_right.glb"


@component("grasping_hand")
class GraspingHand(Component, frozen=True):
    """The visible hand; its entity is between the fingertips. Trials start at its position in the scene."""

    fingers: Annotated[
        tuple[str, ...],
        Meta(
            max_length=2,
            description="Ids of the entities at its -x and +x side that open and close along its x; absent: an arm",
        ),
    ] = ()
    arm: Annotated[
        Name | None,
        Meta(description='Entity of an arm whose clip "grip" opens the hand, from `closed` at its start to `open`'),
    ] = None
    open: Annotated[
        Opening, Meta(description="Distance from the centre to the inner side of a finger, hand open [m]")
    ] = 0.045
    closed: Annotated[Opening, Meta(description="The same distance with the hand closed on nothing [m]")] = 0.006
    closing_force: Annotated[PositiveForce, Meta(description="Grasp force that closes it on nothing [N]")] = 2.0


def _check(hand: GraspingHand, pointer: str, scene: CheckedScene) -> list[Issue]:
    named = {f"{pointer}/fingers/{i}": finger for i, finger in enumerate(hand.fingers)}
    issues = scene.check_names(named, "no entity", scene.by_id)
    if hand.arm is not None:
        issues += _check_arm(hand.arm, pointer, scene)
    if len(hand.fingers) != (2 if hand.arm is None else 0):
        issues.append(scene.issue(pointer, "a hand has either two `fingers` or an `arm`", "give one of them"))
    if hand.closed >= hand.open:
        issues.append(scene.issue(f"{pointer}/closed", f"{hand.closed:g} is not below open, {hand.open:g}", "lower it"))
    return issues


def _check_arm(arm: str, pointer: str, scene: CheckedScene) -> list[Issue]:
    issues = scene.check_entity(f"{pointer}/arm", arm)
    if issues:
        return issues
    shown = next((place for name, _, place in scene.components(MeshComponent) if name == arm), None)
    model = None if shown is None else scene.model_of(shown)
    clips = [clip.name for clip in model.clips] if model is not None else []
    return [] if "grip" in clips else [scene.issue(f"{pointer}/arm", f'the model of "{arm}" has no clip "grip"', _ARMS)]


register_check("grasping_hand", _check)
