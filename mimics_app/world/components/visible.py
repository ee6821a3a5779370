"""Component types of the visible and audible scene; `robot` has those of the robot.

Units are SI, colours linear RGB, angles radians; the descriptions become the JSON Schema that editors show.
"""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.shared_memory.sound_scene import MAX_EMITTERS
from mimics_app.world.components.bounds import Extent, Factor, FarPoint, Figure, Length, Light, PositiveForce, Share
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component, component, register_check
from mimics_app.world.components.shapes import RingShape, Shape

__all__ = [
    "BackdropSpec",
    "CameraComponent",
    "Environment",
    "FogSpec",
    "Hud",
    "LightComponent",
    "MeshComponent",
    "Sound",
    "SoundBus",
    "SoundEmitter",
    "SoundObstacle",
    "SoundRoom",
    "TunnelView",
    "Walker",
]

Colour = tuple[Light, Light, Light]
Figures = Annotated[dict[str, Figure], Meta(max_length=100)]
Pictures = Annotated[tuple[str, ...], Meta(max_length=6)]


@component("mesh")
class MeshComponent(Component, frozen=True):
    """A visible body: either a `primitive` or a `source` in a model file."""

    primitive: Annotated[Shape | None, Meta(description="A built-in shape")] = None
    source: Annotated[
        str | None,
        Meta(
            description='In a model: "asset" (all of it), "asset#/nodes/Name" (with its children), "asset#/meshes/Name"'
        ),
    ] = None
    material: Annotated[
        str | None, Meta(description="Material of the scene's `materials`; absent: the model's own, or plain grey")
    ] = None
    visible: Annotated[bool, Meta(description="False: it is not drawn")] = True
    casts_shadow: Annotated[bool, Meta(description="Drawn into shadow maps")] = True


@component("light", limit=1000)
class LightComponent(Component, frozen=True):
    """A light; directional and spot shine along the entity's own -z."""

    kind: Annotated[Literal["directional", "point", "spot", "ambient"], Meta(description="Kind of light")] = (
        "directional"
    )
    colour: Annotated[Colour, Meta(description="Linear RGB, usually 0-1")] = (1.0, 1.0, 1.0)
    intensity: Annotated[
        Light,
        Meta(description="Directional and ambient: factor (1: a white surface is white); point, spot: the same at 1 m"),
    ] = 1.0
    range: Annotated[Length | None, Meta(description="Cut-off distance [m]; absent: unlimited")] = None
    inner_cone: Annotated[
        float, Meta(ge=0, lt=1.5708, description="Half angle of the cone of full intensity (spot) [rad]")
    ] = 0.0
    outer_cone: Annotated[float, Meta(gt=0, lt=1.5708, description="Half angle of the cone (spot) [rad]")] = 0.785398
    casts_shadow: Annotated[bool, Meta(description="Casts shadows (directional, spot)")] = False
    target: Annotated[FarPoint | None, Meta(description="World point it is aimed at [m]")] = None


@component("camera", limit=1000)
class CameraComponent(Component, frozen=True):
    """A camera; it looks along the entity's own -z, +y up."""

    vertical_fov: Annotated[float, Meta(gt=0, lt=3.1415, description="Full vertical angle of view [rad]")] = 0.8727
    near: Annotated[Length, Meta(description="Distance of the near plane [m]")] = 0.05
    far: Annotated[Length, Meta(description="Distance of the far plane [m]; beyond `near`")] = 100.0
    target: Annotated[FarPoint | None, Meta(description="World point it is aimed at [m]")] = None


class FogSpec(Component, frozen=True):
    """Fog: attenuation with distance."""

    density: Annotated[Factor, Meta(description="Density [1/m]")]
    kind: Annotated[
        Literal["squared", "exponential", "linear"],
        Meta(description="Transmittance at s beyond start: exp(-(density s)^2), exp(-density s), 1 - density s"),
    ] = "exponential"
    start: Annotated[Extent, Meta(description="Distance at which the fog begins [m]")] = 0.0
    colour: Annotated[Colour | None, Meta(description="Linear RGB; absent: the horizon's")] = None


class BackdropSpec(Component, frozen=True):
    """Textures over the sky; the sky's colours show where they are transparent."""

    kind: Annotated[
        Literal["box", "dome", "plane"],
        Meta(description="box: six textures towards +x -x +y -y +z -z; dome: longitude by latitude; plane: clouds"),
    ]
    textures: Annotated[Pictures, Meta(description="Image files of the scene's `assets`, six (box) or one")]
    height: Annotated[Length, Meta(description="Height of the plane above the camera [m]")] = 40.0
    tile: Annotated[Length, Meta(description="Width of one texture tile on the plane [m]")] = 100.0


@component("environment", limit=1000, once=True)
class Environment(Component, frozen=True):
    """Sky, fog and ambient light; one per scene."""

    zenith: Annotated[Colour, Meta(description="Sky straight up, linear RGB")] = (0.18, 0.30, 0.52)
    horizon: Annotated[Colour, Meta(description="Sky at the horizon, linear RGB")] = (0.62, 0.70, 0.78)
    ground: Annotated[Colour, Meta(description="Colour below the horizon, linear RGB")] = (0.20, 0.19, 0.18)
    ambient: Annotated[Light, Meta(description="Factor on the ambient light of surfaces")] = 0.5
    scatter: Annotated[
        Share,
        Meta(description="Share of the sun's light that arrives from all directions, scattered"),
    ] = 0.1
    fog: Annotated[FogSpec | None, Meta(description="Fog; absent: of systems.visual.fog_density")] = None
    backdrop: Annotated[BackdropSpec | None, Meta(description="Textures over the sky: sky box, dome or plane")] = None
    night: Annotated[
        bool, Meta(description="The scene is meant to be dark: `mimics render --sheet` does not check its brightness")
    ] = False


@component("sound", limit=1000)
class Sound(Component, frozen=True):
    """A sound, named by the entity's id. Either an `asset` or a `synth` recipe."""

    asset: Annotated[
        str | None,
        Meta(
            description="Sound file of the scene's `assets`: .wav, .ogg or .flac; longer than a minute, it plays once "
            "at a time"
        ),
    ] = None
    synth: Annotated[str | None, Meta(description="Recipe of the built-in synthesiser")] = None
    parameters: Annotated[
        Figures, Meta(description="Numbers of the recipe: pitch (ratio, 1), arousal (of a crowd, 0 to 1, 0.6)")
    ] = msgspec.field(default_factory=dict)
    trigger: Annotated[
        Annotated[str, Meta(pattern="^[a-z][a-z0-9_]{0,39}$")] | None,
        Meta(
            description="Kind of event that starts it on its own: contact, contact_end, impact (of the haptic loop), "
            "goal, start (of the task), stopping, leg_released and other gait states, step and others (of avatars)",
        ),
    ] = None
    material: Annotated[
        str,
        Meta(
            pattern="^[a-z0-9_]{0,40}$",
            description="Material of the event (of a contact: the surface): takes precedence over a sound without one",
        ),
    ] = ""
    gain: Annotated[float, Meta(ge=0, le=4, description="Linear factor, 1 = as recorded")] = 1.0
    full_level: Annotated[
        PositiveForce,
        Meta(description="Contact force that gives `gain` [N]; softer contacts are quieter in proportion"),
    ] = 10.0
    bus: Annotated[str, Meta(max_length=40, description='Id of an entity with a `sound_bus`, or "main"')] = "main"
    priority: Annotated[
        float, Meta(ge=0, le=100, description="Factor on its level when voices run out: the quietest is cut")
    ] = 1.0
    reverb: Annotated[float, Meta(ge=0, le=4, description="Linear send to the reverberation of a room")] = 1.0
    reference_distance: Annotated[
        Length, Meta(description="Distance up to which `gain` holds [m]; half the level at twice of it")
    ] = 1.0
    max_distance: Annotated[Length, Meta(description="Distance beyond which the level falls no further [m]")] = 50.0
    spatial: Annotated[
        bool, Meta(description="False: played as recorded, in two channels: music, binaural recordings")
    ] = True


@component("sound_emitter", limit=MAX_EMITTERS)
class SoundEmitter(Component, frozen=True):
    """A sound that plays from this entity, with distance (inverse law, clamped)."""

    sound: Annotated[str, Meta(description="Id of an entity with a `sound`")]
    gain: Annotated[float, Meta(ge=0, le=4, description="Linear factor")] = 1.0
    loop: Annotated[bool, Meta(description="Repeats when it ends")] = True
    autoplay: Annotated[bool, Meta(description="Starts with the scene")] = True
    reference_distance: Annotated[Length, Meta(description="Distance at which `gain` holds [m]")] = 1.0
    max_distance: Annotated[Length, Meta(description="Distance beyond which the level falls no further [m]")] = 50.0
    rolloff: Annotated[Factor, Meta(description="0: no fall with distance, 1: natural")] = 1.0
    distance_model: Annotated[
        Literal["inverse", "linear", "exponential"],
        Meta(description="inverse: 6 dB per doubling; linear: to nothing at max_distance; exponential: d^-rolloff"),
    ] = "inverse"
    cone_inner: Annotated[float, Meta(ge=0, le=6.2832, description="Full angle about -z of full level [rad]")] = 6.2832
    cone_outer: Annotated[float, Meta(ge=0, le=6.2832, description="Full angle where `cone_gain` begins [rad]")] = (
        6.2832
    )
    cone_gain: Annotated[Share, Meta(description="Linear gain outside the cone")] = 1.0
    doppler: Annotated[float, Meta(ge=0, le=10, description="Factor on the change of pitch by motion, 1: natural")] = (
        1.0
    )


@component("walker", limit=1000)
class Walker(Component, frozen=True):
    """Footsteps while the entity moves; each is a trigger "step" of this material."""

    material: Annotated[
        str, Meta(pattern="^[a-z0-9_]{0,40}$", description="Material of the ground: asphalt, grass, ..")
    ] = ""
    strength: Annotated[float, Meta(ge=0, le=4, description="Linear factor on the level of the steps")] = 1.0


@component("sound_bus", limit=16)
class SoundBus(Component, frozen=True):
    """A group of sounds, named by the entity's id."""

    gain: Annotated[float, Meta(ge=0, le=4, description="Linear factor")] = 1.0
    ducks: Annotated[
        tuple[str, ...], Meta(max_length=16, description='Ids of buses (or "main") turned down while this one sounds')
    ] = ()
    duck_gain: Annotated[Share, Meta(description="Linear factor on those; 0.25: by 12 dB")] = 0.25


@component("sound_room", limit=1000)
class SoundRoom(Component, frozen=True):
    """A box about the entity with reverberation, which is not audible outside."""

    size: Annotated[tuple[Length, Length, Length], Meta(description="Edges of the box [m]")]
    time: Annotated[float, Meta(ge=0.05, le=20, description="Reverberation time, to -60 dB [s]")] = 0.8
    level: Annotated[float, Meta(ge=0, le=2, description="Linear level of the reverberation")] = 0.2
    border: Annotated[Length, Meta(description="Distance over which it fades in from the walls inwards [m]")] = 1.0


@component("sound_obstacle", limit=1000)
class SoundObstacle(Component, frozen=True):
    """A box about the entity that attenuates sound (mass law), which is also diffracted at its edges."""

    size: Annotated[tuple[Length, Length, Length], Meta(description="Edges of the box [m]")]
    surface_mass: Annotated[
        float, Meta(gt=0, le=10000, description="Mass per area [kg/m^2]: a pane 10, plasterboard 20, brick 200")
    ] = 20.0


@component("hud", limit=1000)
class Hud(Component, frozen=True):
    """Figures and bars over the picture."""

    show: Annotated[
        tuple[str, ...],
        Meta(
            max_length=20,
            description="Cards shown, in order: progress, time, contacts, force, score, state, trial, margin, gait, "
            "and those of the kind of task (carry: grasp, placed, drops)",
        ),
    ] = ("progress", "time", "contacts", "force")
    depth: Annotated[Length, Meta(description="Distance before the eyes [m]")] = 1.0
    enlarged: Annotated[float, Meta(ge=1, le=2, description="Factor on the size of all of it, text too")] = 1.0
    force_full: Annotated[PositiveForce, Meta(description="Force that fills the force bar [N]")] = 30.0


@component("tunnel_view", limit=1000)
class TunnelView(Component, frozen=True):
    """Appearance of a tunnel; on the entity that has the `tunnel`."""

    material: Annotated[str, Meta(description="Material of the wall; a transparent one shows the ball")]
    bisector_material: Annotated[
        str | None, Meta(description="Material of a thin line along the bisector; absent: none")
    ] = None
    bisector_radius: Annotated[float, Meta(gt=0, le=1.0, description="Radius of that line [m]")] = 0.0015
    sides: Annotated[int, Meta(ge=6, le=128, description="Facets around the tunnel")] = 32
    rings_per_piece: Annotated[int, Meta(ge=2, le=128, description="Rings along each piece of the curve")] = 16


def _check_mesh(mesh: MeshComponent, pointer: str, scene: CheckedScene) -> list[Issue]:
    issues = []
    if (mesh.primitive is None) == (mesh.source is None):
        issues.append(scene.issue(pointer, "needs either a primitive or a source", "give exactly one of the two"))
    if isinstance(mesh.primitive, RingShape) and mesh.primitive.inner_radius >= mesh.primitive.outer_radius:
        where = f"{pointer}/primitive/inner_radius"
        issues.append(scene.issue(where, f"{mesh.primitive.inner_radius:g} m is not inside outer_radius"))
    if mesh.source is not None:
        issues += scene.check_model_reference(f"{pointer}/source", mesh.source)
    return issues + scene.check_material(f"{pointer}/material", mesh.material)


def _check_light(light: LightComponent, pointer: str, scene: CheckedScene) -> list[Issue]:
    issues = []
    if light.kind == "spot" and light.inner_cone >= light.outer_cone:
        issues.append(scene.issue(f"{pointer}/inner_cone", f"{light.inner_cone:g} rad is not inside outer_cone"))
    return issues


def _check_camera(camera: CameraComponent, pointer: str, scene: CheckedScene) -> list[Issue]:
    if camera.far > camera.near:
        return []
    return [scene.issue(f"{pointer}/far", f"{camera.far:g} m is not beyond near, {camera.near:g} m")]


def _check_environment(environment: Environment, pointer: str, scene: CheckedScene) -> list[Issue]:
    backdrop, issues = environment.backdrop, []
    if backdrop is not None:
        below = f"{pointer}/backdrop/textures"
        wanted = 6 if backdrop.kind == "box" else 1
        if len(backdrop.textures) != wanted:
            issues.append(
                scene.issue(below, f"a {backdrop.kind} has {wanted} image files, not {len(backdrop.textures)}")
            )
        for number, texture in enumerate(backdrop.textures):
            issues += scene.check_asset(f"{below}/{number}", texture, "picture")
    return issues


def _check_sound(sound: Sound, pointer: str, scene: CheckedScene) -> list[Issue]:
    issues = []
    if (sound.asset is None) == (sound.synth is None):
        issues.append(scene.issue(pointer, "needs either an asset or a synth recipe", "give exactly one of the two"))
    issues += scene.check_asset(f"{pointer}/asset", sound.asset, "sound")
    if sound.bus != "main":
        issues += scene.check_entity_with(SoundBus, f"{pointer}/bus", sound.bus)
    return issues


def _check_sound_bus(bus: SoundBus, pointer: str, scene: CheckedScene) -> list[Issue]:
    others = [(number, name) for number, name in enumerate(bus.ducks) if name != "main"]
    return [
        issue
        for number, name in others
        for issue in scene.check_entity_with(SoundBus, f"{pointer}/ducks/{number}", name)
    ]


def _check_sound_emitter(emitter: SoundEmitter, pointer: str, scene: CheckedScene) -> list[Issue]:
    issues = scene.check_entity_with(Sound, f"{pointer}/sound", emitter.sound)
    if emitter.cone_inner > emitter.cone_outer:
        issues.append(scene.issue(f"{pointer}/cone_inner", f"{emitter.cone_inner:g} rad is not inside cone_outer"))
    return issues


def _check_tunnel_view(view: TunnelView, pointer: str, scene: CheckedScene) -> list[Issue]:
    issues = scene.check_material(f"{pointer}/material", view.material)
    return issues + scene.check_material(f"{pointer}/bisector_material", view.bisector_material)


register_check("mesh", _check_mesh)
register_check("light", _check_light)
register_check("camera", _check_camera)
register_check("environment", _check_environment)
register_check("sound", _check_sound)
register_check("sound_emitter", _check_sound_emitter)
register_check("sound_bus", _check_sound_bus)
register_check("tunnel_view", _check_tunnel_view)
