"""Component types of visual effects: billboards, particles, textures projected onto surfaces.

Units are SI, colours linear RGB, angles radians.
"""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.world.components.bounds import (
    Extent,
    Factor,
    FarCoordinate,
    Frequency,
    Length,
    Light,
    Seconds,
    Share,
    Vector,
)
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component, component, register_check

__all__ = ["Billboard", "Particles", "Projector", "SpriteShape", "Trigger"]

SpriteShape = Literal["dot", "puff", "paper", "spark", "ring"]
"""Built-in sprite textures, see `sprite_pictures`."""

Trigger = Literal["always", "start", "goal", "scored", "gust", "contact", "contact_end", "impact"]
"""Events that start a burst of an emitter; "always": it emits continuously; "scored", "gust": a scenario's own."""

Rgba = tuple[Light, Light, Light, Share]
Lifetime = Annotated[float, Meta(gt=0, le=86_400)]

_WHITE = (1.0, 1.0, 1.0, 1.0)
_MAX_CAPTION_ASPECT = 20
"""Largest width over height of a caption."""


@component("billboard")
class Billboard(Component, frozen=True):
    """A texture, or a caption, that faces each eye; it never rolls with the head."""

    texture: Annotated[str | None, Meta(description="Image file of the scene's `assets`; absent: `shape`")] = None
    text: Annotated[
        str, Meta(max_length=60, description="A line of text on a plate instead of a texture, as large as it fits")
    ] = ""
    shape: Annotated[SpriteShape, Meta(description="Built-in texture")] = "puff"
    size: Annotated[tuple[Length, Length], Meta(description="Width and height [m]")] = (1.0, 1.0)
    facing: Annotated[
        Literal["free", "upright"],
        Meta(description="free: faces the eye about all axes; upright: about the vertical only, as for trees"),
    ] = "free"
    pivot: Annotated[
        Literal["centre", "bottom"], Meta(description="Point of the rectangle that is at the entity's position")
    ] = "centre"
    colour: Annotated[Rgba, Meta(description="Linear RGBA, multiplied with the texture")] = _WHITE
    blend: Annotated[
        Literal["alpha", "add", "mask"],
        Meta(description="alpha: sorted with all that is translucent; add: light; mask: cut out at `cutoff`"),
    ] = "alpha"
    cutoff: Annotated[Share, Meta(description="Opacity below which a mask draws nothing")] = 0.5
    lit: Annotated[bool, Meta(description="Lit by sun, lights and sky, shaded like a ball; false: unlit")] = False


@component("particles", limit=1000)
class Particles(Component, frozen=True):
    """An emitter. The position of a particle is a function of its number and age, independent of the frame rate."""

    texture: Annotated[str | None, Meta(description="Image file of the scene's `assets`; absent: `shape`")] = None
    shape: Annotated[SpriteShape, Meta(description="Built-in texture; paper tumbles in space")] = "dot"
    trigger: Annotated[
        Trigger,
        Meta(description="always: `rate`, in the emitter's frame; else `count` at a start, goal, score or touch"),
    ] = "always"
    rate: Annotated[float, Meta(ge=0, le=100_000, description="Particles per second (always)")] = 20.0
    count: Annotated[int, Meta(ge=0, le=10_000, description="Particles of one burst")] = 100
    spread: Annotated[Seconds, Meta(description="Duration of the emission of a burst [s]")] = 0.0
    pause: Annotated[Seconds, Meta(description="Minimum time between two bursts [s]")] = 0.1
    lifetime: Annotated[tuple[Lifetime, Lifetime], Meta(description="Minimum and maximum lifetime [s]")] = (1.0, 2.0)
    box: Annotated[
        tuple[Extent, Extent, Extent],
        Meta(description="Edges of the box about the entity in which particles are born [m]"),
    ] = (0.0, 0.0, 0.0)
    direction: Annotated[Vector, Meta(description="Mean direction in the entity's frame, of any length")] = (
        0.0,
        1.0,
        0.0,
    )
    cone: Annotated[float, Meta(ge=0, le=3.1416, description="Half angle about the direction [rad]")] = 0.4
    speed: Annotated[tuple[Factor, Factor], Meta(description="Minimum and maximum initial speed [m/s]")] = (0.5, 1.0)
    gravity: Annotated[Vector, Meta(description="Acceleration, world [m/s^2]")] = (0.0, 0.0, 0.0)
    drag: Annotated[Factor, Meta(description="Share of the speed through the air lost per second [1/s]")] = 0.0
    wind: Annotated[Vector, Meta(description="Velocity of the air, world [m/s]; acts by `drag`")] = (0.0, 0.0, 0.0)
    sway: Annotated[Extent, Meta(description="Amplitude of the sideways sway [m]")] = 0.0
    sway_hz: Annotated[Frequency, Meta(description="Frequency of the sway [Hz]")] = 0.5
    spin: Annotated[Factor, Meta(description="Maximum angular rate [rad/s]")] = 0.0
    upright: Annotated[bool, Meta(description="Born upright in the picture, as drops are; false: at any angle")] = False
    floor: Annotated[FarCoordinate | None, Meta(description="Height at which they come to rest, world [m]")] = None
    size: Annotated[tuple[Length, Length], Meta(description="Minimum and maximum size at birth [m]")] = (
        0.02,
        0.02,
    )
    aspect: Annotated[Length, Meta(description="Width over height")] = 1.0
    growth: Annotated[Factor, Meta(description="Factor on the size at the end of the lifetime")] = 1.0
    colours: Annotated[
        tuple[Rgba, ...],
        Meta(
            min_length=1,
            max_length=8,
            description="Linear RGBA over the lifetime, evenly spaced; alpha fades in and out",
        ),
    ] = (_WHITE,)
    palette: Annotated[
        tuple[Rgba, ...], Meta(max_length=16, description="Colours, one for each particle, multiplied with `colours`")
    ] = ()
    blend: Annotated[
        Literal["alpha", "add", "mask"],
        Meta(description="alpha: sorted with all that is translucent; add: light; mask: cut out at `cutoff`"),
    ] = "alpha"
    cutoff: Annotated[Share, Meta(description="Opacity below which a mask draws nothing")] = 0.5
    lit: Annotated[bool, Meta(description="Lit by sun, lights and sky; false: unlit")] = False
    capacity: Annotated[
        int, Meta(ge=1, le=100_000, description="Maximum number at once; of more, the oldest are not drawn")
    ] = 10_000


@component("projector", limit=1000)
class Projector(Component, frozen=True):
    """A texture projected onto the surfaces in its volume along the entity's own -z, +y up."""

    texture: Annotated[str | None, Meta(description="Image file of the scene's `assets`; absent: `shape`")] = None
    shape: Annotated[SpriteShape, Meta(description="Built-in texture")] = "ring"
    kind: Annotated[
        Literal["decal", "slide"],
        Meta(description="decal: a box about the entity, size by depth; slide: a pyramid from it, of length depth"),
    ] = "decal"
    size: Annotated[
        tuple[Length, Length], Meta(description="Width and height [m]; of a slide only their ratio counts")
    ] = (1.0, 1.0)
    depth: Annotated[Length, Meta(description="Depth of the box, or reach of the slide [m]")] = 1.0
    fov: Annotated[float, Meta(gt=0, lt=3.1, description="Full vertical angle of a slide [rad]")] = 0.6
    near: Annotated[Length, Meta(description="Distance of a slide's near plane [m]")] = 0.05
    blend: Annotated[
        Literal["paint", "stain", "light"],
        Meta(description="paint: a matt colour on the surface; stain: darkens it; light: shines on it"),
    ] = "paint"
    colour: Annotated[Rgba, Meta(description="Linear RGBA, multiplied with the texture; alpha: its opacity")] = _WHITE
    full_angle: Annotated[
        float, Meta(ge=0, le=1.5708, description="Slope of a surface up to which it is opaque [rad]")
    ] = 1.0
    last_angle: Annotated[float, Meta(gt=0, le=1.5708, description="Slope from which it is transparent [rad]")] = 1.4
    onto: Annotated[
        tuple[str, ...], Meta(max_length=1000, description="Entities it falls on, with their subtrees; absent: all")
    ] = ()


def _check_billboard(billboard: Billboard, pointer: str, scene: CheckedScene) -> list[Issue]:
    issues = scene.check_asset(f"{pointer}/texture", billboard.texture, "picture")
    if billboard.text and billboard.texture is not None:
        issues.append(scene.issue(f"{pointer}/text", "has text and texture", "leave one of the two"))
    wide, high = billboard.size
    if billboard.text and wide > _MAX_CAPTION_ASPECT * high:
        what = f"a caption {wide:g} m wide and {high:g} m high cannot be drawn"
        issues.append(scene.issue(f"{pointer}/size", what, f"at most {_MAX_CAPTION_ASPECT} times as wide as high"))
    return issues


def _check_particles(particles: Particles, pointer: str, scene: CheckedScene) -> list[Issue]:
    issues = scene.check_asset(f"{pointer}/texture", particles.texture, "picture")
    for name in ("lifetime", "speed", "size"):
        least, greatest = getattr(particles, name)
        if least > greatest:
            issues.append(
                scene.issue(f"{pointer}/{name}", f"{least:g} is more than {greatest:g}", "give the minimum first")
            )
    if not any(particles.direction):
        issues.append(scene.issue(f"{pointer}/direction", "has no length", "give one, such as [0, 1, 0]"))
    return issues


def _check_projector(projector: Projector, pointer: str, scene: CheckedScene) -> list[Issue]:
    issues = scene.check_asset(f"{pointer}/texture", projector.texture, "picture")
    if projector.last_angle <= projector.full_angle:
        what = f"{projector.last_angle:g} rad is not beyond full_angle, {projector.full_angle:g} rad"
        issues.append(scene.issue(f"{pointer}/last_angle", what))
    if projector.kind == "slide" and projector.near >= projector.depth:
        what = f"{projector.near:g} m is not nearer than depth, {projector.depth:g} m"
        issues.append(scene.issue(f"{pointer}/near", what))
    for number, name in enumerate(projector.onto):
        issues += scene.check_entity(f"{pointer}/onto/{number}", name)
    return issues


register_check("billboard", _check_billboard)
register_check("particles", _check_particles)
register_check("projector", _check_projector)
