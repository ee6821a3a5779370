"""Component types of what is seen but is no body: billboards, particles, pictures projected onto surfaces.

Units are SI, colours linear RGB, angles radians.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.world.components.bounds import Extent, Factor, FarCoordinate, Frequency, Length, Light, Seconds, Vector
from mimics_app.world.components.registry import Component, component, register_check, register_limit

if TYPE_CHECKING:
    from mimics_app.world.scene.scene import Scene

__all__ = ["Billboard", "Particles", "Projector", "SpriteShape", "Trigger"]

SpriteShape = Literal["dot", "puff", "paper", "spark", "ring"]
"""Pictures made by the application, see `sprite_pictures`."""

Trigger = Literal["always", "start", "goal", "contact", "contact_end", "impact"]
"""What makes an emitter give off particles."""

Share = Annotated[float, Meta(ge=0, le=1)]
Rgba = tuple[Light, Light, Light, Share]
Lifetime = Annotated[float, Meta(gt=0, le=86_400)]

_WHITE = (1.0, 1.0, 1.0, 1.0)
_WIDEST_CAPTION = 20
"""Width over height that the picture of a caption may have."""


@component("billboard")
class Billboard(Component, frozen=True):
    """A picture, or a caption, that turns to each eye on its own; never rolls with the head."""

    texture: Annotated[str | None, Meta(description="Of the scene's `assets`, a picture; absent: `shape`")] = None
    text: Annotated[
        str, Meta(max_length=60, description="A line of words on a plate instead of a picture, as large as it fits")
    ] = ""
    shape: Annotated[SpriteShape, Meta(description="Picture made by the application")] = "puff"
    size: Annotated[tuple[Length, Length], Meta(description="Width and height [m]")] = (1.0, 1.0)
    facing: Annotated[
        Literal["free", "upright"],
        Meta(description="free: turned wholly to the eye; upright: about the vertical only, as trees are"),
    ] = "free"
    pivot: Annotated[
        Literal["centre", "bottom"], Meta(description="What of the picture stands where the entity is")
    ] = "centre"
    colour: Annotated[Rgba, Meta(description="Linear RGBA, multiplied with the picture")] = _WHITE
    blend: Annotated[
        Literal["alpha", "add", "mask"],
        Meta(description="alpha: sorted with all that is translucent; add: light; mask: cut out at `cutoff`"),
    ] = "alpha"
    cutoff: Annotated[Share, Meta(description="Opacity below which a mask draws nothing")] = 0.5
    lit: Annotated[bool, Meta(description="By sun, lights and sky, rounded like a ball; false: its own colour")] = False


@component("particles")
class Particles(Component, frozen=True):
    """An emitter. Where a particle is follows from its number and its age alone, however fast frames follow."""

    texture: Annotated[str | None, Meta(description="Of the scene's `assets`, a picture; absent: `shape`")] = None
    shape: Annotated[SpriteShape, Meta(description="Picture made by the application; paper tumbles in space")] = "dot"
    trigger: Annotated[
        Trigger,
        Meta(description="always: `rate`, in the emitter's frame; else `count` at a trial's start, goal, a touch"),
    ] = "always"
    rate: Annotated[float, Meta(ge=0, le=100_000, description="Particles per second (always)")] = 20.0
    count: Annotated[int, Meta(ge=0, le=10_000, description="Particles of one burst")] = 100
    spread: Annotated[Seconds, Meta(description="Time over which a burst is given off [s]")] = 0.0
    pause: Annotated[Seconds, Meta(description="Least time between two bursts [s]")] = 0.1
    lifetime: Annotated[tuple[Lifetime, Lifetime], Meta(description="Least and greatest [s]")] = (1.0, 2.0)
    box: Annotated[
        tuple[Extent, Extent, Extent],
        Meta(description="Sizes of the box about the entity in which they begin [m]"),
    ] = (0.0, 0.0, 0.0)
    direction: Annotated[Vector, Meta(description="In the entity's frame, of any length")] = (0.0, 1.0, 0.0)
    cone: Annotated[float, Meta(ge=0, le=3.1416, description="Half angle about the direction [rad]")] = 0.4
    speed: Annotated[tuple[Factor, Factor], Meta(description="Least and greatest at the beginning [m/s]")] = (0.5, 1.0)
    gravity: Annotated[Vector, Meta(description="In the world [m/s^2]")] = (0.0, 0.0, 0.0)
    drag: Annotated[Factor, Meta(description="Share of the speed through the air lost per second [1/s]")] = 0.0
    wind: Annotated[Vector, Meta(description="Of the air in the world [m/s]; felt through `drag`")] = (0.0, 0.0, 0.0)
    sway: Annotated[Extent, Meta(description="Swing to and fro, sideways [m]")] = 0.0
    sway_hz: Annotated[Frequency, Meta(description="How often it swings [Hz]")] = 0.5
    spin: Annotated[Factor, Meta(description="Greatest rate of turning [rad/s]")] = 0.0
    floor: Annotated[FarCoordinate | None, Meta(description="Height at which they come to rest, world [m]")] = None
    size: Annotated[tuple[Length, Length], Meta(description="Of the smallest and the largest, at birth [m]")] = (
        0.02,
        0.02,
    )
    aspect: Annotated[Length, Meta(description="Width over height")] = 1.0
    growth: Annotated[Factor, Meta(description="Factor on the size at the end of life")] = 1.0
    colours: Annotated[
        tuple[Rgba, ...],
        Meta(min_length=1, max_length=8, description="Linear RGBA over life, evenly spread; alpha fades in and out"),
    ] = (_WHITE,)
    palette: Annotated[
        tuple[Rgba, ...], Meta(max_length=16, description="Colours of which each has one, multiplied with `colours`")
    ] = ()
    blend: Annotated[
        Literal["alpha", "add", "mask"],
        Meta(description="alpha: sorted with all that is translucent; add: light; mask: cut out at `cutoff`"),
    ] = "alpha"
    cutoff: Annotated[Share, Meta(description="Opacity below which a mask draws nothing")] = 0.5
    lit: Annotated[bool, Meta(description="By sun, lights and sky; false: its own colour")] = False
    capacity: Annotated[
        int, Meta(ge=1, le=100_000, description="Most of them at once; of more, the oldest are not drawn")
    ] = 10_000


@component("projector")
class Projector(Component, frozen=True):
    """A picture projected onto the surfaces in its volume along the entity's own -z, +y up."""

    texture: Annotated[str | None, Meta(description="Of the scene's `assets`, a picture; absent: `shape`")] = None
    shape: Annotated[SpriteShape, Meta(description="Picture made by the application")] = "ring"
    kind: Annotated[
        Literal["decal", "slide"],
        Meta(description="decal: a box about the entity, size by depth; slide: a pyramid from it, depth long"),
    ] = "decal"
    size: Annotated[
        tuple[Length, Length], Meta(description="Width and height [m]; of a slide only their ratio counts")
    ] = (1.0, 1.0)
    depth: Annotated[Length, Meta(description="Depth of the box, or reach of the slide [m]")] = 1.0
    fov: Annotated[float, Meta(gt=0, lt=3.1, description="Full angle of a slide, bottom to top [rad]")] = 0.6
    near: Annotated[Length, Meta(description="Where a slide begins [m]")] = 0.05
    blend: Annotated[
        Literal["paint", "stain", "light"],
        Meta(description="paint: a matt colour on the surface; stain: darkens it; light: shines on it"),
    ] = "paint"
    colour: Annotated[Rgba, Meta(description="Linear RGBA, multiplied with the picture; alpha: how much of it")] = (
        _WHITE
    )
    full_angle: Annotated[float, Meta(ge=0, le=1.5708, description="Lean of a surface up to which all shows [rad]")] = (
        1.0
    )
    last_angle: Annotated[float, Meta(gt=0, le=1.5708, description="Lean from which nothing shows [rad]")] = 1.4
    onto: Annotated[
        tuple[str, ...], Meta(max_length=1000, description="Entities it falls on, with what hangs on them; absent: all")
    ] = ()


def _check_texture(texture: str | None, pointer: str, scene: Scene) -> list[Issue]:
    return [] if texture is None else scene.check_asset(f"{pointer}/texture", texture, "picture")


def _check_billboard(billboard: Billboard, pointer: str, scene: Scene) -> list[Issue]:
    issues = _check_texture(billboard.texture, pointer, scene)
    if billboard.text and billboard.texture is not None:
        issues.append(scene.issue(f"{pointer}/text", "has text and texture", "leave one of the two"))
    wide, high = billboard.size
    if billboard.text and wide > _WIDEST_CAPTION * high:
        what = f"a caption {wide:g} m wide and {high:g} m high cannot be drawn"
        issues.append(scene.issue(f"{pointer}/size", what, f"at most {_WIDEST_CAPTION} times as wide as high"))
    return issues


def _check_particles(particles: Particles, pointer: str, scene: Scene) -> list[Issue]:
    issues = _check_texture(particles.texture, pointer, scene)
    for name in ("lifetime", "speed", "size"):
        least, greatest = getattr(particles, name)
        if least > greatest:
            issues.append(scene.issue(f"{pointer}/{name}", f"{least:g} is more than {greatest:g}", "give least first"))
    if not any(particles.direction):
        issues.append(scene.issue(f"{pointer}/direction", "has no length", "give one, such as [0, 1, 0]"))
    return issues


def _check_projector(projector: Projector, pointer: str, scene: Scene) -> list[Issue]:
    issues = _check_texture(projector.texture, pointer, scene)
    if projector.last_angle <= projector.full_angle:
        what = f"{projector.last_angle:g} rad is not beyond full_angle, {projector.full_angle:g} rad"
        issues.append(scene.issue(f"{pointer}/last_angle", what))
    if projector.kind == "slide" and projector.near >= projector.depth:
        what = f"{projector.near:g} m is not nearer than depth, {projector.depth:g} m"
        issues.append(scene.issue(f"{pointer}/near", what))
    for number, name in enumerate(projector.onto):
        issues += scene.check_entity(f"{pointer}/onto/{number}", name)
    return issues


register_limit("particles", 1000)
register_limit("projector", 1000)
register_check("billboard", _check_billboard)
register_check("particles", _check_particles)
register_check("projector", _check_projector)
