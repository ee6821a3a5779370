"""Groups of methods that a scene uses, the methods that it names itself, and those that it allows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

import msgspec

from mimics_app.contracts.ports.members import member_names
from mimics_app.contracts.ports.methods import Settings
from mimics_app.world.components.animation import Animation, Avatar
from mimics_app.world.components.effects import Particles
from mimics_app.world.components.haptic_shapes import TouchSurface, surface_of
from mimics_app.world.components.joint_reference import JointReference
from mimics_app.world.components.objects import HapticObject, HapticWalls, InteractionPoints
from mimics_app.world.components.robot import Admittance, Controller, Robot, Tunnel
from mimics_app.world.components.systems import (
    AudioSettings,
    DisplaySettings,
    HapticSettings,
    Tolerances,
    VisualSettings,
)
from mimics_app.world.components.visible import (
    CameraComponent,
    LightComponent,
    MeshComponent,
    Sound,
    SoundBus,
    SoundEmitter,
    SoundRoom,
)
from mimics_app.world.files.scene.method_plugins import Use, method_plugins
from mimics_app.world.files.scene.scene import Scene
from mimics_app.world.files.scene.spread import ENOUGH, spread_of_casters

__all__ = [
    "TOUCH",
    "USES",
    "WHOLE_TICK",
    "Use",
    "grips",
    "points_of",
    "shadow_distance_of",
    "touched_shape",
    "uses",
    "visual_of",
]


def visual_of(scene: Scene) -> VisualSettings:
    """Return the scene's settings of the picture, defaults filled in."""
    return scene.system(VisualSettings) or VisualSettings()


_ONE_MAP = 8.0
"""Spread of objects up to which one shadow map covers them [m]: a texel of 2,048 is 8 mm wide, as a pixel of 720 rows
at 7 m."""


def shadow_distance_of(scene: Scene) -> float:
    """Return the distance from the camera up to which cascades show the sun's shadows [m]; 0: one map for all of them.

    It is `systems.visual.shadow_distance`. Where the scene leaves it open: one map if that is enough, else the extent
    of its objects, but at most 100 m, where the shadow of a person is a dozen pixels high.
    """
    stated = visual_of(scene).shadow_distance
    if stated != "auto":
        return stated
    spread = spread_of_casters(scene)
    return 0.0 if spread <= _ONE_MAP else 2.0 * min(spread, ENOUGH)


def _can_be_touched(scene: Scene) -> bool:
    return scene.has(HapticObject) or scene.has(HapticWalls)


def _has(kind: type[msgspec.Struct]) -> Callable[[Scene], bool]:
    return lambda scene: scene.has(kind)


def _unless_auto(name: str, stated: Callable[[Scene], str]) -> Callable[[Scene], Settings | None]:
    """Return a scene's setting of a method by its registered name; None where the planner chooses."""

    def named(scene: Scene) -> Settings | None:
        return None if stated(scene) == "auto" else {name: stated(scene)}

    return named


def _uses_admittance(scene: Scene) -> bool:
    """Whether there is a robot; one that takes forces has no virtual mass, but its driver is not known yet."""
    return scene.has(Admittance) or scene.has(Robot)


_LEG_CONTROLLERS = ("lokomat_impedance", "lokomat_combined")
"""Controllers of a gait orthosis."""


def _leg_controller(scene: Scene) -> Controller | None:
    """Return the scene's controller of a gait orthosis; None without one."""
    named = scene.first(Controller)
    return named if named is not None and named.name in _LEG_CONTROLLERS else None


def _has_rigid_objects(scene: Scene) -> bool:
    """Whether a position control is the stiffness of a leg's objects."""
    named = _leg_controller(scene)
    return named is not None and named.name == "lokomat_combined"


def _guides_legs(scene: Scene) -> bool:
    return _leg_controller(scene) is not None and scene.has(JointReference)


def _named_leg_control(scene: Scene) -> Settings | None:
    """Return the control that a scene names: there is no orthosis without one."""
    named = _leg_controller(scene)
    return None if named is None else {"controller": named.name}


def _unless_left_open(parameter: str) -> Callable[[Scene], Settings | None]:
    """Return a scene's parameter of the legs' controller; None where it leaves it to the planner."""

    def named(scene: Scene) -> Settings | None:
        controller = _leg_controller(scene)
        given = {} if controller is None else controller.parameters
        return {parameter: given[parameter]} if parameter in given else None

    return named


def _may_run_form(scene: Scene, settings: Settings) -> bool:
    """Exclude the printed form unless the scene requests it: it has a false force on rotating motion."""
    return settings.get("form") != "seed"


S = TypeVar("S", bound=msgspec.Struct)


def _all(scene: Scene, kind: type[S]) -> list[S]:
    """Return components of a type without marking them as used."""
    return [one for entity in scene.entities for one in entity.components.values() if isinstance(one, kind)]


def points_of(scene: Scene) -> int:
    """Return the number of interaction points."""
    return sum(len(one.points) for one in _all(scene, InteractionPoints)) or 1


def grips(scene: Scene) -> bool:
    """Whether fingers can hold an object of the scene."""
    return any(body.grip for body in _all(scene, HapticObject))


def touched_shape(scene: Scene) -> str:
    """Return the kind of the first shape that can be touched, as the methods name it: a box is D2.1's cube."""
    for body in _all(scene, HapticObject):
        if body.shapes:
            kind = str(body.shapes[0].__struct_config__.tag)
            return "cube" if kind == "box" else kind
    return "cube"


def _surfaces(scene: Scene) -> list[TouchSurface]:
    """Return the material of each touchable surface, defaults filled in."""
    found = [surface_of(walls) for walls in _all(scene, HapticWalls)]
    for body in _all(scene, HapticObject):
        found += [surface_of(solid, body) for solid in body.shapes] or [surface_of(body)]
    return found


def _named_law(scene: Scene) -> Settings | None:
    """Return the contact law of the first surface: the law is a property of the surface, stated in the scene."""
    first = _surfaces(scene)[0]
    return {"law": first.law} | ({"exponent": first.exponent} if first.law == "hunt_crossley" else {})


def _has_friction(scene: Scene) -> bool:
    return any(surface.friction_static for surface in _surfaces(scene))


def _moving(scene: Scene) -> list[HapticObject]:
    return [body for body in _all(scene, HapticObject) if body.enable_translation or body.enable_rotation]


def _named_integrator(scene: Scene) -> Settings | None:
    stated = [body.integrator for body in _moving(scene) if body.integrator != "auto"]
    return {"integrator": stated[0]} if len(stated) == len(_moving(scene)) else None


def _named_rest(scene: Scene) -> Settings:
    return {"sleeps": all(body.sleeps for body in _moving(scene))}


_TICK_S = 1e-3


def _may_integrate(scene: Scene, settings: Settings) -> bool:
    """Allow integrators that use the old velocity only where they keep a contact: b > k h (chart "integrator")."""
    if settings.get("integrator") == "semi_implicit":
        return True
    return all(
        surface.law == "spring_damper" and (surface.damping or 0.0) > (surface.stiffness or 0.0) * _TICK_S
        for surface in _surfaces(scene)
    )


def _audio_of(scene: Scene) -> AudioSettings:
    """Return the scene's settings of sound, defaults filled in."""
    return scene.system(AudioSettings) or AudioSettings()


def _named_spatialiser(scene: Scene) -> Settings | None:
    audio = _audio_of(scene)
    from mimics_app.rendering.audio import mixers

    if audio.mixer not in ("auto", *member_names(mixers)):  # of a package: no rival, and of unknown cost
        return {"hrtf": audio.hrtf is not False, "mixer": audio.mixer}
    if audio.hrtf == "auto" or audio.mixer == "auto":
        return None
    return {"hrtf": audio.hrtf, "mixer": audio.mixer}


_WHOLE_SAMPLES_US = 23.0
"""Error of an interaural delay of whole samples, as OpenAL's [us]; a scene that needs less states a tolerance."""


def _may_spatialise(scene: Scene, settings: Settings) -> bool:
    """Allow the methods that agree with the scene; the spectral mixer only where it is named or needed.

    It is cheaper and more accurate, but takes 2.3 s longer to start (decision 200), which no cost here includes.
    """
    audio, itd_us = _audio_of(scene), (scene.system(Tolerances) or Tolerances()).itd_us
    only_spectral = _only_spectral(scene, audio)
    exact = only_spectral or audio.mixer == "spectral" or (itd_us is not None and itd_us < _WHOLE_SAMPLES_US)
    return (
        (audio.hrtf == "auto" or settings.get("hrtf") == audio.hrtf)
        and (audio.mixer == "auto" or settings.get("mixer") == audio.mixer)
        and (settings.get("mixer") == "spectral") <= exact
        and (not only_spectral or settings.get("mixer") == "spectral")
    )


def _only_spectral(scene: Scene, audio: AudioSettings) -> bool:
    """Return whether the scene has what OpenAL does not play: a head, loudspeakers, rooms, buses, laws of distance."""
    emitters = [emitter for _, emitter, _ in scene.components(SoundEmitter)]
    return (
        (audio.sofa is not None or audio.head_width != AudioSettings().head_width)
        or (audio.hrtf is False and audio.speakers != "stereo")
        or bool(scene.components(SoundRoom) or scene.components(SoundBus))
        or any(emitter.distance_model != "inverse" or emitter.doppler != 1.0 for emitter in emitters)
    )


def _has_sun_shadow(scene: Scene) -> bool:
    if visual_of(scene).shadow_size == 0:
        return False
    lights = (light for _, light, _ in scene.components(LightComponent))
    return any(light.casts_shadow and light.kind == "directional" for light in lights)


_VOLUMES = ("stencil_additive", "stencil_modulative")
"""Kinds of shadow without a map."""


def _named_shadows(scene: Scene) -> Settings | None:
    visual = visual_of(scene)
    if visual.shadows in _VOLUMES:
        return {"shadows": visual.shadows}
    if visual.shadow_size == "auto":
        return None
    return {"cascaded": shadow_distance_of(scene) > 0.0, "shadow_size": visual.shadow_size}


def _may_shadow(scene: Scene, settings: Settings) -> bool:
    """Allow cascades only with a distance, and additive volumes only with neither distance nor a named kind.

    Modulative shadows are a matter of appearance and never chosen for speed.
    """
    if "cascaded" in settings:
        return settings["cascaded"] == (shadow_distance_of(scene) > 0.0)
    may_be_volumes = shadow_distance_of(scene) == 0.0 and visual_of(scene).shadows == "auto"
    return may_be_volumes and settings.get("shadows") == "stencil_additive"


def _named_edges(scene: Scene) -> Settings | None:
    visual = visual_of(scene)
    if visual.anti_aliasing in ("none", "filter"):
        return {"msaa": 0, "fxaa": visual.anti_aliasing == "filter"}
    if visual.anti_aliasing == "auto" and visual.samples == "auto":
        return None
    return {"msaa": 4 if visual.samples == "auto" else visual.samples, "fxaa": visual.anti_aliasing == "both"}


def _is_edge_filter(settings: Settings) -> bool:
    """Whether edges are only filtered, which flickers where an object is thinner than a pixel."""
    return settings == {"msaa": 0, "fxaa": True}


def _at_vertices(settings: Settings) -> bool:
    """Whether people or particles are lit at vertices, which saves time where the processor draws."""
    return settings not in ({"vertex_light": 0.0}, {"particle_light": "pixel"})


def _has_lit_particles(scene: Scene) -> bool:
    return any(particles.lit for _, particles, _ in scene.components(Particles))


def _bends(scene: Scene) -> bool:
    return scene.has(Animation) or scene.has(Avatar)


_ONE_EYE = ("desktop", "wall", "cave")
"""Kinds of display for one eye, or whose file states the number of eyes."""


def _display_of(scene: Scene) -> DisplaySettings:
    return scene.system(DisplaySettings) or DisplaySettings()


def _for_two_eyes(scene: Scene) -> bool:
    display = _display_of(scene)
    return display.kind not in _ONE_EYE or display.passes != "auto"


def _shows_models(scene: Scene) -> bool:
    return any(mesh.source for _, mesh, _ in scene.components(MeshComponent))


_PROBE_PX = 640 * 360
"""Size of the picture in which the methods of the picture are measured [px]."""
_LIGHT_PX = 1280 * 720
"""The same for the light on people and on particles."""

WHOLE_TICK, TOUCH, _BODIES = "haptic tick", "touching a shape", "bodies, at rest"
"""Parts of `explain` that include others."""

USES: Mapping[str, Use] = {
    "tunnel projection": Use(
        "closest point of the tunnel's bisector",
        _has(Tunnel),
        _unless_auto("projection", lambda scene: (scene.system(HapticSettings) or HapticSettings()).projection),
        within=WHOLE_TICK,
    ),
    "tunnel frame": Use("frame carried along the bisector", _has(Tunnel), within=WHOLE_TICK),
    "admittance form": Use(
        "motion of the virtual mass",
        _uses_admittance,
        _unless_auto("form", lambda scene: (scene.first(Admittance) or Admittance()).form),
        _may_run_form,
        within=WHOLE_TICK,
    ),
    "leg control": Use(
        "control of the legs in a gait orthosis",
        lambda scene: _leg_controller(scene) is not None,
        _named_leg_control,
        within=WHOLE_TICK,
    ),
    "leg position": Use(
        "position control of a leg", _has_rigid_objects, _unless_left_open("computed_torque"), within=WHOLE_TICK
    ),
    "leg speed": Use("speed of a leg's joints", _has_rigid_objects, _unless_left_open("encoder"), within=WHOLE_TICK),
    "leg guidance": Use(
        "guidance of a leg along its reference", _guides_legs, _unless_left_open("guidance_window"), within=WHOLE_TICK
    ),
    "contact law": Use("force of a contact", _can_be_touched, _named_law, within=TOUCH),
    "friction": Use("friction of a contact", _has_friction, within=TOUCH),
    "colliding bodies": Use(
        "bodies that move and collide",
        lambda scene: bool(_moving(scene)),
        _named_integrator,
        _may_integrate,
        within=_BODIES,
    ),
    "rotation update": Use(
        "rotation of bodies", lambda scene: any(body.enable_rotation for body in _moving(scene)), within=_BODIES
    ),
    "resting bodies": Use(_BODIES, lambda scene: bool(_moving(scene)), _named_rest, count=lambda s: len(_moving(s))),
    "spatialiser": Use("direction of sounds", _has(Sound), _named_spatialiser, _may_spatialise),
    "occlusion": Use("bodies hidden behind others", _shows_models),
    "level of detail": Use("levels of detail of far bodies", _shows_models),
    "skinning": Use(
        "bodies that follow joints", _bends, _unless_auto("skinning", lambda scene: visual_of(scene).skinning)
    ),
    "shading": Use(
        "light on surfaces", _has(CameraComponent), _unless_auto("shading", lambda scene: visual_of(scene).shading)
    ),
    "vertex light": Use("light on people", _bends, only_live=_at_vertices, pixels=_LIGHT_PX),
    "particle light": Use("light on particles", _has_lit_particles, only_live=_at_vertices, pixels=_LIGHT_PX),
    "stereo": Use(
        "the two eyes before a picture", _for_two_eyes, _unless_auto("stereo", lambda scene: _display_of(scene).passes)
    ),
    "sun shadows": Use("shadows of the sun", _has_sun_shadow, _named_shadows, _may_shadow, _PROBE_PX),
    "anti aliasing": Use(
        "anti-aliasing", _has(CameraComponent), _named_edges, only_live=_is_edge_filter, pixels=_PROBE_PX
    ),
    "ambient occlusion": Use(
        "ambient occlusion", lambda scene: visual_of(scene).ambient_occlusion > 0.0, pixels=_PROBE_PX
    ),
    "bloom": Use("bloom", lambda scene: visual_of(scene).bloom > 0.0, pixels=_PROBE_PX),
}
"""Use of each group that the planner knows; those that share the frame time are ordered by the loss without them.

Some groups have only one method that the product can run: `explain` says so beside its cost.
"""


def uses() -> Mapping[str, Use]:
    """Return `USES`, and the uses of the groups of installed packages."""
    brought = {plugin.group: plugin.use for plugin in method_plugins() if plugin.use is not None}
    return {**brought, **USES}
