"""Component types of animated models: clips, the events that start them, and targets of head and limbs.

Units are SI, angles radians.
"""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.world.components.bounds import Name, Seconds, Share
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component, component, register_check

__all__ = [
    "Animation",
    "AnimationLayer",
    "AnimationState",
    "AnimationTransition",
    "Avatar",
    "MotionCause",
    "Reach",
]

MotionCause = Literal[
    "approach", "ready", "start", "goal", "timeout", "aborted", "rest", "done", "contact", "contact_end", "impact"
]
"""Events that start a transition: states of a trial, and contacts."""

Rate = Annotated[float, Meta(ge=-100, le=100)]
Names = Annotated[tuple[Name, ...], Meta(max_length=1000)]


class AnimationLayer(Component, frozen=True):
    """A clip blended over the layers below it."""

    clip: Annotated[Name, Meta(description="Name of a clip of the model")]
    weight: Annotated[Share, Meta(description="Blend weight, 0 to 1")] = 1.0
    speed: Annotated[Rate, Meta(description="Seconds of the clip per second; negative: backwards")] = 1.0
    loop: Annotated[bool, Meta(description="Repeats from its start; false: its last frame is held")] = True
    at: Annotated[Seconds, Meta(description="Time in the clip at which it starts [s]")] = 0.0
    mask: Annotated[Names, Meta(description="Nodes of the model it moves, with their subtrees; absent: all")] = ()
    additive: Annotated[bool, Meta(description="Its difference from its first frame is added to the layers below")] = (
        False
    )


class AnimationState(Component, frozen=True):
    """A state of the state machine: one clip."""

    clip: Annotated[Name, Meta(description="Name of a clip of the model")]
    speed: Annotated[Rate, Meta(description="Seconds of the clip per second")] = 1.0
    loop: Annotated[bool, Meta(description="Repeats from its start")] = True
    next: Annotated[Name | None, Meta(description="State that follows when a clip that does not loop has ended")] = None
    fade: Annotated[Seconds, Meta(description="Duration of the cross-fade to the next state [s]")] = 0.25


class AnimationTransition(Component, frozen=True, rename={"source": "from", "target": "to"}):
    """A transition between two states."""

    target: Annotated[Name, Meta(description="State that starts")]
    on: Annotated[MotionCause, Meta(description="Event: a trial's new state, or a contact")]
    source: Annotated[Name | None, Meta(description="State in which the event counts; absent: any")] = None
    fade: Annotated[Seconds, Meta(description="Duration of the cross-fade [s]")] = 0.25


@component("animation", limit=1000)
class Animation(Component, frozen=True):
    """Animation of the model of the same entity: layers of clips, and a state machine below them."""

    layers: Annotated[
        tuple[AnimationLayer, ...], Meta(max_length=32, description="Clips that play, lowest first; over the states")
    ] = ()
    states: Annotated[dict[str, AnimationState], Meta(max_length=100, description="States by name")] = msgspec.field(
        default_factory=dict
    )
    start: Annotated[Name | None, Meta(description="Initial state; absent: the first")] = None
    transitions: Annotated[
        tuple[AnimationTransition, ...], Meta(max_length=200, description="Transitions between states")
    ] = ()
    root_motion: Annotated[
        Name | None,
        Meta(description="Node whose path on the ground moves the entity itself; absent: clips play on the spot"),
    ] = None
    skinning: Annotated[
        Literal["linear", "dual"],
        Meta(description="linear: blended matrices, as in glTF; dual: dual quaternions, which keep twisted limbs full"),
    ] = "linear"


class Reach(Component, frozen=True):
    """Reach of a limb to an entity."""

    limb: Annotated[Literal["left_arm", "right_arm", "left_leg", "right_leg"], Meta(description="Limb of the skeleton")]
    target: Annotated[Name, Meta(description="Entity that is the target of its hand or foot")]
    ball: Annotated[
        bool,
        Meta(
            description="A leg reaches with the ball of its foot, at the ankle's present angle; false: with the ankle"
        ),
    ] = False
    weight: Annotated[Share, Meta(description="Blend weight over the clips, 0 to 1")] = 1.0
    soft: Annotated[
        float,
        Meta(
            ge=0,
            le=0.5,
            description="Soft reach: share of the limb's length before full extension in which it slows down",
        ),
    ] = 0.03


@component("avatar", limit=1000)
class Avatar(Component, frozen=True):
    """A person: the model of the same entity has a humanoid skeleton whose joint names can be mapped."""

    look_at: Annotated[Name | None, Meta(description='Entity the head turns to; "camera": the first camera')] = None
    look_limit: Annotated[float, Meta(ge=0, le=3.2, description="Largest angle of the head [rad]")] = 1.2
    reach: Annotated[tuple[Reach, ...], Meta(max_length=4, description="Limbs that reach for entities")] = ()
    joints: Annotated[
        bool, Meta(description="Hips and knees turn by the joints of the device, a gait orthosis that the person wears")
    ] = False
    blink: Annotated[bool, Meta(description="Blinks every few seconds, by the morph target of that name")] = True
    breathe: Annotated[bool, Meta(description="Breathes at a quarter of a hertz, by the morph target of that name")] = (
        True
    )


def _check_animation(animation: Animation, pointer: str, scene: CheckedScene) -> list[Issue]:
    model = scene.model_of(pointer)
    if model is None:
        return [
            scene.issue(pointer, "the entity shows no model whose clips could play", 'give it a "mesh" with a "source"')
        ]
    clips = [clip.name for clip in model.clips]
    nodes = [node.name for node in model.nodes if node.name]
    named = {f"{pointer}/layers/{i}/clip": layer.clip for i, layer in enumerate(animation.layers)}
    named |= {f"{pointer}/states/{name}/clip": state.clip for name, state in animation.states.items()}
    masks: dict[str, str | None] = {
        f"{pointer}/layers/{i}/mask/{k}": node
        for i, layer in enumerate(animation.layers)
        for k, node in enumerate(layer.mask)
    }
    masks[f"{pointer}/root_motion"] = animation.root_motion
    issues = scene.check_names(named, "the model has no clip", clips, "it has none")
    issues += scene.check_names(masks, "the model has no node", nodes, "")
    return issues + _check_states(animation, pointer, scene)


def _check_states(animation: Animation, pointer: str, scene: CheckedScene) -> list[Issue]:
    named = {f"{pointer}/start": animation.start}
    named |= {f"{pointer}/states/{name}/next": state.next for name, state in animation.states.items()}
    for i, transition in enumerate(animation.transitions):
        named[f"{pointer}/transitions/{i}/to"] = transition.target
        named[f"{pointer}/transitions/{i}/from"] = transition.source
    return scene.check_names(named, "there is no state", animation.states, "give `states`")


def _check_avatar(avatar: Avatar, pointer: str, scene: CheckedScene) -> list[Issue]:
    issues: list[Issue] = []
    if scene.model_of(pointer) is None:
        issues.append(scene.issue(pointer, "the entity shows no model", 'give it a "mesh" with a "source"'))
    if avatar.look_at != "camera":
        issues += scene.check_entity(f"{pointer}/look_at", avatar.look_at)
    for i, reach in enumerate(avatar.reach):
        issues += scene.check_entity(f"{pointer}/reach/{i}/target", reach.target)
        if reach.ball and reach.limb.endswith("arm"):
            issues.append(scene.issue(f"{pointer}/reach/{i}/ball", "an arm has no foot", "leave it out, or name a leg"))
        if avatar.joints and reach.limb.endswith("leg"):
            what = f"the {reach.limb.replace('_', ' ')} turns by the joints of the device"
            issues.append(scene.issue(f"{pointer}/reach/{i}/limb", what, 'remove this reach, or "joints"'))
    return issues


register_check("animation", _check_animation)
register_check("avatar", _check_avatar)
