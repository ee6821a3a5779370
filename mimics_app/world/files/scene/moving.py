"""Set-up of the animation of models from components: clips, state machines, look-at and reach."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import SceneError
from mimics_app.maths.mat import affine_inverse
from mimics_app.world.components.animation import Animation, Avatar, Reach
from mimics_app.world.components.encourager import Encourager
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene, SceneEntity
from mimics_app.world.graph.scene_node import SceneNode

if TYPE_CHECKING:
    from mimics_app.world.content.motion.animator import Animator
    from mimics_app.world.content.motion.humanoid import HumanoidMap

__all__ = ["set_moving"]


_COMPONENTS = (Animation, Avatar, Encourager)


def set_moving(world: World, scene: Scene, entity: SceneEntity) -> None:
    """Animate the model of an entity as its components state, from the start.

    Raises:
        SceneError: the components require a humanoid skeleton that the model lacks.
    """
    node = world.find(entity.id)
    animator = world.motion.animators.get(node.index)
    if animator is None:
        return
    components = [each for each in entity.components.values() if isinstance(each, _COMPONENTS)]
    scene.read.update(name for name, each in entity.components.items() if isinstance(each, _COMPONENTS))
    animator.reset()
    world.motion.machines.pop(node.index, None)
    hidden = any(isinstance(each, Encourager) and not each.shown for each in components)
    animator.moves, node.visible = not hidden, node.visible and not hidden
    if hidden:
        return
    for component in components:
        if isinstance(component, Animation):
            _animate(world, node, animator, component)
        elif isinstance(component, Encourager):
            _encourage(world, node, animator, component)
    for component in components:
        if isinstance(component, Avatar):
            _enliven(world, scene, entity, animator, component)


def _animate(world: World, node: SceneNode, animator: Animator, wanted: Animation) -> None:
    from mimics_app.world.content.motion.animator import RootMotion, mask_of
    from mimics_app.world.content.motion.state_machine import StateMachine

    if wanted.states:
        machine = StateMachine(animator, wanted.states, wanted.transitions, wanted.start or "")
        world.motion.machines[node.index] = machine
    for layer in wanted.layers:
        animator.play(
            layer.clip,
            at=layer.at,
            speed=layer.speed,
            loop=layer.loop,
            weight=layer.weight,
            mask=mask_of(animator.rig, layer.mask) if layer.mask else None,
            additive=layer.additive,
        )
    for body in world.motion.bodies.values():
        if world.graph.hierarchy.is_inside(body.entity, node.index):
            body.skinning = wanted.skinning
    if wanted.root_motion is not None:
        slot = animator.rig.slot(wanted.root_motion)
        animator.steps.append(RootMotion(animator, slot, world.transforms, node.index))


def _encourage(world: World, node: SceneNode, animator: Animator, wanted: Encourager) -> None:
    from mimics_app.world.content.motion.encouraging import EncouragingMachine

    clips = {"greet": wanted.greet, "cheer": wanted.cheer, "console": wanted.console, "farewell": wanted.farewell}
    world.motion.machines[node.index] = EncouragingMachine(animator, idle=wanted.idle, praise=wanted.praise, **clips)


def _enliven(world: World, scene: Scene, entity: SceneEntity, animator: Animator, wanted: Avatar) -> None:
    from mimics_app.world.content.motion.humanoid import find_humanoid
    from mimics_app.world.content.motion.looking import Blink, Breath, LookAt, find_morphs
    from mimics_app.world.content.motion.speaking import Mouth
    from mimics_app.world.content.motion.worn_legs import WornLegs

    seed = zlib.crc32(entity.id.encode())
    rig = animator.rig
    for kind, wish, words in ((Blink, wanted.blink, ("blink",)), (Breath, wanted.breathe, ("breathe", "breath"))):
        slots = find_morphs(rig, *words) if wish else []
        if slots:
            animator.steps.append(kind(slots, seed))
    jaw = find_morphs(rig, "jaw", "jawOpen", "mouth_open", "aa")
    if jaw:
        world.motion.mouths[entity.id] = Mouth(jaw)
        animator.steps.append(world.motion.mouths[entity.id])
    if wanted.look_at is None and not wanted.reach and not wanted.joints:
        return
    bones = find_humanoid(rig)
    node = world.find(entity.id)
    if bones.missing:
        what = f"the model has no humanoid skeleton: {', '.join(bones.missing)} missing"
        raise SceneError(scene.issue(f"{entity.pointer}/components/avatar", what, "see mimics avatar import"))
    if wanted.joints:
        animator.steps.append(WornLegs(rig, bones, lambda: world.motion.joints))
        animator.moves = True
    for number, reach in enumerate(wanted.reach):
        if reach.ball and f"{reach.limb.partition('_')[0]}Toes" not in bones.slots:
            what = f"the model has no toes on its {reach.limb.replace('_', ' ')}"
            raise SceneError(scene.issue(f"{entity.pointer}/components/avatar/reach/{number}/ball", what))
        animator.steps.append(_reaching(world, node, animator, bones, reach))
    if wanted.look_at is not None:
        place = _target_of(world, node, wanted.look_at)
        animator.steps.append(LookAt(rig, bones, place, wanted.look_limit))


def _reaching(
    world: World, node: SceneNode, animator: Animator, bones: HumanoidMap, wanted: Reach
) -> Callable[..., None]:
    from mimics_app.world.content.motion.reach import LimbReach

    side = 1.0 if wanted.limb.startswith("left") else -1.0
    # Pole vectors of a natural posture: elbows back, down and outwards, knees forwards.
    pole = np.array([0.45 * side, -0.8, -0.5] if wanted.limb.endswith("arm") else [0.1 * side, 0.0, 1.0])
    upper, lower, end = bones.limb(wanted.limb)
    if wanted.ball:
        end = bones.slots[f"{wanted.limb.partition('_')[0]}Toes"]
    return LimbReach(
        animator.rig,
        (upper, lower, end),
        _target_of(world, node, wanted.target),
        lambda shoulder: np.asarray(shoulder + pole),
        weight=wanted.weight,
        soft=wanted.soft,
    )


def _target_of(world: World, node: SceneNode, target: str) -> Callable[[], F8 | None]:
    """Return a function of the present position of an entity, or of the first camera, in the frame of a model."""
    model_from_world = np.empty((4, 4))

    def place() -> F8 | None:
        aim = world.eye() if target == "camera" else world.find(target) if target in world else None
        if aim is None:
            return None
        if affine_inverse(node.world_matrix(), model_from_world) == 0.0:
            return None  # the model is flat: nothing is inside
        return np.asarray(model_from_world[:3] @ aim.world_matrix()[:, 3])

    return place
